// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/sim/world/named_worlds.h"

// The worlds `corner` and `corner_ditch`: a lane of 2.8 to 3.4 m between walls turns by 90 degrees.
// The inner wall's shadow and the lidar's blind cone hide what is right behind the corner: nothing,
// or a ditch across the lane.

namespace hardpack::world {

void MakeCorner(uint64_t seed, Scenario& scenario);
void MakeCornerDitch(uint64_t seed, Scenario& scenario);

}  // namespace hardpack::world
