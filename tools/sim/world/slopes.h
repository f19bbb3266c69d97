// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sim/world/named_worlds.h"

// Worlds whose ground has slope, with gravity and a friction that no vehicle is told: the seed
// draws it from kLeastFriction to kMostFriction. Each has a steepness in degrees, drawn as well
// where none is given.
//
//   side_slope     a hillside across the way, with level ground along its foot
//   downhill_stop  down to a building that stands on the goal
//   crest          up, 3 m along the top, and down
//   ridge          a narrow ridge across the way, with a gap in it
//   washout        a slope, up or down, with a ditch across it that ends on one side
//   ruts           two ruts, a vehicle's track apart, at a small angle to the way
//   rough          waves of random heights; the steepness is that of the steepest of them
//   mud            a slope with a slippery patch on it
//   rolling        smooth hills, a long way

namespace hardpack::world {

inline constexpr double kLeastFriction = 0.4;
inline constexpr double kMostFriction = 0.8;
inline constexpr double kMaxSteepness_deg = 40.0;

const std::vector<std::string>& SlopeNames();

// False: there is no such world. steepness_deg: 0 to kMaxSteepness_deg.
bool MakeSlope(std::string_view name, uint64_t seed, std::optional<double> steepness_deg,
               Scenario& scenario);

// What every world on a slope is given: a friction drawn by the seed.
void GiveFriction(uint64_t seed, World& world);

}  // namespace hardpack::world
