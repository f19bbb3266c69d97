// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/loop_bound.h"
#include "core/base/status.h"
#include "hal/onboard/control/messages.h"

namespace hardpack::control {

// Writes the little-endian numbers of one message, one after another, header first. Nothing is
// written beyond the buffer: Finish then returns kCapacityExceeded. The buffer must outlive it.
class MessageWriter {
 public:
  MessageWriter(std::span<uint8_t> buffer, Kind kind, uint32_t sequence) : buffer_(buffer) {
    U32(kMagic);
    U8(kVersion);
    U8(static_cast<uint8_t>(kind));
    U16(0);  // its size, once known
    U32(sequence);
  }

  void U8(uint8_t value) { Write(value, 1); }
  void U16(uint16_t value) { Write(value, 2); }
  void U32(uint32_t value) { Write(value, 4); }
  void U64(uint64_t value) { Write(value, 8); }
  void F32(float value) { U32(std::bit_cast<uint32_t>(value)); }

  // Sets the total size.
  Status Finish(int& size_bytes) {
    size_bytes = 0;
    if (size_ > buffer_.size() || size_ > kMaxMessageBytes) return Status::kCapacityExceeded;
    buffer_[kSizeOffset] = static_cast<uint8_t>(size_ & 0xffu);
    buffer_[kSizeOffset + 1] = static_cast<uint8_t>(size_ >> 8u & 0xffu);
    size_bytes = static_cast<int>(size_);
    return Status::kOk;
  }

  static constexpr size_t kSizeOffset = 6;

 private:
  // Not inlined: a report has some two hundred of them.
  [[gnu::noinline]] void Write(uint64_t value, size_t bytes) {
    const size_t begin = size_;
    size_ += bytes;
    if (size_ > buffer_.size()) return;
    HP_LOOP_BOUND(8)
    for (size_t i = 0; i < bytes; ++i) {
      buffer_[begin + i] = static_cast<uint8_t>(value >> (8 * i) & 0xffu);
    }
  }

  std::span<uint8_t> buffer_;
  size_t size_ = 0;  // size it has or would need
};

}  // namespace hardpack::control
