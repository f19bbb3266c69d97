// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sim/world/named_worlds.h"

// Worlds in which the lidar goes blind at speed, each in a different way, and something then
// appears ahead: blind_lost, blind_invalid, blind_dark, blind_covered, blind_frozen, blind_turned;
// and blind itself, in which the same thing appears at the same time and the lidar works. Not
// included in `all`.

namespace hardpack::world {

std::vector<std::string> BlindNames();

// If the name is one of these, makes the scenario and returns true.
bool MakeBlind(std::string_view name, uint64_t seed, Scenario& scenario);

}  // namespace hardpack::world
