// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/picture/canvas.h"
#include "tools/sim/world/contact.h"
#include "tools/sim/world/named_worlds.h"

// A world from above: heights, what stands on it and who walks there, start and goal, and what one
// revolution of a simulated lidar at the start returns.

namespace hardpack::command {

struct WorldReturn {
  double x_m = 0.0;
  double y_m = 0.0;
  world::Label label = world::Label::kVoid;
};

struct WorldScan {
  std::vector<WorldReturn> returns;
  double cast_ms = 0.0;  // of the processor, to cast the rays and write the packets
};

// The returns of one revolution of an OS1-64 (sim::NoisyLidar) on the vehicle that stands at the
// start: cast, sent as packets, and read again with the library's own codec.
WorldScan ScanFromStart(const world::Scenario& scenario, uint32_t seed);

// What was driven there; nothing where it is empty.
struct DrivenWay {
  world::Footprint footprint;  // of who has driven, or will
  std::vector<world::Point2> way;
  std::vector<std::vector<world::Point2>> plans;  // each that was committed
  double end_s = 0.0;                             // people are drawn as of then
};

picture::Canvas DrawWorld(const world::Scenario& scenario, uint64_t seed,
                          const std::vector<WorldReturn>& returns, const DrivenWay& driven = {});

}  // namespace hardpack::command
