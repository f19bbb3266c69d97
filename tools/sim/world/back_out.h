// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/sim/world/named_worlds.h"

// The world `back_out`: the vehicle starts with its nose towards the closed end of an alley that
// is too narrow to turn in, and the way out is behind it.

namespace hardpack::world {

// Between the alley's walls, and from the nose to its end.
inline constexpr double kAlleyLeast_m = 1.9;
inline constexpr double kAlleyMost_m = 2.5;
inline constexpr double kAlleyEndLeast_m = 0.15;
inline constexpr double kAlleyEndMost_m = 3.0;

void MakeBackOut(uint64_t seed, Scenario& scenario);

}  // namespace hardpack::world
