// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/sim_vehicle.h"

#include <cmath>

namespace hardpack::sim {

VehicleSettings DefaultVehicle() {
  VehicleSettings settings;
  settings.left.identity.node = 2;
  settings.right.identity.node = 3;
  settings.right.identity.serial_number = 2;
  return settings;
}

SimVehicle::SimVehicle(const VehicleSettings& settings, uint64_t start_ns)
    : ground_(settings.ground),
      left_(settings.left, start_ns),
      right_(settings.right, start_ns),
      now_ns_(start_ns),
      pose_(settings.start) {
  if (!settings.model) return;
  model_.emplace(*settings.model, settings.start);
  left_.LeaveMotor();
  right_.LeaveMotor();
}

void SimVehicle::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  StepTo(now_ns);
  left_.TakeFrame(frame, now_ns);
  right_.TakeFrame(frame, now_ns);
}

void SimVehicle::Advance(uint64_t now_ns, std::vector<CanFrame>& sent) {
  StepTo(now_ns);
  CollectSent(now_ns_);  // answers to what came since
  sent.insert(sent.end(), outbox_.begin(), outbox_.end());
  outbox_.clear();
}

void SimVehicle::StepTo(uint64_t now_ns) {
  constexpr double kStep_s = 1.0e-9 * kStep_ns;
  while (now_ns_ + kStep_ns <= now_ns) {
    now_ns_ += kStep_ns;
    CollectSent(now_ns_);
    if (model_) {
      MoveModel();
    } else {
      Move(kStep_s);
    }
  }
}

void SimVehicle::CollectSent(uint64_t now_ns) {
  std::vector<CanFrame> of_left;
  std::vector<CanFrame> of_right;
  left_.Advance(now_ns, of_left);
  for (const CanFrame& frame : of_left) right_.TakeFrame(frame, now_ns);
  right_.Advance(now_ns, of_right);
  for (const CanFrame& frame : of_right) left_.TakeFrame(frame, now_ns);
  outbox_.insert(outbox_.end(), of_left.begin(), of_left.end());
  outbox_.insert(outbox_.end(), of_right.begin(), of_right.end());
}

void SimVehicle::MoveModel() {
  static_assert(kStep_ns == 1'000'000 && VehicleModel::kStep_s == 0.001);
  model_->Step({.speeds = {left_.setpoint_radps(), right_.setpoint_radps()},
                .left_driven = left_.turns(),
                .right_driven = right_.turns()});
  left_.TurnWheels(model_->wheels().left_radps);
  right_.TurnWheels(model_->wheels().right_radps);
  has_slipped_ = has_slipped_ || traction_ != 1.0;
  speed_mps_ = traction_ * model_->speed_mps();
  yaw_rate_radps_ = traction_ * model_->yaw_rate_radps();
  if (has_slipped_) return Integrate(VehicleModel::kStep_s);
  pose_ = model_->pose();
  driven_m_ = model_->driven_m();
}

void SimVehicle::Move(double seconds) {
  const double left_mps = ground_.wheel_radius_m * left_.wheel_radps();
  const double right_mps = ground_.wheel_radius_m * right_.wheel_radps();
  speed_mps_ = traction_ * ground_.ground_per_wheel * (left_mps + right_mps) / 2.0;
  yaw_rate_radps_ = traction_ * (right_mps - left_mps) / ground_.skid_baseline_m;
  Integrate(seconds);
}

void SimVehicle::Integrate(double seconds) {
  const double heading_rad = pose_.theta_rad + yaw_rate_radps_ * seconds / 2.0;
  pose_.x_m += speed_mps_ * seconds * std::cos(heading_rad);
  pose_.y_m += speed_mps_ * seconds * std::sin(heading_rad);
  pose_.theta_rad += yaw_rate_radps_ * seconds;
  driven_m_ += std::abs(speed_mps_) * seconds;
}

}  // namespace hardpack::sim
