// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>

// Selections on the bits of a number. A compiler may turn `condition ? a : b` and the computation
// of a and b into a branch, and then it does not vectorise the surrounding loop; it cannot do so
// with these.

namespace hardpack::branch_free {

// value, or 0 if the condition is false.
inline float KeptIf(bool condition, float value) {
  return std::bit_cast<float>(std::bit_cast<int32_t>(value) & -static_cast<int32_t>(condition));
}

// The larger of value and 0; a value with its sign bit set gives 0.
inline float NotBelowZero(float value) {
  const int32_t bits = std::bit_cast<int32_t>(value);
  return std::bit_cast<float>(bits & ~(bits >> 31));
}

// The smaller of two numbers that are not negative: their bits have the same order. NaN is larger
// than all.
inline float Smaller(float a, float b) {
  const int32_t bits_a = std::bit_cast<int32_t>(a);
  const int32_t bits_b = std::bit_cast<int32_t>(b);
  const int32_t first = -static_cast<int32_t>(bits_a < bits_b);
  return std::bit_cast<float>((bits_a & first) | (bits_b & ~first));
}

inline float Magnitude(float value) {
  return std::bit_cast<float>(std::bit_cast<int32_t>(value) & INT32_MAX);
}

// size with the sign of `signed_value`. Precondition: size has none.
inline float WithSignOf(float signed_value, float size) {
  return std::bit_cast<float>(std::bit_cast<int32_t>(size) |
                              (std::bit_cast<int32_t>(signed_value) & INT32_MIN));
}

}  // namespace hardpack::branch_free
