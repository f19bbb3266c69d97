// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/tracking.h"

#include "config/validate.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// No nearer than this is a point a direction to aim at.
constexpr float kMinAim_m = 0.05f;

bool IsFiniteInput(const TrackingInput& input) {
  return IsFinite(input.pose.x_m) && IsFinite(input.pose.y_m) && IsFinite(input.pose.theta_rad) &&
         IsFinite(input.speed_limit_mps) && IsFinite(input.aim.pose.x_m) &&
         IsFinite(input.aim.pose.y_m) && IsFinite(input.aim.pose.theta_rad);
}

}  // namespace

Status Tracker::Configure(const VehicleParams& vehicle, const SpeedParams& speed,
                          const OdometryParams& odometry, const TrackingParams& tracking) {
  *this = Tracker{};
  OnboardParams onboard;
  onboard.odometry = odometry;
  onboard.tracking = tracking;
  if (FirstInvalidParameter(onboard) != nullptr) return Status::kParameterOutOfRange;
  vehicle_ = vehicle;
  limits_ = speed;
  odometry_ = odometry;
  params_ = tracking;
  configured_ = true;
  return Status::kOk;
}

Status Tracker::Follow(const TrackingInput& input, float dt_s, TrackingOutput& output) {
  return Drive(input, false, dt_s, output);
}

Status Tracker::StopAlong(const TrackingInput& input, float dt_s, TrackingOutput& output) {
  return Drive(input, true, dt_s, output);
}

void Tracker::Zero(TrackingOutput& output) {
  speed_mps_ = 0.0f;
  curvature_per_m_ = 0.0f;
  output = TrackingOutput{};
}

// Arc through the vehicle's pose, along its heading, and the point aimed at.
float Tracker::CurvatureTo(const TrackingInput& input) const {
  const SinCosPair heading = SinCos(input.pose.theta_rad);
  const float dx_m = input.aim.pose.x_m - input.pose.x_m;
  const float dy_m = input.aim.pose.y_m - input.pose.y_m;
  const float ahead_m = heading.cos * dx_m + heading.sin * dy_m;
  const float left_m = heading.cos * dy_m - heading.sin * dx_m;
  const float distance2_m2 = ahead_m * ahead_m + left_m * left_m;
  if (ahead_m < kMinAim_m) return 0.0f;  // at the end of the path, or past it
  return 2.0f * left_m / distance2_m2;
}

Status Tracker::Drive(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output) {
  if (!configured_ || !IsFiniteInput(input) || !IsFinite(dt_s) || dt_s <= 0.0f) {
    Zero(output);
    return configured_ ? Status::kNotFinite : Status::kNotStarted;
  }
  if (input.turn) {
    speed_mps_ = 0.0f;
    curvature_per_m_ = 0.0f;
    const float error_rad = WrapAngle(input.aim.pose.theta_rad - input.pose.theta_rad);
    const float rate_radps = Clamp(params_.heading_gain_per_s * error_rad,
                                   -params_.max_pivot_rate_radps, params_.max_pivot_rate_radps);
    Mix(0.0f, stops ? 0.0f : rate_radps, output);
    return Status::kOk;
  }
  const float limit_mps = stops ? 0.0f : Clamp(input.speed_limit_mps, 0.0f, limits_.max_speed_mps);
  speed_mps_ = Clamp(limit_mps, speed_mps_ - limits_.max_deceleration_mps2 * dt_s,
                     speed_mps_ + limits_.max_acceleration_mps2 * dt_s);
  curvature_per_m_ = CurvatureTo(input);
  const float largest_radps = limits_.max_yaw_rate_radps;
  const float rate_radps = Clamp(speed_mps_ * curvature_per_m_, -largest_radps, largest_radps);
  Mix(speed_mps_, rate_radps, output);
  return Status::kOk;
}

// The turn keeps the vehicle on its path, so it comes first: the speed gets what is left.
void Tracker::Mix(float speed_mps, float yaw_rate_radps, TrackingOutput& output) {
  const float rim_m = vehicle_.wheel_radius_m * odometry_.ground_per_wheel;
  const float largest_radps = vehicle_.max_wheel_speed_radps;
  const float half_radps = Clamp(yaw_rate_radps * vehicle_.skid_baseline_m / (2.0f * rim_m),
                                 -largest_radps, largest_radps);
  const float common_radps = Clamp(speed_mps / rim_m, 0.0f, largest_radps - Abs(half_radps));
  output.speed_mps = common_radps * rim_m;
  output.yaw_rate_radps = half_radps * 2.0f * rim_m / vehicle_.skid_baseline_m;
  output.curvature_per_m = curvature_per_m_;
  output.wheels = {.left_radps = common_radps - half_radps,
                   .right_radps = common_radps + half_radps};
}

}  // namespace hardpack
