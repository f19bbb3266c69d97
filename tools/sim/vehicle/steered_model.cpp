// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/steered_model.h"

#include <algorithm>
#include <cmath>

#include "tools/sim/vehicle/exact_math.h"

namespace hardpack::sim {

SteeredModel::SteeredModel(const SteeredModelParams& params, const Pose& start, double step_s)
    : params_(params),
      step_s_(step_s),
      speed_setpoint_(params.dead_time_speed_s, step_s),
      steering_setpoint_(params.dead_time_steering_s, step_s),
      body_({.wheelbase_m = params.wheelbase_m, .track_m = params.track_m}, step_s),
      pose_(start) {}

void SteeredModel::Step(const SteeredSetpoints& setpoints) {
  Drive(setpoints);
  Steer(setpoints);
  Move();
}

void SteeredModel::Drive(const SteeredSetpoints& setpoints) {
  const double wanted_mps =
      std::clamp(speed_setpoint_.Step(setpoints.driven ? setpoints.speed_mps : 0.0),
                 -params_.max_speed_mps, params_.max_speed_mps);
  double change_mps2 = (wanted_mps - wheels_mps_) / params_.time_constant_speed_s;
  if (!setpoints.driven) change_mps2 = -wheels_mps_ / step_s_;
  const bool brakes = change_mps2 * wheels_mps_ < 0.0;
  const double most_mps2 = brakes ? params_.max_deceleration_mps2 : params_.max_acceleration_mps2;
  wheels_mps_ += std::clamp(change_mps2, -most_mps2, most_mps2) * step_s_;
  speed_mps_ = body_.Along(speed_mps_, body_.Crept(wheels_mps_), yaw_rate_radps_);
}

void SteeredModel::Steer(const SteeredSetpoints& setpoints) {
  const double told_rad = setpoints.driven ? setpoints.steering_rad : steering_rad_;
  const double wanted_rad = std::clamp(steering_setpoint_.Step(told_rad), -params_.max_steering_rad,
                                       params_.max_steering_rad);
  const double most_radps = params_.steering_rate_radps;
  steering_rad_ +=
      step_s_ * std::clamp((wanted_rad - steering_rad_) / params_.time_constant_steering_s,
                           -most_radps, most_radps);
}

void SteeredModel::Move() {
  const SinCosOf steering = ExactSinCos(steering_rad_);
  const double stiff_m =
      params_.wheelbase_m * (1.0 + params_.understeer_s2pm2 * speed_mps_ * speed_mps_);
  const double target_radps = speed_mps_ * steering.sin / steering.cos / stiff_m;
  const double share = std::min(1.0, step_s_ / std::max(step_s_, params_.yaw_time_constant_s));
  yaw_rate_radps_ += share * (target_radps - yaw_rate_radps_);
  const SinCosOf heading = ExactSinCos(pose_.theta_rad + 0.5 * yaw_rate_radps_ * step_s_);
  const double ahead_mps = body_.ground().LevelForward() * speed_mps_;
  const double left_mps = body_.ground().LevelLeft() * body_.slip_left_mps();
  pose_.x_m += (heading.cos * ahead_mps - heading.sin * left_mps) * step_s_;
  pose_.y_m += (heading.sin * ahead_mps + heading.cos * left_mps) * step_s_;
  pose_.theta_rad += yaw_rate_radps_ * step_s_;
  driven_m_ += std::abs(speed_mps_) * step_s_;
}

}  // namespace hardpack::sim
