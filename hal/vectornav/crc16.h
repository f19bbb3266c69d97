// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.h"
#include "core/base/loop_bound.h"

// The CRC-16 of VectorNav's messages: polynomial x^16 + x^12 + x^5 + 1 (CCITT), highest bit first,
// started from zero, nothing inverted (known as CRC-16/XMODEM). The high byte is sent first, so
// that the CRC over a message and its CRC is zero.
//
// A CRC started from zero is the remainder of a polynomial, so that of a part of a stream follows
// from those at its two ends: with C(i) the CRC of the stream's first i bytes,
//   CRC of bytes i .. i + n - 1 = C(i + n) - C(i) x^(8 n)   (mod the polynomial)
// [Sarwate 1988]. So a parser that keeps C checks a message of any length in a fixed number of
// steps, however many false starts of long messages the stream contains.

namespace hardpack::vectornav {

// Largest input of the functions below: no message is longer.
inline constexpr size_t kMaxCrcBytes = 1280;

namespace crc16 {

consteval std::array<uint16_t, 256> MakeTable() {
  constexpr uint32_t kPolynomial = 0x1021u;
  std::array<uint16_t, 256> table{};
  HP_LOOP_BOUND(256)
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t crc = byte << 8u;
    HP_LOOP_BOUND(8)
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc << 1u) ^ ((crc & 0x8000u) != 0 ? kPolynomial : 0u);
    }
    table[byte] = static_cast<uint16_t>(crc & 0xffffu);
  }
  return table;
}

inline constexpr std::array<uint16_t, 256> kTable = MakeTable();

}  // namespace crc16

// The CRC of a message extended by `byte`. Cost: one look-up.
constexpr uint16_t Crc16Step(uint16_t crc, uint8_t byte) {
  const uint32_t shifted = uint32_t{crc} << 8u & 0xffffu;
  return static_cast<uint16_t>(shifted ^ crc16::kTable[uint32_t{crc} >> 8u ^ byte]);
}

// Precondition: at most kMaxCrcBytes. Cost: one look-up per byte.
constexpr uint16_t Crc16(std::span<const uint8_t> bytes) {
  HP_ASSERT(bytes.size() <= kMaxCrcBytes);
  uint16_t crc = 0;
  HP_LOOP_BOUND(kMaxCrcBytes)
  for (const uint8_t byte : bytes) crc = Crc16Step(crc, byte);
  return crc;
}

namespace crc16 {

// x^(8 n), n the index.
consteval std::array<uint16_t, kMaxCrcBytes + 1> MakePowers() {
  std::array<uint16_t, kMaxCrcBytes + 1> powers{};
  powers[0] = 1;
  HP_LOOP_BOUND(kMaxCrcBytes)
  for (size_t n = 1; n <= kMaxCrcBytes; ++n) powers[n] = Crc16Step(powers[n - 1], 0);
  return powers;
}

inline constexpr std::array<uint16_t, kMaxCrcBytes + 1> kPowers = MakePowers();

constexpr uint16_t Multiply(uint16_t a, uint16_t b) {
  constexpr uint32_t kPolynomial = 0x11021u;
  uint32_t product = 0;
  HP_LOOP_BOUND(16)
  for (int bit = 15; bit >= 0; --bit) {
    product <<= 1u;
    if ((product & 0x10000u) != 0) product ^= kPolynomial;
    if ((uint32_t{b} >> bit & 1u) != 0) product ^= a;
  }
  return static_cast<uint16_t>(product);
}

}  // namespace crc16

// The CRC of `size` bytes of a stream: `before` and `behind` are the CRCs of everything before them
// and of everything up to their end. Precondition: size <= kMaxCrcBytes. Cost: 16 steps.
constexpr uint16_t Crc16Between(uint16_t before, uint16_t behind, size_t size) {
  HP_ASSERT(size <= kMaxCrcBytes);
  return behind ^ crc16::Multiply(before, crc16::kPowers[size]);
}

}  // namespace hardpack::vectornav
