// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/base/pose.h"
#include "core/measurements/measurements.h"

// Classes for a recording without labels: which returns are ground, by height alone. It tells no
// soft obstacle from a hard one.

namespace hardpack::capture {

// One return that is offered to the grid.
struct ClassedPoint {
  Vec3 point_odom;
  ReturnClass return_class = ReturnClass::kIgnored;
};

// Makes every point kGround or kHard. Ground lies at most kGroundHeight_m above the lowest point of
// the 15 x 15 cells around it, and inside a cone that starts kConeHeight_m above the vehicle's feet
// and rises by kConeSlope: far away a ring of returns has no other height near it to be compared
// with. When in doubt, hard. Points off the grid around `vehicle_odom` are hard.
inline constexpr float kGroundHeight_m = 0.5f;
inline constexpr float kConeHeight_m = 0.3f;
inline constexpr float kConeSlope = 0.1f;
void GuessGround(const Vec3& vehicle_odom, std::vector<ClassedPoint>& points);

}  // namespace hardpack::capture
