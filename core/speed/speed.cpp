// SPDX-License-Identifier: Apache-2.0
#include "core/speed/speed.h"

#include "core/base/footprint.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

// The loops over the points choose by Min, Max and ?: of what is already computed, and look for bad
// numbers to the end, so that compilers take four points at a time.

namespace hardpack {
namespace {

constexpr float kLeastFreeWay_m = 1.0e-6f;
// Covers the eight roundings between ReactionSpeedCap and StoppingDistance, each 2^-24 at most.
constexpr float kBelowTheInverse = 1.0f - 1.0f / 1048576.0f;

// The limits of CurvatureSpeedLimit, inverted once for all points, so that a point takes the
// largest of the inverses and one division.
struct ShapeLimits {
  ShapeLimits(const SpeedParams& params, const VehicleParams& vehicle)
      : min_mps(params.min_speed_mps),
        max_mps(params.max_speed_mps),
        fall_m2ps((params.max_speed_mps - params.min_speed_mps) / params.gamma_per_m),
        per_lateral_s2pm(1.0f / params.max_lateral_acceleration_mps2),
        per_yaw_s(1.0f / params.max_yaw_rate_radps),
        per_wheel_spm(1.0f / (params.max_wheel_speed_share * vehicle.max_wheel_speed_radps *
                              vehicle.wheel_radius_m)),
        turn_per_wheel_s(0.5f * vehicle.skid_baseline_m * per_wheel_spm),
        per_rate_s2(1.0f / params.max_curvature_rate_per_s2) {}

  // The squared limit where the curvature is curvature_per_m, after a change of change_per_m over
  // way_m. The divisor is never 0: the wheels always have a limit.
  float Squared_m2ps2(float curvature_per_m, float change_per_m, float way_m) const {
    const float kappa = Abs(curvature_per_m);
    const float paper_mps = Max(min_mps, max_mps - kappa * fall_m2ps);
    const float per_turn = Max(kappa * per_lateral_s2pm, Squared(kappa * per_yaw_s));
    const float per_shape = Max(per_turn, Squared(per_wheel_spm + kappa * turn_per_wheel_s));
    const float per_change = Abs(change_per_m) * per_rate_s2;
    return Min(Squared(paper_mps), way_m / Max(per_shape * way_m, per_change));
  }

  float min_mps;
  float max_mps;
  float fall_m2ps;
  float per_lateral_s2pm;
  float per_yaw_s;
  float per_wheel_spm;
  float turn_per_wheel_s;
  float per_rate_s2;
};

bool IsSpeed(float value_mps) {
  return value_mps >= 0.0f && value_mps <= kMaxRequestSpeed_mps;
}

Status CheckCaps(const ActuatorPath& path, std::span<const float> cap_mps) {
  if (cap_mps.empty()) return Status::kOk;
  if (cap_mps.size() != static_cast<size_t>(path.steps.size()) + 1u) {
    return Status::kInvalidArgument;
  }
  uint32_t not_finite = 0;
  uint32_t negative = 0;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const float cap : cap_mps) {
    not_finite |= IsFinite(cap) ? 0u : 1u;
    negative |= cap < 0.0f ? 1u : 0u;
  }
  if (not_finite != 0u) return Status::kNotFinite;
  return negative != 0u ? Status::kInvalidArgument : Status::kOk;
}

bool HasFiniteSteps(const ActuatorPath& path) {
  uint32_t not_finite = 0;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (const ActuatorStep& step : path.steps) {
    not_finite |= IsFinite(step.phi_rad) ? 0u : 1u;
    not_finite |= IsFinite(step.dr_m) ? 0u : 1u;
  }
  return not_finite == 0u;
}

Status CheckInput(const ActuatorPath& path, const SpeedRequest& request) {
  if (path.steps.empty()) return Status::kPathTooShort;
  if (!IsFinite(request.start_speed_mps) || !IsFinite(request.start_curvature_per_m) ||
      !IsFinite(request.goal_speed_mps)) {
    return Status::kNotFinite;
  }
  if (!HasFiniteSteps(path)) return Status::kNotFinite;
  if (!IsSpeed(request.start_speed_mps) || !IsSpeed(request.goal_speed_mps) ||
      request.slow_points < 0) {
    return Status::kInvalidArgument;
  }
  return CheckCaps(path, request.cap_mps);
}

// True where the vehicle must stand between two steps: at both ends of a turn on the spot, and
// between driving forward and driving in reverse.
bool MustStand(const ActuatorStep& before, const ActuatorStep& after) {
  const float forward_m = Min(before.dr_m, after.dr_m);
  const float reverse_m = -Max(before.dr_m, after.dr_m);
  return Max(forward_m, reverse_m) < kLeastChord_m;
}

// Way of path that belongs to the point between two steps [m]: the mean of both chords, and at
// least that of the shortest ones, so that it can be divided by where the vehicle stands as well.
float WayOf(const ActuatorStep& before, const ActuatorStep& after) {
  return Max(Abs(0.5f * before.dr_m + 0.5f * after.dr_m), kLeastChord_m);
}

// Curvature at a point; 0 where the vehicle stands, which may leave in any direction.
float CurvatureAt(const ActuatorStep& before, const ActuatorStep& after) {
  const float curvature_per_m = ClampCurvature(before.phi_rad / WayOf(before, after));
  return MustStand(before, after) ? 0.0f : curvature_per_m;
}

// Squared limit of a point from its shape, curvature_before_per_m being that of the point before.
float LimitAt(const ShapeLimits& limits, const ActuatorStep& before, const ActuatorStep& after,
              float curvature_before_per_m, float curvature_per_m) {
  const float limit_m2ps2 = limits.Squared_m2ps2(
      curvature_per_m, curvature_per_m - curvature_before_per_m, WayOf(before, after));
  return MustStand(before, after) ? 0.0f : limit_m2ps2;
}

// Squared limit of every point but the first, which is given. The curvatures are put down first, in
// the place where the limit of the point behind will stand, so that each is computed once.
void LimitPoints(ShapeLimits limits, const ActuatorPath& path, const SpeedRequest& request,
                 SpeedProfile& squared) {
  const int last = path.steps.size();
  const ActuatorStep* steps = path.steps.begin();
  const ActuatorStep& end = path.steps.back();
  float* limit2 = squared.begin();
  limit2[1] = ClampCurvature(request.start_curvature_per_m);
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int k = 1; k < last; ++k) limit2[k + 1] = CurvatureAt(steps[k - 1], steps[k]);
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int k = 1; k < last; ++k) {
    limit2[k] = LimitAt(limits, steps[k - 1], steps[k], limit2[k], limit2[k + 1]);
  }
  limit2[last] = Min(LimitAt(limits, end, end, limit2[last], CurvatureAt(end, end)),
                     Squared(request.goal_speed_mps));
}

// The first `count` points (all, if there are fewer) at limit_mps at most; point 0 is given.
void LimitFirst(int count, float limit_mps, SpeedProfile& squared) {
  const int limited = count < squared.size() ? count : squared.size();
  const float limit_m2ps2 = Squared(limit_mps);
  float* limit2 = squared.begin();
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k < limited; ++k) limit2[k] = Min(limit2[k], limit_m2ps2);
}

void LimitByCaps(std::span<const float> cap_mps, SpeedProfile& squared) {
  if (cap_mps.empty()) return;
  const float* cap = cap_mps.data();
  float* limit2 = squared.begin();
  const int points = squared.size();
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k < points; ++k) limit2[k] = Min(limit2[k], Squared(cap[k]));
}

// One pass over `count` points i = 0, 1, ... in kDirection along the path (1: forward, -1: from the
// end), where `step` leads to the first of them, `squared`, from the point before, which is final:
//   v_i^2 = min(limit_i^2, v_{i-1}^2 + 2 a |dr_i|)
// Each point waits for the one before. So that it need not wait long, four are taken at once: what
// their own limits leave of them is known early, and only the sum of the gains since the four
// before comes in last. It is the same but for the rounding of that sum.
template <int kDirection>
void LimitChange(float acceleration_mps2, const ActuatorStep* step, float* squared, int count) {
  const float gain_per_m = 2.0f * acceleration_mps2;
  const auto gain = [=](int i) { return gain_per_m * Abs(step[kDirection * i].dr_m); };
  const auto point = [=](int i) -> float& { return squared[kDirection * i]; };
  float before = point(-1);
  int i = 0;
  HP_LOOP_BOUND((kMaxPathPoints - 1) / 4)
  for (; i + 4 <= count; i += 4) {
    const float gain_1 = gain(i);
    const float gain_2 = gain_1 + gain(i + 1);
    const float gain_3 = gain_2 + gain(i + 2);
    const float gain_4 = gain_3 + gain(i + 3);
    const float own_1 = point(i);
    const float own_2 = Min(point(i + 1), own_1 + gain(i + 1));
    const float own_3 = Min(point(i + 2), own_2 + gain(i + 2));
    const float own_4 = Min(point(i + 3), own_3 + gain(i + 3));
    point(i) = Min(own_1, before + gain_1);
    point(i + 1) = Min(own_2, before + gain_2);
    point(i + 2) = Min(own_3, before + gain_3);
    before = Min(own_4, before + gain_4);
    point(i + 3) = before;
  }
  HP_LOOP_BOUND(3)
  for (; i < count; ++i) {
    before = Min(point(i), before + gain(i));
    point(i) = before;
  }
}

// A vehicle that starts faster than the limits let it brake is slowed at the deceleration limit
// until it is within them. Returns the first point where it is; the points before are final.
int BrakeFromStart(const ActuatorPath& path, float deceleration_mps2, SpeedProfile& squared) {
  const int last = path.steps.size();
  int k = 1;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (; k <= last; ++k) {
    const ActuatorStep& before = path.steps[k - 1];
    const float braked = squared[k - 1] - 2.0f * deceleration_mps2 * Abs(before.dr_m);
    if (braked <= squared[k]) break;
    squared[k] = MustStand(before, path.steps[k < last ? k : k - 1]) ? 0.0f : braked;
  }
  return k;
}

// What it takes longer to stop than the ramp does.
float StoppingDelay(const SpeedParams& params) {
  return params.reaction_time_s + params.stopping_dead_time_s + params.stopping_lag_s;
}

// The positive root of v^2 / (2 a) + t v = free, written without the cancellation of
// a (sqrt(t^2 + 2 free / a) - t).
float SpeedWithin(const SpeedParams& params, float delay_s, float free_m) {
  if (!(free_m >= kLeastFreeWay_m)) return 0.0f;
  const float root_s = Sqrt(delay_s * delay_s + 2.0f * free_m / params.max_deceleration_mps2);
  return Min(kBelowTheInverse * (2.0f * free_m / (delay_s + root_s)), params.max_speed_mps);
}

}  // namespace

float CurvatureSpeedLimit(const SpeedParams& params, const VehicleParams& vehicle,
                          float curvature_per_m, float curvature_rate_per_m2) {
  const ShapeLimits limits(params, vehicle);
  return Sqrt(limits.Squared_m2ps2(curvature_per_m, curvature_rate_per_m2, 1.0f));
}

float StoppingDistance(const SpeedParams& params, float speed_mps) {
  return speed_mps * StoppingDelay(params) +
         speed_mps * speed_mps / (2.0f * params.max_deceleration_mps2);
}

float StoppingTime(const SpeedParams& params, float speed_mps) {
  return StoppingDelay(params) + speed_mps / params.max_deceleration_mps2;
}

float ReactionSpeedCap(const SpeedParams& params, float free_m) {
  if (free_m >= StoppingDistance(params, params.max_speed_mps)) return params.max_speed_mps;
  return SpeedWithin(params, StoppingDelay(params), free_m);
}

float PassingTime(const SpeedParams& params, float way_m, float speed_mps) {
  const float least_mps = params.min_speed_mps;
  const float lacks_mps = Clamp(least_mps - speed_mps, 0.0f, least_mps);
  const float lag_s = params.stopping_dead_time_s + params.stopping_lag_s;
  const float behind_m =
      lacks_mps * lag_s + lacks_mps * lacks_mps / (2.0f * params.max_acceleration_mps2);
  const float starting_s = lacks_mps * (lag_s / least_mps + 1.0f / params.max_acceleration_mps2);
  return params.reaction_time_s + Max((way_m + behind_m) / least_mps, starting_s);
}

float PersonSpeedCap(const SpeedParams& params, const VehicleParams& vehicle, float along_m,
                     float lateral_m, float speed_mps, bool reverse) {
  const float way_by_m = along_m + TrailingEdgeOf(vehicle, reverse);
  if (way_by_m <= 0.0f) return params.max_speed_mps;
  const float aside_m = lateral_m - params.person_margin_m;
  if (aside_m > params.person_speed_mps * PassingTime(params, way_by_m, speed_mps)) {
    return params.max_speed_mps;
  }
  // s(v) + v_person T(v) = v (t + v_person / a) + v^2 / (2 a) + v_person t.
  const float delay_s = StoppingDelay(params);
  const float brakes_mps2 = params.max_deceleration_mps2;
  const float free_m = along_m - LeadingEdgeOf(vehicle, reverse) - params.person_margin_m;
  const float walk_mps = params.person_speed_mps;
  const float before_mps =
      SpeedWithin(params, delay_s + walk_mps / brakes_mps2, free_m - walk_mps * delay_s);
  const float beside_mps = aside_m > 0.0f ? brakes_mps2 * (aside_m / walk_mps - delay_s) : 0.0f;
  const float creep_mps = params.person_creep_mps;
  const float walk_s = params.reaction_time_s + Max(creep_mps, speed_mps) / brakes_mps2;
  const bool may_creep = aside_m > walk_mps * walk_s;
  const float creeps_mps = may_creep ? creep_mps : Min(creep_mps, ReactionSpeedCap(params, free_m));
  return Clamp(Max(Max(before_mps, beside_mps), creeps_mps), 0.0f, params.max_speed_mps);
}

Status PlanSpeed(const SpeedParams& params, const VehicleParams& vehicle, const ActuatorPath& path,
                 const SpeedRequest& request, SpeedProfile& speed) {
  speed.Clear();
  const Status status = CheckInput(path, request);
  if (!IsUsable(status)) return status;
  // Until the last pass, `speed` holds squared speeds [m^2/s^2].
  const int last = path.steps.size();
  speed.Resize(last + 1);
  LimitPoints(ShapeLimits(params, vehicle), path, request, speed);
  LimitFirst(request.slow_points, params.obstacle_start_speed_mps, speed);
  LimitByCaps(request.cap_mps, speed);
  const ActuatorStep* steps = path.steps.begin();
  float* squared = speed.begin();
  LimitChange<-1>(params.max_deceleration_mps2, steps + (last - 1), squared + (last - 1), last - 1);
  speed[0] = Squared(request.start_speed_mps);
  const int within = BrakeFromStart(path, params.max_deceleration_mps2, speed);
  LimitChange<1>(params.max_acceleration_mps2, steps + (within - 1), squared + within,
                 last + 1 - within);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (float& value : speed) value = Sqrt(value);
  speed[0] = request.start_speed_mps;
  return Status::kOk;
}

}  // namespace hardpack
