// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/binary64.h"

#include <bit>

#include "core/base/loop_bound.h"

namespace hardpack::vectornav {
namespace {

constexpr uint64_t kBillion = 1'000'000'000u;
constexpr uint64_t kSignBit = uint64_t{1} << 63u;
constexpr int kFractionBits = 52;
constexpr uint64_t kHiddenBit = uint64_t{1} << kFractionBits;
constexpr int kExponentBias = 1023;
constexpr uint32_t kExponentOfInfinity = 0x7ffu;

// magnitude = mantissa 2^exponent; mantissa below 2^53.
struct Parts {
  bool negative;
  bool finite;
  uint64_t mantissa;  // of a number that is not finite: its fraction
  int32_t exponent;   // -1074 .. 971
};

constexpr Parts Split(uint64_t bits) {
  const auto exponent = static_cast<uint32_t>(bits >> kFractionBits) & 0x7ffu;
  const uint64_t fraction = bits & (kHiddenBit - 1);
  const bool normal = exponent != 0 && exponent != kExponentOfInfinity;
  return {(bits & kSignBit) != 0, exponent != kExponentOfInfinity,
          normal ? fraction | kHiddenBit : fraction,
          static_cast<int32_t>(exponent == 0 ? 1 : exponent) - kExponentBias - kFractionBits};
}

// value / 2^shift to the nearest, ties to even. Precondition: 1 <= shift <= 63.
constexpr uint64_t ShiftToEven(uint64_t value, int32_t shift) {
  const uint64_t rest = value & ((uint64_t{1} << shift) - 1);
  const uint64_t half = uint64_t{1} << (shift - 1);
  const uint64_t whole = value >> shift;
  return rest > half || (rest == half && (whole & 1u) != 0) ? whole + 1 : whole;
}

}  // namespace

Status BillionthsFromBinary64(uint64_t bits, int64_t& billionths) {
  const Parts parts = Split(bits);
  if (!parts.finite) return Status::kNotFinite;
  // From 2^52 on the product is beyond 2^63.
  if (parts.exponent >= 0) return Status::kCapacityExceeded;

  // mantissa 10^9 < 2^83, as high 2^64 + low.
  const uint64_t upper = (parts.mantissa >> 32u) * kBillion;
  const uint64_t lower = (parts.mantissa & 0xffffffffu) * kBillion;
  uint64_t low = lower + (upper << 32u);
  uint64_t high = (upper >> 32u) + (low < lower ? 1u : 0u);

  // Then (product + 2^(shift - 1)) / 2^shift, rounded down.
  const int32_t shift = -parts.exponent;
  uint64_t magnitude = 0;
  if (shift < 64) {
    const uint64_t half = uint64_t{1} << (shift - 1);
    low += half;
    high += low < half ? 1u : 0u;
    if (high >> (shift - 1) != 0) return Status::kCapacityExceeded;
    magnitude = high << (64 - shift) | low >> shift;
  } else if (shift == 64) {
    magnitude = high + (low >> 63u);
  } else if (shift <= 84) {
    magnitude = (high + (uint64_t{1} << (shift - 65))) >> (shift - 64);
  }
  const auto value = static_cast<int64_t>(magnitude);
  billionths = parts.negative ? -value : value;
  return Status::kOk;
}

float FloatFromBinary64(uint64_t bits) {
  constexpr int32_t kDroppedBits = kFractionBits - 23;
  constexpr uint32_t kInfinity = 0x7f800000u;
  constexpr uint32_t kQuietBit = 0x00400000u;
  const Parts parts = Split(bits);
  const uint32_t sign = parts.negative ? 0x80000000u : 0u;
  if (!parts.finite) {
    return std::bit_cast<float>(sign | kInfinity | (parts.mantissa != 0 ? kQuietBit : 0u));
  }
  // Biased exponent of the float: below 1 it is subnormal, and so many bits more are dropped.
  const int32_t exponent = parts.exponent + kFractionBits + 127;
  const int32_t shift = exponent >= 1 ? kDroppedBits : kDroppedBits + 1 - exponent;
  if (shift > 63) return std::bit_cast<float>(sign);
  if (exponent > 254) return std::bit_cast<float>(sign | kInfinity);
  // The hidden bit adds one to the exponent field, and so does a carry out of the rounding.
  const auto mantissa = static_cast<uint32_t>(ShiftToEven(parts.mantissa, shift));
  const uint32_t below = exponent >= 1 ? static_cast<uint32_t>(exponent - 1) << 23u : 0u;
  return std::bit_cast<float>(sign | (below + mantissa));
}

uint64_t Binary64FromBillionths(int64_t billionths) {
  if (billionths == 0) return 0;
  const uint64_t sign = billionths < 0 ? kSignBit : 0;
  uint64_t rest = static_cast<uint64_t>(billionths);
  if (billionths < 0) rest = 0 - rest;
  uint64_t divisor = kBillion;
  int32_t exponent = 0;  // of the quotient's highest bit
  HP_LOOP_BOUND(33)
  for (; divisor <= rest >> 1u; ++exponent) divisor <<= 1u;
  HP_LOOP_BOUND(30)
  for (; rest < divisor; --exponent) rest <<= 1u;

  // 54 bits of the quotient, the first of them one: the last one tells how to round.
  uint64_t quotient = 0;
  HP_LOOP_BOUND(54)
  for (int bit = 0; bit < kFractionBits + 2; ++bit) {
    const bool fits = rest >= divisor;
    if (fits) rest -= divisor;
    quotient = quotient << 1u | (fits ? 1u : 0u);
    rest <<= 1u;
  }
  // No tie is possible: billionths would be 5^9 times a number of 54 bits, and so beyond 2^63.
  const uint64_t mantissa = (quotient >> 1u) + (quotient & 1u);
  // The hidden bit, and a carry out of the rounding, add to the exponent field.
  const auto below = static_cast<uint64_t>(exponent + kExponentBias - 1);
  return sign | ((below << kFractionBits) + mantissa);
}

uint64_t Binary64FromFloat(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const uint64_t sign = (bits & 0x80000000u) != 0 ? kSignBit : 0;
  uint32_t fraction = bits & 0x007fffffu;
  auto exponent = static_cast<int32_t>(bits >> 23u & 0xffu);
  if (exponent == 255) {
    return sign | uint64_t{kExponentOfInfinity} << kFractionBits | uint64_t{fraction} << 29u;
  }
  if (exponent == 0) {
    if (fraction == 0) return sign;
    // A subnormal float is a normal binary64.
    exponent = 1;
    HP_LOOP_BOUND(23)
    for (; (fraction & 0x00800000u) == 0; --exponent) fraction <<= 1u;
    fraction &= 0x007fffffu;
  }
  const auto biased = static_cast<uint64_t>(exponent - 127 + kExponentBias);
  return sign | biased << kFractionBits | uint64_t{fraction} << 29u;
}

}  // namespace hardpack::vectornav
