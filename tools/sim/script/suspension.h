// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/sensors/sim_ins.h"
#include "tools/sim/vehicle/sim_vehicle.h"
#include "tools/sim/world/contact.h"

// A body on its suspension. Its nose dips when it brakes, after a first-order lag. In a world with
// friction its roll, its pitch and its height also follow the plane through the ground under its
// wheels (world::StandingPose) with one such lag each, and its gyro and its accelerometer feel that
// and what the tyres push with; in others it is fixed to that plane, as before there was friction.

namespace hardpack::sim {

class Suspension {
 public:
  // Of a Warthog on its four swinging wheels: an assumption; nobody has measured it.
  static constexpr double kLag_s = 0.12;
  static constexpr double kDipLag_s = 0.15;

  // dip_rad: how far its nose dips when it brakes at 2 m/s2. step_s > 0.
  Suspension(double dip_rad, double step_s) : most_dip_rad_(dip_rad), step_s_(step_s) {}

  // The body's motion one step later.
  BodyMotion Step(const SimVehicle& vehicle, const world::World& world);

  // How fast the body rises; 0 in a world without friction.
  double rise_mps() const { return rise_mps_; }

 private:
  double Dip(double speed_mps);
  BodyMotion Follow(const SimVehicle& vehicle, const world::World& world);

  double most_dip_rad_;
  double step_s_;
  double dip_rad_ = 0.0;
  double speed_before_mps_ = 0.0;
  double rise_mps_ = 0.0;
  bool stands_ = false;  // pose_ is known
  world::BodyPose pose_;
};

}  // namespace hardpack::sim
