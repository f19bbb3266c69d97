// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/sim/world/named_worlds.h"

// The world `tight_start`: the vehicle starts with a wall, a box or posts close beside its flank,
// on one side or on both, so that it has no room to turn on the spot; the way ahead is free.

namespace hardpack::world {

// Distance between a flank and the obstacle beside it.
inline constexpr double kTightLeast_m = 0.05;
inline constexpr double kTightMost_m = 0.5;

void MakeTightStart(uint64_t seed, Scenario& scenario);

}  // namespace hardpack::world
