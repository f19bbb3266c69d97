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

// The steepest way down on which kLeastBraking_mps2 is left, for sure (by the slope of the friction
// itself, which is a little steeper), and what it may be measured as.
float MostFall(const SpeedParams& params) {
  constexpr float kLeast = GroundAhead::kLeastBraking_mps2 / kStandardGravity_mps2;
  const float friction = kSureFriction * params.friction;
  return friction - kLeast * Sqrt(1.0f + friction * friction) + GroundAhead::kDoubt;
}

// The mean of a slope over the last kSmooth_m, each metre less than the one behind it; over all of
// it, as long as there is less.
struct Smooth {
  float told_m = 0.0f;
  float slope = 0.0f;

  void Take(float next, float driven_m) {
    told_m += driven_m;
    slope += Min(driven_m / Min(told_m, GroundAhead::kSmooth_m), 1.0f) * (next - slope);
  }
  // Less says more about two rings of a lidar than about the ground.
  bool IsSure() const { return told_m >= GroundAhead::kSure_m; }
};

// The change of a slope along the way, from its mean over the last kBend_m and the mean of these.
class Bend {
 public:
  // The vehicle may turn here: what comes is another way.
  void Restart() { has_begun_ = false; }

  // driven_m: since the last one, above 0. The magnitude [1/m].
  float Take(float slope, float driven_m) {
    if (!has_begun_) mean_ = mean_of_means_ = slope;
    has_begun_ = true;
    // Behind a slope that changes by b a metre each of the two means stays by kBend_m b.
    const float share = driven_m / (driven_m + GroundAhead::kBend_m);
    mean_ += share * (slope - mean_);
    mean_of_means_ += share * (mean_ - mean_of_means_);
    return Abs(mean_ - mean_of_means_) / GroundAhead::kBend_m;
  }

 private:
  bool has_begun_ = false;
  float mean_ = 0.0f;
  float mean_of_means_ = 0.0f;
};

}  // namespace

GroundAhead LookAtGround(const Terrain& terrain, const GridWindow& window,
                         const SpeedParams& params, const WorldPath& path) {
  GroundAhead ahead;
  Smooth fall;
  Smooth bank;
  Bend bend;
  const float most_fall = MostFall(params);
  float along_m = 0.0f;
  float steep_from_m = 0.0f;  // where what is too steep begins, if it is
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k < path.size(); ++k) {
    const Vec2 chord = {path[k].x_m - path[k - 1].x_m, path[k].y_m - path[k - 1].y_m};
    const float driven_m = Sqrt(chord.x_m * chord.x_m + chord.y_m * chord.y_m);
    along_m += driven_m;
    if (!HasLength(driven_m)) bend.Restart();
    const Cell cell = CellAt({path[k].x_m, path[k].y_m});
    if (!HasLength(driven_m) || !window.Contains(cell)) continue;
    const Terrain::Ground ground = terrain.At(window.Index(cell));
    if (!ground.is_told) continue;
    const float falls = -(ground.grade_x * chord.x_m + ground.grade_y * chord.y_m) / driven_m;
    fall.Take(falls, driven_m);
    bank.Take((ground.grade_y * chord.x_m - ground.grade_x * chord.y_m) / driven_m, driven_m);
    ahead.bend = Max(ahead.bend, bend.Take(falls, driven_m));
    if (falls <= most_fall) steep_from_m = along_m;
    if (!fall.IsSure()) continue;
    if (fall.slope > most_fall) {
      ahead.too_steep_m = steep_from_m;
      return ahead;
    }
    ahead.fall = Max(ahead.fall, fall.slope);
    ahead.rise = Max(ahead.rise, -fall.slope);
    ahead.bank = Max(ahead.bank, Abs(bank.slope));
  }
  if (!fall.IsSure()) {
    ahead.fall = Max(fall.slope, 0.0f);
    ahead.rise = Max(-fall.slope, 0.0f);
    ahead.bank = Abs(bank.slope);
  }
  return ahead;
}

SpeedParams OnGround(const SpeedParams& params, const GroundAhead& ground) {
  SpeedParams on = params;
  constexpr float kLeast_mps2 = GroundAhead::kLeastBraking_mps2;
  on.max_deceleration_mps2 =
      Min(params.max_deceleration_mps2, Max(Holds(params, ground.fall), kLeast_mps2));
  on.max_acceleration_mps2 =
      Min(params.max_acceleration_mps2, Max(Holds(params, ground.rise), kLeast_mps2));
  on.max_lateral_acceleration_mps2 =
      Min(params.max_lateral_acceleration_mps2, Max(Holds(params, ground.bank), kLeast_mps2));
  on.max_speed_mps = ReactionSpeedCap(on, StoppingDistance(params, params.max_speed_mps));
  const float vertical_mps2 = params.max_vertical_acceleration_mps2;
  if (Squared(on.max_speed_mps) * ground.bend > vertical_mps2) {
    on.max_speed_mps = Sqrt(vertical_mps2 / ground.bend);
  }
  on.min_speed_mps = Min(params.min_speed_mps, on.max_speed_mps);
  on.least_room_mps = Min(params.least_room_mps, on.max_speed_mps);
  return on;
}

}  // namespace hardpack
