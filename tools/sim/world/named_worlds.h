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
// few more. A seed gives small variations, never a different kind of world.

namespace hardpack::world {

// An obstacle that the path passes on one side or the other.
struct Landmark {
  Point2 middle;
  double radius_m = 0.0;
  // At this lateral distance from its middle the view past its flank is free; by default it hides
  // the area behind it until the vehicle is beside it.
  double seen_past_m = 1.0e9;
};

struct Scenario {
  std::string name;
  std::string description;
  World world;
  BodyPose start;  // in named worlds: at the origin, facing +x
  Point2 goal;
  std::optional<Landmark> around;      // rock_pile, hill, corridor: pile, hill and pillar
  double corridor_half_width_m = 0.0;  // corridor: between walls along +x, y = 0 in the middle
  // For the vehicle in it: the rotation of its lidar from its description, about x and y, and how
  // far its nose dips when it brakes at 2 m/s2.
  double mount_roll_rad = 0.0;
  double mount_pitch_rad = 0.0;
  double brake_pitch_rad = 0.0;
  std::string
      script;  // what happens (tools/sim/script/script.h), at times from the goal's acceptance
};

// gap, rock_pile, hill, forest, corridor, crossing, dead_end, ditch, open, thicket, tight_start,
// back_out, low, low_bare, corner, corner_ditch. Others: BlindNames (blind.h), SlopeNames
// (slopes.h).
const std::vector<std::string>& WorldNames();

// A world's name without what follows a colon in it.
std::string_view BaseName(std::string_view name);

// After a colon the name may have an angle in degrees, `gap:10`: the steepness of a world of
// slopes.h, up to kMaxSteepness_deg; any other stands on a plane that is tilted by it, up to
// kMaxTilt_deg, in a direction drawn by the seed, and has friction. kInvalidArgument: no such world
// or angle; the message says which there are.
inline constexpr double kMaxTilt_deg = 20.0;
ReadOutcome MakeScenario(std::string_view name, uint64_t seed, Scenario& scenario);

// The passage of the world `gap`: between these two points, the fence's and the boat's.
inline constexpr double kGapWidth_m = 2.2;
struct Passage {
  Point2 fence;
  Point2 boat;
};
Passage GapOf(uint64_t seed);

}  // namespace hardpack::world
