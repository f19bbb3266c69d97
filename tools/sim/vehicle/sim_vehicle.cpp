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

namespace {

world::Footprint FootprintOf(const SteeredModelParams& params) {
  world::Footprint footprint;
  footprint.length_m = params.length_m;
  footprint.width_m = params.width_m;
  footprint.middle_m = params.length_m / 2.0 - params.rear_overhang_m;
  footprint.half_wheelbase_m = params.wheelbase_m / 2.0;
  footprint.half_track_m = params.track_m / 2.0;
  footprint.wheels_m = params.wheelbase_m / 2.0;
  return footprint;
}

}  // namespace

SimVehicle::SimVehicle(const VehicleSettings& settings, uint64_t start_ns)
    : ground_(settings.ground),
      left_(settings.left, start_ns),
      right_(settings.right, start_ns),
      now_ns_(start_ns),
      pose_(settings.start) {
  if (settings.controller) controller_.emplace(*settings.controller, start_ns);
  if (settings.steered) {
    steered_.emplace(*settings.steered, settings.start, VehicleModel::kStep_s);
    footprint_ = FootprintOf(*settings.steered);
    return;
  }
  if (!settings.model && !settings.controller) return;
  body_ = settings.model.value_or(VehicleModelParams());
  model_.emplace(*body_, settings.start);
  left_.LeaveMotor();
  right_.LeaveMotor();
}

GroundUnder GroundOf(const world::World& world, const Pose& pose,
                     const world::Footprint& footprint) {
  if (!world.has_friction()) return {};
  const world::BodyPose stands =
      world::StandingPose(world, pose.x_m, pose.y_m, pose.theta_rad, footprint);
  const world::Turn pitch = world::TurnOf(stands.pitch_rad);
  const world::Turn roll = world::TurnOf(stands.roll_rad);
  return {.friction = world::FrictionUnder(world, pose.x_m, pose.y_m, pose.theta_rad, footprint),
          .up_forward = -pitch.sin,
          .up_left = roll.sin * pitch.cos,
          .press = roll.cos * pitch.cos};
}

void SimVehicle::SetGround(const GroundUnder& ground) {
  if (steered_) steered_->SetGround(ground);
  if (model_) model_->SetGround(ground);
}

const BodyOnGround* SimVehicle::body() const {
  if (steered_) return &steered_->body();
  return model_ ? &model_->body() : nullptr;
}

void SimVehicle::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  StepTo(now_ns);
  if (controller_) return controller_->TakeFrame(frame, now_ns);
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
    if (steered_) {
      MoveSteered();
    } else if (model_) {
      MoveModel();
    } else {
      Move(kStep_s);
    }
  }
}

void SimVehicle::CollectSent(uint64_t now_ns) {
  if (controller_) return controller_->Advance(now_ns, outbox_);
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
  model_->Step(Setpoints());
  const WheelSpeeds& wheels = model_->wheels();
  if (controller_) {
    controller_->SetMeasured(
        body_->ground_per_wheel * body_->wheel_radius_m * wheels.common_radps(),
        2.0 * body_->wheel_radius_m * wheels.differential_radps() / body_->skid_baseline_m);
  } else {
    left_.TurnWheels(wheels.left_radps);
    right_.TurnWheels(wheels.right_radps);
  }
  TakeMotion(model_->speed_mps(), model_->yaw_rate_radps(), model_->pose(), model_->driven_m());
}

// The wheel speeds commanded to the drives, or computed by a controller from a speed and a yaw
// rate.
WheelSetpoints SimVehicle::Setpoints() const {
  if (!controller_) {
    return {.speeds = {left_.setpoint_radps(), right_.setpoint_radps()},
            .left_driven = left_.turns(),
            .right_driven = right_.turns()};
  }
  const TwistController::Motion motion = controller_->motion();
  const double common_radps = motion.speed_mps / (body_->ground_per_wheel * body_->wheel_radius_m);
  const double differential_radps =
      motion.turn * body_->skid_baseline_m / (2.0 * body_->wheel_radius_m);
  return {.speeds = {common_radps - differential_radps, common_radps + differential_radps},
          .left_driven = motion.driven,
          .right_driven = motion.driven};
}

// Without a controller nobody drives it.
void SimVehicle::MoveSteered() {
  const TwistController::Motion motion =
      controller_ ? controller_->motion() : TwistController::Motion();
  steered_->Step({motion.driven, motion.speed_mps, motion.turn});
  if (controller_) {
    controller_->SetMeasured(steered_->measured_speed_mps(), steered_->steering_rad());
  }
  TakeMotion(steered_->speed_mps(), steered_->yaw_rate_radps(), steered_->pose(),
             steered_->driven_m());
}

void SimVehicle::TakeMotion(double speed_mps, double yaw_rate_radps, const Pose& pose,
                            double driven_m) {
  has_slipped_ = has_slipped_ || traction_ != 1.0;
  speed_mps_ = traction_ * speed_mps;
  yaw_rate_radps_ = traction_ * yaw_rate_radps;
  if (has_slipped_) return Integrate(VehicleModel::kStep_s);
  pose_ = pose;
  driven_m_ = driven_m;
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
