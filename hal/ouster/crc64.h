// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"

// The CRC-64 of the footer of Ouster lidar packets: polynomial of ECMA-182 in reflected form,
// 0xC96C5795D7870F42, started from all ones and inverted at the end (known as CRC-64/XZ). Its
// position in a packet is in hal/ouster/ouster.h.
//
// Eight bytes per step: the CRC of eight bytes is the exclusive or of the CRCs of each of them
// followed by zeros, and table k holds those of a byte followed by k zero bytes [Sarwate 1988;
// Kounavis and Berry 2005, slicing-by-8]. The tables are 16 KiB of read-only data.

namespace hardpack::ouster {
namespace crc64 {

inline constexpr int kSlices = 8;
using Tables = std::array<std::array<uint64_t, 256>, kSlices>;

consteval Tables MakeTables() {
  constexpr uint64_t kReflectedPolynomial = 0xC96C5795D7870F42u;
  Tables tables{};
  HP_LOOP_BOUND(256)
  for (size_t byte = 0; byte < 256; ++byte) {
    uint64_t crc = byte;
    HP_LOOP_BOUND(8)
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1) ^ ((crc & 1u) != 0 ? kReflectedPolynomial : 0u);
    }
    tables[0][byte] = crc;
  }
  HP_LOOP_BOUND(kSlices - 1)
  for (size_t slice = 1; slice < kSlices; ++slice) {
    HP_LOOP_BOUND(256)
    for (size_t byte = 0; byte < 256; ++byte) {
      const uint64_t before = tables[slice - 1][byte];
      tables[slice][byte] = (before >> 8) ^ tables[0][before & 0xffu];
    }
  }
  return tables;
}

inline constexpr Tables kTables = MakeTables();

constexpr uint64_t Lookup(size_t slice, uint64_t word, int shift) {
  return kTables[slice][(word >> shift) & 0xffu];
}

}  // namespace crc64

// Largest input of Crc64: a packet; a multiple of 8.
inline constexpr size_t kMaxCrcBytes = 33280;

// The CRC of the first kMaxCrcBytes of `bytes`; callers keep within that. Cost: a step of eight
// look-ups for every eight bytes and one look-up for each of the at most seven remaining.
constexpr uint64_t Crc64(std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxCrcBytes) bytes = bytes.first(kMaxCrcBytes);
  ByteReader reader(bytes);
  uint64_t crc = ~uint64_t{0};
  size_t at = 0;
  HP_LOOP_BOUND(kMaxCrcBytes / 8)
  for (; at + 8 <= bytes.size(); at += 8) {
    const uint64_t word = crc ^ reader.U64(at);
    crc = crc64::Lookup(7, word, 0) ^ crc64::Lookup(6, word, 8) ^ crc64::Lookup(5, word, 16) ^
          crc64::Lookup(4, word, 24) ^ crc64::Lookup(3, word, 32) ^ crc64::Lookup(2, word, 40) ^
          crc64::Lookup(1, word, 48) ^ crc64::Lookup(0, word, 56);
  }
  HP_LOOP_BOUND(7)
  for (; at < bytes.size(); ++at) {
    crc = (crc >> 8) ^ crc64::Lookup(0, crc ^ reader.U8(at), 0);
  }
  return ~crc;
}

}  // namespace hardpack::ouster
