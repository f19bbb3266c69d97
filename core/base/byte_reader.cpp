// SPDX-License-Identifier: Apache-2.0
#include "core/base/byte_reader.h"

#include <bit>

#include "core/base/loop_bound.h"

namespace hardpack {

uint64_t ByteReader::Read(size_t offset, size_t size) {
  if (offset > bytes_.size() || size > bytes_.size() - offset) {
    status_ = Status::kTruncated;
    return 0;
  }
  uint64_t value = 0;
  HP_LOOP_BOUND(8)
  for (size_t i = 0; i < size; ++i) value |= uint64_t{bytes_[offset + i]} << (8 * i);
  return value;
}

uint8_t ByteReader::U8(size_t offset) {
  return static_cast<uint8_t>(Read(offset, 1));
}
uint16_t ByteReader::U16(size_t offset) {
  return static_cast<uint16_t>(Read(offset, 2));
}
uint32_t ByteReader::U24(size_t offset) {
  return static_cast<uint32_t>(Read(offset, 3));
}
uint32_t ByteReader::U32(size_t offset) {
  return static_cast<uint32_t>(Read(offset, 4));
}
uint64_t ByteReader::U40(size_t offset) {
  return Read(offset, 5);
}
uint64_t ByteReader::U64(size_t offset) {
  return Read(offset, 8);
}
float ByteReader::F32(size_t offset) {
  return std::bit_cast<float>(U32(offset));
}

std::span<const uint8_t> ByteReader::Sub(size_t offset, size_t size) {
  if (offset > bytes_.size() || size > bytes_.size() - offset) {
    status_ = Status::kTruncated;
    return {};
  }
  return bytes_.subspan(offset, size);
}

}  // namespace hardpack
