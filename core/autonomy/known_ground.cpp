// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/known_ground.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

// A direction of which less is level than this stands upright: the vehicle has rolled over.
constexpr float kLeastLevel = 0.1f;

float HeightOf(const HeightGrid::CellHeights& cell) {
  const int32_t ground_cm = cell.ground ? cell.lowest_cm : -HeightGrid::kMaxHeight_cm;
  const bool is_higher =
      cell.highest_hard_cm != HeightGrid::kNone && cell.highest_hard_cm > ground_cm;
  return FromCentimeters(is_higher ? cell.highest_hard_cm : ground_cm);
}

}  // namespace

float LeastFallToKnown(const HeightGrid& heights, const Transform3& odom_from_body,
                       const Vec3& sensor_body, Vec2 direction_body) {
  const float* r = odom_from_body.rotation;
  const Vec3 sensor = odom_from_body.Apply(sensor_body);
  // The direction, in odom, and the body's z axis.
  const float x = r[0] * direction_body.x_m + r[1] * direction_body.y_m;
  const float y = r[3] * direction_body.x_m + r[4] * direction_body.y_m;
  const float z = r[6] * direction_body.x_m + r[7] * direction_body.y_m;
  const float level = Sqrt(x * x + y * y);
  if (!(level > kLeastLevel)) return kNoFall;
  const float upright = r[2] * x / level + r[5] * y / level;
  float least = kNoFall;
  HP_LOOP_BOUND(kKnownPlaces)
  for (int i = 0; i < kKnownPlaces; ++i) {
    const float far_m = kNearestKnown_m + kKnownStep_m * static_cast<float>(i);
    const float share = far_m / level;
    const Cell cell = CellAt({sensor.x_m + share * x, sensor.y_m + share * y});
    const HeightGrid::CellHeights there = heights.At(cell);
    if (!there.ground && there.highest_hard_cm == HeightGrid::kNone) continue;
    const float rise_m = HeightOf(there) - sensor.z_m;
    // Along the body's axes.
    const float along_m = far_m * level + z * rise_m;
    const float fall_m = -(far_m * upright + r[8] * rise_m);
    if (along_m > 0.0f) least = Min(least, fall_m / along_m);
  }
  return least;
}

}  // namespace hardpack
