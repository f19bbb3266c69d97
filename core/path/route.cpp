// SPDX-License-Identifier: Apache-2.0
#include "core/path/route.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// Shorter legs have no direction.
constexpr float kLeastLeg_m = 1.0e-3f;

float Distance2(const Pose2& pose, Vec2 place) {
  const float dx_m = pose.x_m - place.x_m;
  const float dy_m = pose.y_m - place.y_m;
  return dx_m * dx_m + dy_m * dy_m;
}

Status CheckLimit(float speed_mps) {
  if (!IsFinite(speed_mps)) return Status::kNotFinite;
  return speed_mps >= 0.0f && speed_mps <= kMaxLegSpeed_mps ? Status::kOk
                                                            : Status::kInvalidArgument;
}

}  // namespace

Status CheckRoute(const Route& route) {
  Status status = CheckLimit(route.goal_speed_mps);
  HP_LOOP_BOUND(kMaxVias)
  for (const Via& via : route.vias) {
    if (!IsFinite(via.position_odom)) return Status::kNotFinite;
    status = Graver(status, CheckLimit(via.speed_mps));
  }
  return status;
}

Route RouteBehind(const Route& route, int passed) {
  Route behind;
  behind.goal_speed_mps = route.goal_speed_mps;
  HP_LOOP_BOUND(kMaxVias)
  for (int i = passed; i < route.vias.size(); ++i) {
    static_cast<void>(behind.vias.PushBack(route.vias[i]));
  }
  return behind;
}

int PassingPoint(const WorldPath& path, int from, Vec2 place_odom, float reach_m) {
  const float reach2_m2 = reach_m * reach_m;
  int nearest = -1;
  float least2_m2 = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = from; k < path.size(); ++k) {
    const float distance2_m2 = Distance2(path[k], place_odom);
    if (!(distance2_m2 <= reach2_m2)) {
      if (nearest >= 0) break;
      continue;
    }
    if (nearest >= 0 && distance2_m2 >= least2_m2) continue;
    nearest = k;
    least2_m2 = distance2_m2;
  }
  return nearest;
}

int ViasPassed(const WorldPath& path, const Route& route, float reach_m, int point) {
  int from = 0;
  int passed = 0;
  HP_LOOP_BOUND(kMaxVias)
  for (const Via& via : route.vias) {
    const int at = PassingPoint(path, from, via.position_odom, reach_m);
    if (at < 0 || at > point) break;
    from = at;
    ++passed;
  }
  return passed;
}

// With cos(a) = 2 cos(a / 2)^2 - 1.
bool IsGentle(Vec2 before, Vec2 behind, float max_curvature_per_m, float radius_m) {
  const float before_m = Sqrt(before.x_m * before.x_m + before.y_m * before.y_m);
  const float behind_m = Sqrt(behind.x_m * behind.x_m + behind.y_m * behind.y_m);
  if (!(before_m >= kLeastLeg_m) || !(behind_m >= kLeastLeg_m)) return false;
  const float cos_half = 1.0f / (1.0f + max_curvature_per_m * radius_m);
  const float dot = before.x_m * behind.x_m + before.y_m * behind.y_m;
  return dot >= (2.0f * cos_half * cos_half - 1.0f) * before_m * behind_m;
}

}  // namespace hardpack
