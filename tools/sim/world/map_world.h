// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/map_server/map_server.h"
#include "tools/sim/world/world.h"

// A map of ROS map_server (tools/map_server) as a world.

namespace hardpack::world {

// Level ground in the map's frame, 20 m wider than the map on every side. Hard pixels become walls
// of 2 m, soft ones bushes of 1 m, unknown and free ones nothing. Touching pixels become one box if
// they fill a rectangle.
World WorldOfMap(const map_server::OccupancyMap& map);

}  // namespace hardpack::world
