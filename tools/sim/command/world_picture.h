// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/areas/area.h"
#include "tools/picture/canvas.h"
#include "tools/sim/world/contact.h"
#include "tools/sim/world/named_worlds.h"

// A world from above: heights, bodies and people, start and goal, and the returns of one revolution
// of a simulated lidar at the start.

namespace hardpack::command {

struct WorldReturn {
  double x_m = 0.0;
  double y_m = 0.0;
  world::Label label = world::Label::kVoid;
};

struct WorldScan {
  std::vector<WorldReturn> returns;
  double cast_ms = 0.0;  // processor time to cast the rays and write the packets
};

// The returns of one revolution of an OS1-64 (sim::NoisyLidar) on a vehicle standing at the start:
// cast, sent as packets, and read back with the library's own codec.
WorldScan ScanFromStart(const world::Scenario& scenario, uint32_t seed);

// The path driven there; not drawn if empty.
struct DrivenWay {
  world::Footprint footprint;  // of the vehicle that has driven, or will
  std::vector<world::Point2> way;
  std::vector<std::vector<world::Point2>> plans;  // all committed plans
  AreaList areas;                                 // those in odom, in the world's frame
  std::vector<world::Point2> waypoints;           // before the goal
  double end_s = 0.0;                             // people are drawn at this time
};

picture::Canvas DrawWorld(const world::Scenario& scenario, uint64_t seed,
                          const std::vector<WorldReturn>& returns, const DrivenWay& driven = {});

}  // namespace hardpack::command
