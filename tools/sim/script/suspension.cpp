// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/suspension.h"

#include <algorithm>

namespace hardpack::sim {

// Returns the rate at which the nose goes down [rad/s].
double Suspension::Dip(double speed_mps) {
  constexpr double kBraking_mps2 = 2.0;
  const double braking_mps2 = (speed_before_mps_ - speed_mps) / step_s_;
  speed_before_mps_ = speed_mps;
  const double asked_rad = most_dip_rad_ * std::clamp(braking_mps2 / kBraking_mps2, -1.5, 1.5);
  const double rate_radps = (asked_rad - dip_rad_) / kDipLag_s;
  dip_rad_ += step_s_ * rate_radps;
  return rate_radps;
}

// The rates about the body's axes, from those of Rz(yaw) Ry(pitch) Rx(roll); the yaw's part is in
// the motion already.
BodyMotion Suspension::Follow(const SimVehicle& vehicle, const world::World& world) {
  const Pose& at = vehicle.pose();
  const world::BodyPose plane =
      world::StandingPose(world, at.x_m, at.y_m, at.theta_rad, vehicle.footprint());
  if (!stands_) pose_ = plane;
  stands_ = true;
  const double share = step_s_ / kLag_s;
  const double roll_rad = share * (plane.roll_rad - pose_.roll_rad);
  const double pitch_rad = share * (plane.pitch_rad - pose_.pitch_rad);
  pose_.roll_rad += roll_rad;
  pose_.pitch_rad += pitch_rad;
  const double rise_m = share * (plane.position.z_m - pose_.position.z_m);
  rise_mps_ = rise_m / step_s_;
  pose_.position = {plane.position.x_m, plane.position.y_m, pose_.position.z_m + rise_m};
  pose_.yaw_rad = plane.yaw_rad;
  BodyMotion motion = MotionAt(vehicle, pose_);
  const world::Turn roll = world::TurnOf(pose_.roll_rad);
  motion.rate_radps.x_m += roll_rad / step_s_;
  motion.rate_radps.y_m += roll.cos * pitch_rad / step_s_;
  motion.rate_radps.z_m -= roll.sin * pitch_rad / step_s_;
  return motion;
}

BodyMotion Suspension::Step(const SimVehicle& vehicle, const world::World& world) {
  BodyMotion motion = world.has_friction() ? Follow(vehicle, world) : MotionOf(vehicle, world);
  if (most_dip_rad_ == 0.0) return motion;
  const double rate_radps = Dip(vehicle.speed_mps());
  motion.pose.pitch_rad += dip_rad_;
  motion.rate_radps.y_m += rate_radps;
  return motion;
}

}  // namespace hardpack::sim
