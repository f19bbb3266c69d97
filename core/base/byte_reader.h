// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"

namespace hardpack {

// Reads little-endian numbers from a packet at checked offsets. It never reads outside its bytes:
// an out-of-bounds read returns 0 and sets status() to kTruncated permanently, so a decoder may
// read a whole record and check once. No alignment is needed; nothing is cast. Inline, so that
// reading a number is one comparison and one load. The bytes must outlive the reader.
class ByteReader {
 public:
  explicit constexpr ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  constexpr size_t size() const { return bytes_.size(); }
  constexpr Status status() const { return status_; }

  constexpr uint8_t U8(size_t offset) { return Holds(offset, 1) ? bytes_[offset] : uint8_t{0}; }
  constexpr uint16_t U16(size_t offset) {
    return static_cast<uint16_t>(Holds(offset, 2) ? Low16(offset) : 0u);
  }
  constexpr uint32_t U24(size_t offset) {
    return Holds(offset, 3) ? Low16(offset) | Byte(offset + 2) << 16 : 0u;
  }
  constexpr uint32_t U32(size_t offset) { return Holds(offset, 4) ? Low32(offset) : 0u; }
  constexpr uint64_t U40(size_t offset) {
    return Holds(offset, 5) ? Low32(offset) | uint64_t{bytes_[offset + 4]} << 32 : 0u;
  }
  constexpr uint64_t U64(size_t offset) {
    return Holds(offset, 8) ? Low32(offset) | uint64_t{Low32(offset + 4)} << 32 : 0u;
  }
  constexpr float F32(size_t offset) { return std::bit_cast<float>(U32(offset)); }

  // A subrange of the bytes; empty, with status() kTruncated, if it is out of bounds.
  constexpr std::span<const uint8_t> Sub(size_t offset, size_t size) {
    return Holds(offset, size) ? bytes_.subspan(offset, size) : std::span<const uint8_t>{};
  }

 private:
  // Not offset + size <= bytes_.size(): that sum may wrap around.
  constexpr bool Holds(size_t offset, size_t size) {
    if (offset <= bytes_.size() && size <= bytes_.size() - offset) return true;
    status_ = Status::kTruncated;
    return false;
  }
  constexpr uint32_t Byte(size_t offset) const { return bytes_[offset]; }
  constexpr uint32_t Low16(size_t offset) const { return Byte(offset) | Byte(offset + 1) << 8; }
  constexpr uint32_t Low32(size_t offset) const {
    return Low16(offset) | Byte(offset + 2) << 16 | Byte(offset + 3) << 24;
  }

  std::span<const uint8_t> bytes_;
  Status status_ = Status::kOk;
};

}  // namespace hardpack
