// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The only conversion from float to integer: a plain cast outside the target's range is undefined
// and differs between processors. NaN gives 0; values out of range give the nearest limit. Inline:
// map sampling goes through it.

namespace hardpack {

inline constexpr float kTwoTo31 = 2147483648.0f;

// True where a cast to int32_t is defined.
constexpr bool FitsInt32(float value) {
  return value >= -kTwoTo31 && value < kTwoTo31;
}

// The result of the functions below where it is not.
constexpr int32_t SaturatedInt32(float value) {
  if (value >= kTwoTo31) return INT32_MAX;
  return value < -kTwoTo31 ? INT32_MIN : 0;
}

// Largest integer not above value.
constexpr int32_t FloorToInt(float value) {
  if (!FitsInt32(value)) return SaturatedInt32(value);
  const int32_t truncated = static_cast<int32_t>(value);
  // Cannot overflow: beyond 2^24 a float is an integer, equal to truncated.
  return static_cast<float>(truncated) > value ? truncated - 1 : truncated;
}

// Nearest integer; halves away from zero.
constexpr int32_t RoundToInt(float value) {
  if (!FitsInt32(value)) return SaturatedInt32(value);
  const int32_t truncated = static_cast<int32_t>(value);
  // Exact: beyond 2^23 a float has no fraction; below it, the difference is representable.
  const float fraction = value - static_cast<float>(truncated);
  if (fraction >= 0.5f) return truncated + 1;
  if (fraction <= -0.5f) return truncated - 1;
  return truncated;
}

// value limited to [low, high]. Precondition: low <= high.
constexpr int32_t ClampInt(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : (high < value ? high : value);
}

// a + b, INT32_MIN or INT32_MAX where that is out of range.
inline int32_t SaturatedSum(int32_t a, int32_t b) {
  const int64_t sum = int64_t{a} + b;
  return sum > INT32_MAX ? INT32_MAX : sum < INT32_MIN ? INT32_MIN : static_cast<int32_t>(sum);
}

}  // namespace hardpack
