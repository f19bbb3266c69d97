// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/world/named_worlds.h"

namespace hardpack::world {

// The same world on a plane that rises by rise_x and rise_y per metre; the start stays at height 0.
// What stands upright stays upright. Long things become pieces of at most a metre along the slope,
// each as high over the ground as it was. Friction and patches stay as they are.
void Tilt(double rise_x, double rise_y, Scenario& scenario);

}  // namespace hardpack::world
