// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/world/contact.h"
#include "tools/sim/world/world.h"

// Worlds to drive in, by name: those of the paper's experiments ([OS] Experimental Results) and a
// few more. A seed gives small variations: never another kind of world.

namespace hardpack::world {

// One thing that the way leads around, on the one side or on the other.
struct Landmark {
  Point2 middle;
  double radius_m = 0.0;
  // From so far aside of its middle one looks past it along its flank; by default it hides what is
  // behind it until one is beside it.
  double seen_past_m = 1.0e9;
};

struct Scenario {
  std::string name;
  std::string description;
  World world;
  BodyPose start;  // of named worlds: at the origin, looking along +x
  Point2 goal;
  std::optional<Landmark> around;      // rock_pile, hill, corridor: pile, hill and pillar
  double corridor_half_width_m = 0.0;  // corridor: between walls along +x, y = 0 in the middle
  // Of the vehicle that is put into it: how its lidar is turned against its description, about x
  // and y, and how far its nose goes down when it brakes at 2 m/s2.
  double mount_roll_rad = 0.0;
  double mount_pitch_rad = 0.0;
  double brake_pitch_rad = 0.0;
  std::string
      script;  // what happens (tools/sim/script/script.h), at times from the goal's acceptance
};

// gap, rock_pile, hill, forest, corridor, crossing, dead_end, ditch, open, thicket, tight_start,
// low, low_bare.
const std::vector<std::string>& WorldNames();

// kInvalidArgument: no such world; the message lists them.
ReadOutcome MakeScenario(std::string_view name, uint64_t seed, Scenario& scenario);

// The passage of the world `gap`: between these two points, the fence's and the boat's.
inline constexpr double kGapWidth_m = 2.2;
struct Passage {
  Point2 fence;
  Point2 boat;
};
Passage GapOf(uint64_t seed);

}  // namespace hardpack::world
