// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/vehicle_model.h"

#include <cmath>

#include "tools/sim/vehicle/exact_math.h"

namespace hardpack::sim {

VehicleModel::VehicleModel(const VehicleModelParams& params, const Pose& start, double step_s)
    : params_(params), step_s_(step_s), wheels_(params, step_s), body_({}, step_s), pose_(start) {}

double VehicleModel::GroundSpeed_mps() const {
  const double common_radps = wheels_.speeds().common_radps();
  const double differential_radps = wheels_.speeds().differential_radps();
  const double turning = differential_radps * differential_radps;
  const double all = common_radps * common_radps + turning;
  const double kept = all > 0.0 ? 1.0 - params_.turn_slip * (turning / all) : 1.0;
  return params_.ground_per_wheel * params_.wheel_radius_m * common_radps * kept;
}

double VehicleModel::KinematicYawRate_radps() const {
  return 2.0 * params_.wheel_radius_m * wheels_.speeds().differential_radps() /
         params_.skid_baseline_m;
}

double VehicleModel::LateralSpeed_mps() const {
  const double knee_mps = params_.turning_point_speed_mps;
  const double ahead_m = params_.turning_point_m * speed_mps_ /
                         std::sqrt(speed_mps_ * speed_mps_ + knee_mps * knee_mps);
  return -yaw_rate_radps_ * ahead_m;
}

double VehicleModel::Followed(double value, double target, double time_constant_s) const {
  if (time_constant_s <= step_s_) return target;
  return value + (target - value) * (step_s_ / time_constant_s);
}

void VehicleModel::Settle(const WheelSpeeds& speeds, const WheelSpeeds& command) {
  wheels_.Settle(speeds, command);
  SettleBody();
}

void VehicleModel::Settle(const WheelSpeeds& speeds, const WheelSpeeds& command,
                          double integral_radps) {
  wheels_.Settle(speeds, command, integral_radps);
  SettleBody();
}

void VehicleModel::SettleBody() {
  speed_mps_ = GroundSpeed_mps();
  yaw_rate_radps_ = KinematicYawRate_radps();
  lateral_speed_mps_ = LateralSpeed_mps();
}

void VehicleModel::Step(const WheelSetpoints& setpoints) {
  wheels_.Step(setpoints);
  MoveBody();
}

void VehicleModel::StepBody(const WheelSpeeds& speeds) {
  wheels_.Force(speeds);
  MoveBody();
}

void VehicleModel::MoveBody() {
  const double speed_before_mps = speed_mps_;
  const double lateral_before_mps = lateral_speed_mps_;
  const double level_mps =
      Followed(speed_mps_, body_.Crept(GroundSpeed_mps()), params_.speed_time_constant_s);
  speed_mps_ = body_.Along(speed_mps_, level_mps, yaw_rate_radps_);
  yaw_rate_radps_ =
      Followed(yaw_rate_radps_, KinematicYawRate_radps(), params_.yaw_time_constant_s);
  lateral_speed_mps_ = LateralSpeed_mps() + body_.slip_left_mps();
  // The body's axes turn, so that a steady turn has a centripetal part.
  acceleration_x_mps2_ =
      (speed_mps_ - speed_before_mps) / step_s_ - yaw_rate_radps_ * lateral_speed_mps_;
  acceleration_y_mps2_ =
      (lateral_speed_mps_ - lateral_before_mps) / step_s_ + yaw_rate_radps_ * speed_mps_;
  Move();
}

void VehicleModel::Move() {
  const SinCosOf heading = ExactSinCos(pose_.theta_rad + 0.5 * yaw_rate_radps_ * step_s_);
  const double ahead_mps = body_.ground().LevelForward() * speed_mps_;
  const double left_mps = body_.ground().LevelLeft() * lateral_speed_mps_;
  pose_.x_m += (heading.cos * ahead_mps - heading.sin * left_mps) * step_s_;
  pose_.y_m += (heading.sin * ahead_mps + heading.cos * left_mps) * step_s_;
  pose_.theta_rad += yaw_rate_radps_ * step_s_;
  driven_m_ +=
      std::sqrt(speed_mps_ * speed_mps_ + lateral_speed_mps_ * lateral_speed_mps_) * step_s_;
}

}  // namespace hardpack::sim
