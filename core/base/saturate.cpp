// SPDX-License-Identifier: Apache-2.0
#include "core/base/saturate.h"

namespace hardpack {
namespace {

// 2^31 is a float32; the largest float32 below it is 2^31 - 128.
constexpr float kTwoTo31 = 2147483648.0f;

}  // namespace

int32_t FloorToInt(float value) {
  if (value >= kTwoTo31) return INT32_MAX;
  if (value < -kTwoTo31) return INT32_MIN;
  if (!(value == value)) return 0;  // NaN
  const int32_t truncated = static_cast<int32_t>(value);
  return static_cast<float>(truncated) > value ? truncated - 1 : truncated;
}

int32_t RoundToInt(float value) {
  if (value >= kTwoTo31) return INT32_MAX;
  if (value < -kTwoTo31) return INT32_MIN;
  if (!(value == value)) return 0;  // NaN
  const int32_t truncated = static_cast<int32_t>(value);
  // Exact: beyond 2^23 a float has no fraction, below it the difference is representable.
  const float fraction = value - static_cast<float>(truncated);
  if (fraction >= 0.5f) return truncated + 1;
  if (fraction <= -0.5f) return truncated - 1;
  return truncated;
}

}  // namespace hardpack
