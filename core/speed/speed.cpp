// SPDX-License-Identifier: Apache-2.0
#include "core/speed/speed.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

constexpr float kLeastFreeWay_m = 1.0e-6f;
// Covers the eight roundings between ReactionSpeedCap and StoppingDistance, each 2^-24 at most.
constexpr float kBelowTheInverse = 1.0f - 1.0f / 1048576.0f;
float Squared(float value) {
  return value * value;
}

float ClampCurvature(float curvature_per_m) {
  return Clamp(curvature_per_m, -kCurvatureCeiling_per_m, kCurvatureCeiling_per_m);
}

// The parameters as CurvatureSpeedLimit uses them: what is the same for all points is computed
// once, squared speeds are compared, and a division is made only for a limit that binds.
struct ShapeLimits {
  ShapeLimits(const SpeedParams& params, const VehicleParams& vehicle)
      : per_gamma_m(1.0f / params.gamma_per_m),
        min_mps(params.min_speed_mps),
        span_mps(params.max_speed_mps - params.min_speed_mps),
        lateral_mps2(params.max_lateral_acceleration_mps2),
        yaw2_rad2ps2(Squared(params.max_yaw_rate_radps)),
        wheel2_m2ps2(Squared(params.max_wheel_speed_share * vehicle.max_wheel_speed_radps *
                             vehicle.wheel_radius_m)),
        half_baseline_m(0.5f * vehicle.skid_baseline_m),
        curvature_rate_per_ms(params.max_curvature_rate_per_s2) {}

  float Squared_m2ps2(float curvature_per_m, float curvature_rate_per_m2) const {
    const float kappa = Abs(curvature_per_m);
    const float rate = Abs(curvature_rate_per_m2);
    const float wheel_share = 1.0f + kappa * half_baseline_m;
    float limit = Squared(min_mps + span_mps * (1.0f - Min(kappa * per_gamma_m, 1.0f)));
    limit = MinQuotient(limit, lateral_mps2, kappa);
    limit = MinQuotient(limit, yaw2_rad2ps2, kappa * kappa);
    limit = MinQuotient(limit, wheel2_m2ps2, wheel_share * wheel_share);
    return MinQuotient(limit, curvature_rate_per_ms, rate);
  }

  // min(limit, dividend / divisor); divisor may be 0.
  static float MinQuotient(float limit, float dividend, float divisor) {
    return limit * divisor > dividend ? dividend / divisor : limit;
  }

  float per_gamma_m;
  float min_mps;
  float span_mps;
  float lateral_mps2;
  float yaw2_rad2ps2;
  float wheel2_m2ps2;
  float half_baseline_m;
  float curvature_rate_per_ms;
};

bool IsSpeed(float value_mps) {
  return value_mps >= 0.0f && value_mps <= kMaxRequestSpeed_mps;
}

Status CheckCaps(const ActuatorPath& path, std::span<const float> cap_mps) {
  if (cap_mps.empty()) return Status::kOk;
  if (cap_mps.size() != static_cast<size_t>(path.steps.size()) + 1u) {
    return Status::kInvalidArgument;
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const float cap : cap_mps) {
    if (!IsFinite(cap)) return Status::kNotFinite;
    if (cap < 0.0f) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

Status CheckInput(const ActuatorPath& path, const SpeedRequest& request) {
  if (path.steps.empty()) return Status::kPathTooShort;
  if (!IsFinite(request.start_speed_mps) || !IsFinite(request.start_curvature_per_m) ||
      !IsFinite(request.goal_speed_mps)) {
    return Status::kNotFinite;
  }
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (const ActuatorStep& step : path.steps) {
    if (!IsFinite(step.phi_rad) || !IsFinite(step.dr_m)) return Status::kNotFinite;
  }
  if (!IsSpeed(request.start_speed_mps) || !IsSpeed(request.goal_speed_mps) ||
      request.slow_points < 0) {
    return Status::kInvalidArgument;
  }
  return CheckCaps(path, request.cap_mps);
}

// True where the vehicle must stand between two steps: at both ends of a turn on the spot, and
// between driving forward and driving in reverse.
bool MustStand(const ActuatorStep& before, const ActuatorStep& after) {
  return !HasLength(before.dr_m) || !HasLength(after.dr_m) ||
         (before.dr_m < 0.0f) != (after.dr_m < 0.0f);
}

// Squared limit of every point but the first, which is given.
void LimitPoints(const ShapeLimits& limits, const ActuatorPath& path, const SpeedRequest& request,
                 float everywhere_mps, float slow_mps, SpeedProfile& squared) {
  const int last = path.steps.size();
  const ActuatorStep* steps = path.steps.begin();
  float* limit2 = squared.begin();
  float kappa_before = ClampCurvature(request.start_curvature_per_m);
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k <= last; ++k) {
    const ActuatorStep& before = steps[k - 1];
    const ActuatorStep& after = steps[k < last ? k : k - 1];
    float kappa = 0.0f;  // A standing vehicle may leave in any direction.
    limit2[k] = 0.0f;
    if (!MustStand(before, after)) {
      const float per_m = 1.0f / MeanChord(Abs(before.dr_m), Abs(after.dr_m));
      kappa = ClampCurvature(before.phi_rad * per_m);
      const float rate = (kappa - kappa_before) * per_m;
      const float cap_mps = k < request.slow_points ? slow_mps : everywhere_mps;
      limit2[k] = Min(limits.Squared_m2ps2(kappa, rate), Squared(cap_mps));
    }
    kappa_before = kappa;
  }
  limit2[last] = Min(limit2[last], Squared(request.goal_speed_mps));
}

void LimitByCaps(std::span<const float> cap_mps, SpeedProfile& squared) {
  if (cap_mps.empty()) return;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k < squared.size(); ++k) {
    squared[k] = Min(squared[k], Squared(cap_mps[static_cast<size_t>(k)]));
  }
}

// v_k^2 <= v_{k+1}^2 + 2 a |dr_k|, from the end.
void LimitDeceleration(const ActuatorPath& path, float deceleration_mps2, SpeedProfile& squared) {
  const float loss_per_m = 2.0f * deceleration_mps2;
  float behind = squared.back();
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int k = squared.size() - 2; k >= 1; --k) {
    behind = Min(squared[k], behind + loss_per_m * Abs(path.steps[k].dr_m));
    squared[k] = behind;
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

// v_k^2 <= v_{k-1}^2 + 2 a |dr_{k-1}|, from a point whose predecessor is final.
void LimitAcceleration(const ActuatorPath& path, float acceleration_mps2, int from,
                       SpeedProfile& squared) {
  const float gain_per_m = 2.0f * acceleration_mps2;
  float before = squared[from - 1];
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = from; k < squared.size(); ++k) {
    before = Min(squared[k], before + gain_per_m * Abs(path.steps[k - 1].dr_m));
    squared[k] = before;
  }
}

}  // namespace

float CurvatureBetween(float turn_rad, float chord_before_m, float chord_after_m) {
  if (!HasLength(chord_before_m) || !HasLength(chord_after_m)) return 0.0f;
  return ClampCurvature(turn_rad / MeanChord(chord_before_m, chord_after_m));
}

float CurvatureSpeedLimit(const SpeedParams& params, const VehicleParams& vehicle,
                          float curvature_per_m, float curvature_rate_per_m2) {
  const ShapeLimits limits(params, vehicle);
  return Sqrt(limits.Squared_m2ps2(curvature_per_m, curvature_rate_per_m2));
}

float StoppingDistance(const SpeedParams& params, float speed_mps) {
  const float delay_s =
      params.reaction_time_s + params.stopping_dead_time_s + params.stopping_lag_s;
  return speed_mps * delay_s + speed_mps * speed_mps / (2.0f * params.max_deceleration_mps2);
}

float ReactionSpeedCap(const SpeedParams& params, float free_m) {
  if (!(free_m >= kLeastFreeWay_m)) return 0.0f;
  if (free_m >= StoppingDistance(params, params.max_speed_mps)) return params.max_speed_mps;
  // The positive root of v^2 / (2 a) + t v = free, written without the cancellation of
  // a (sqrt(t^2 + 2 free / a) - t).
  const float delay_s =
      params.reaction_time_s + params.stopping_dead_time_s + params.stopping_lag_s;
  const float root_s = Sqrt(delay_s * delay_s + 2.0f * free_m / params.max_deceleration_mps2);
  return Min(kBelowTheInverse * (2.0f * free_m / (delay_s + root_s)), params.max_speed_mps);
}

float PersonSpeedCap(const SpeedParams& params, const VehicleParams& vehicle, float along_m,
                     float lateral_m) {
  const float half_length_m = 0.5f * vehicle.length_m;
  const float way_by_m = along_m + half_length_m;
  if (way_by_m <= 0.0f) return params.max_speed_mps;
  // lateral > v_person t with t = way / v_min, without the division.
  const float aside_m = lateral_m - params.person_margin_m;
  if (aside_m * params.min_speed_mps > params.person_speed_mps * way_by_m) {
    return params.max_speed_mps;
  }
  return ReactionSpeedCap(params, along_m - half_length_m - params.person_margin_m);
}

Status PlanSpeed(const SpeedParams& params, const VehicleParams& vehicle, const ActuatorPath& path,
                 const SpeedRequest& request, SpeedProfile& speed) {
  speed.Clear();
  const Status status = CheckInput(path, request);
  if (!IsUsable(status)) return status;
  // Until the last pass, `speed` holds squared speeds [m^2/s^2].
  speed.Resize(path.steps.size() + 1);
  const float everywhere_mps = request.narrow ? params.min_speed_mps : params.max_speed_mps;
  const float slow_mps = Min(everywhere_mps, params.obstacle_start_speed_mps);
  LimitPoints(ShapeLimits(params, vehicle), path, request, everywhere_mps, slow_mps, speed);
  LimitByCaps(request.cap_mps, speed);
  LimitDeceleration(path, params.max_deceleration_mps2, speed);
  speed[0] = Squared(request.start_speed_mps);
  const int within = BrakeFromStart(path, params.max_deceleration_mps2, speed);
  LimitAcceleration(path, params.max_acceleration_mps2, within, speed);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (float& value : speed) value = Sqrt(value);
  speed[0] = request.start_speed_mps;
  return Status::kOk;
}

}  // namespace hardpack
