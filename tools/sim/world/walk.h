// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/world/contact.h"
#include "tools/sim/world/world.h"

// How people walk beside a vehicle. They keep to their way and pay no heed to where the vehicle
// will be, but they do not walk into its side: they wait while it drives past, and go round it,
// behind its rear as a rule, while it stands. Behind it they hurry back to where they would be.

namespace hardpack::world {

struct Bystander {  // the vehicle, as people see it
  Point2 place;     // of its body frame
  double yaw_rad = 0.0;
  bool stands = true;
  Footprint footprint;
};

// One step of every person, to time_s, which is step_s after the last one: World::PersonAt of that
// time and later says where they are. A vehicle that drives up to somebody who stands or walks
// finds them there: nobody jumps out of its way.
inline constexpr double kKeptFromVehicle_m = 0.4;  // between a person's surface and its outline
inline constexpr double kHurry_mps = 2.5;
void LetPeopleWalk(World& world, double time_s, double step_s, const Bystander& vehicle);

}  // namespace hardpack::world
