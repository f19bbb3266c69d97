// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/costmap/costmap.h"

namespace hardpack {

// Costmap::CostAt at many places, bit for bit the same, several at a time. NaN gives the cost of a
// corner or of a border here too, perhaps a different one. x_m, y_m, costs: [points], odom frame;
// at most kMaxSamples. Cost: four cells per place.
inline constexpr int kSampleBlock = 16;
inline constexpr int kMaxSamples = 512;
void SampleCosts(const Costmap& map, const float* x_m, const float* y_m, int points, float* costs);

}  // namespace hardpack
