// SPDX-License-Identifier: Apache-2.0
#include "core/speed/ground_ahead.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/speed/speed.h"

namespace hardpack {
namespace {

// Of tyres on a slope, rise over run.
float Holds(const SpeedParams& params, float slope) {
  const float friction = kSureFriction * params.friction;
  return kStandardGravity_mps2 * (friction - slope) / Sqrt(1.0f + slope * slope);
}

bool IsTooSteep(const SpeedParams& params, float falls) {
  return Holds(params, falls - GroundAhead::kDoubt) < GroundAhead::kLeastBraking_mps2;
}

// The mean of a slope over the last kSmooth_m, each metre less than the one behind it; over all of
// it, as long as there is less.
struct Smooth {
  float told_m = 0.0f;
  float slope = 0.0f;
  bool has = false;

  void Take(float next, float driven_m) {
    told_m += driven_m;
    const float over_m = Min(told_m, GroundAhead::kSmooth_m);
    const float share = has && over_m > 0.0f ? Min(driven_m / over_m, 1.0f) : 1.0f;
    slope += share * (next - slope);
    has = true;
  }
  // Less says more about two rings of a lidar than about the ground.
  bool IsSure() const { return told_m >= GroundAhead::kSure_m; }
};

}  // namespace

GroundAhead LookAtGround(const Terrain& terrain, const GridWindow& window,
                         const SpeedParams& params, const WorldPath& path) {
  GroundAhead ahead;
  Smooth fall;
  Smooth bank;
  float along_m = 0.0f;
  float steep_from_m = 0.0f;  // where what is too steep begins, if it is
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < path.size(); ++k) {
    const int behind = k > 0 ? k - 1 : 0;
    const float driven_m = PlanarModel::Inverse(path[behind], path[k]).dr_m;
    along_m += Abs(driven_m);
    const Cell cell = CellAt({path[k].x_m, path[k].y_m});
    if (!window.Contains(cell)) continue;
    const Terrain::Ground ground = terrain.At(window.Index(cell));
    if (!ground.is_told) continue;
    const SinCosPair heading = SinCos(path[k].theta_rad);
    const bool reverse = IsReversed(path, k + 1 < path.size() ? k : behind);
    const float rise = ground.grade_x * heading.cos + ground.grade_y * heading.sin;
    const float falls = reverse ? rise : -rise;
    fall.Take(falls, Abs(driven_m));
    bank.Take(ground.grade_y * heading.cos - ground.grade_x * heading.sin, Abs(driven_m));
    if (!IsTooSteep(params, falls)) steep_from_m = along_m;
    if (!fall.IsSure()) continue;
    if (IsTooSteep(params, fall.slope)) {
      ahead.too_steep_m = steep_from_m;
      return ahead;
    }
    ahead.fall = Max(ahead.fall, fall.slope);
    ahead.bank = Max(ahead.bank, Abs(bank.slope));
  }
  if (!fall.IsSure()) {
    ahead.fall = Max(fall.slope, 0.0f);
    ahead.bank = Abs(bank.slope);
  }
  return ahead;
}

SpeedParams OnGround(const SpeedParams& params, const GroundAhead& ground) {
  SpeedParams on = params;
  constexpr float kLeast_mps2 = GroundAhead::kLeastBraking_mps2;
  on.max_deceleration_mps2 =
      Min(params.max_deceleration_mps2, Max(Holds(params, ground.fall), kLeast_mps2));
  on.max_lateral_acceleration_mps2 =
      Min(params.max_lateral_acceleration_mps2, Max(Holds(params, ground.bank), kLeast_mps2));
  on.max_speed_mps = ReactionSpeedCap(on, StoppingDistance(params, params.max_speed_mps));
  on.min_speed_mps = Min(params.min_speed_mps, on.max_speed_mps);
  on.least_room_mps = Min(params.least_room_mps, on.max_speed_mps);
  return on;
}

}  // namespace hardpack
