// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/world/world.h"

// How a vehicle stands in a world, and how close it is to anything it must not touch.

namespace hardpack::world {

// Pose of the body frame (docs/frames.md) in the world: Rz(yaw) Ry(pitch) Rx(roll).
struct BodyPose {
  Vector position;
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;
};

// An outline and the wheel contacts; by default a Warthog's. The middles of the outline and of the
// wheelbase are given ahead of the body frame's origin, which is the vehicle's position in the
// following.
struct Footprint {
  double length_m = 1.52;
  double width_m = 1.38;
  double middle_m = 0.0;  // of the outline
  double half_wheelbase_m = 0.46;
  double half_track_m = 0.56;
  double wheels_m = 0.0;       // the middle of the wheelbase
  double clearance_m = 0.254;  // of the underside above the plane it stands on
};

// On the plane through the ground heights under the four wheels (the plane closest to all of them).
BodyPose StandingPose(const World& world, double x_m, double y_m, double yaw_rad,
                      const Footprint& footprint = {});
// What its four wheels stand on, on average.
double FrictionUnder(const World& world, double x_m, double y_m, double yaw_rad,
                     const Footprint& footprint = {});

struct Contact {
  // Distance between the outline and the nearest one, seen from above; negative: the overlap. At
  // most kFar_m. Bodies that end below 0.1 m or begin above 1.5 m over the plane it stands on, at
  // that place, are driven over and under.
  static constexpr double kFar_m = 50.0;
  double hard_m = kFar_m;    // solid bodies and fences
  double person_m = kFar_m;  // people
  double foliage_m = kFar_m;
  double slope = 0.0;        // rise over run of the plane it stands on
  double under_wheel = 0.0;  // the steepest ground under a wheel
  bool in_ditch = false;     // a wheel is halfway down, or deeper
  // Between the underside and the highest ground between the wheels; negative: it rests on it. At
  // most kFar_m. Only in worlds with friction.
  double belly_m = kFar_m;

  bool touches() const { return hard_m < 0.0 || person_m < 0.0; }
  // Beyond the vehicle's capability: 45 degrees.
  bool too_steep() const { return slope > 1.0; }
  bool grounds() const { return belly_m < 0.0; }
};

Contact ContactOf(const World& world, double x_m, double y_m, double yaw_rad, double time_s,
                  const Footprint& footprint = {});

}  // namespace hardpack::world
