// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"

namespace hardpack {

// Reads little-endian numbers from a packet at checked offsets. It never reads outside the bytes it
// was given: a read that would reach outside gives 0 and makes status() kTruncated, so a decoder
// may read a whole record and ask once. No alignment is needed; nothing is cast.
class ByteReader {
 public:
  explicit ByteReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  size_t size() const { return bytes_.size(); }
  Status status() const { return status_; }

  uint8_t U8(size_t offset);
  uint16_t U16(size_t offset);
  uint32_t U24(size_t offset);
  uint32_t U32(size_t offset);
  uint64_t U40(size_t offset);
  uint64_t U64(size_t offset);
  float F32(size_t offset);

  // A part of the bytes; empty, and status() kTruncated, when it would reach outside.
  std::span<const uint8_t> Sub(size_t offset, size_t size);

 private:
  uint64_t Read(size_t offset, size_t size);

  std::span<const uint8_t> bytes_;
  Status status_ = Status::kOk;
};

}  // namespace hardpack
