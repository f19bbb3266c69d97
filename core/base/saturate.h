// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// The only way from float to integer: a plain cast outside the target's range is undefined and
// differs between processors. NaN gives 0; values beyond the range give its nearest end.
int32_t FloorToInt(float value);  // Largest integer not above value.
int32_t RoundToInt(float value);  // Nearest; halves away from zero.

// value limited to [low, high]. Precondition: low <= high.
constexpr int32_t ClampInt(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : (high < value ? high : value);
}

}  // namespace hardpack
