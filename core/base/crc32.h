// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.h"
#include "core/base/loop_bound.h"

// CRC-32/ISO-HDLC (reflected polynomial 0xedb88320, start and final xor all ones), as used by
// Ethernet and zip.

namespace hardpack {
namespace crc32 {

// The remainder that each byte leaves.
consteval std::array<uint32_t, 256> MakeTable() {
  std::array<uint32_t, 256> table{};
  HP_LOOP_BOUND(256)
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t rest = byte;
    HP_LOOP_BOUND(8)
    for (int bit = 0; bit < 8; ++bit) rest = rest >> 1 ^ ((rest & 1u) != 0 ? 0xedb88320u : 0u);
    table[byte] = rest;
  }
  return table;
}

inline constexpr std::array<uint32_t, 256> kTable = MakeTable();

}  // namespace crc32

// The CRC of the bytes that gave `before` followed by these; `before` is 0 at the start.
// Precondition: at most kMost_bytes. Cost: one look-up per byte.
template <size_t kMost_bytes>
constexpr uint32_t ExtendCrc32(uint32_t before, std::span<const uint8_t> bytes) {
  HP_ASSERT(bytes.size() <= kMost_bytes);
  uint32_t crc = ~before;
  HP_LOOP_BOUND(kMost_bytes)
  for (const uint8_t byte : bytes) crc = crc >> 8 ^ crc32::kTable[(crc ^ byte) & 0xffu];
  return ~crc;
}

template <size_t kMost_bytes>
constexpr uint32_t Crc32(std::span<const uint8_t> bytes) {
  return ExtendCrc32<kMost_bytes>(0, bytes);
}

}  // namespace hardpack
