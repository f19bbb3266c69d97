// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/pose.h"

// Maps to measure on: built in, the same on every machine. 512 x 512 cells around the origin.

namespace hardpack::command {

struct BenchScene {
  std::string name;
  std::vector<uint8_t> flags;  // [kMapCells] of Costmap::Flag
  Vec2 start_m;
  Vec2 goal_m;
};

// random_10, random_25, random_40: that share of the 4.8 m squares is a hard box; forest: a trunk
// every 40 m^2 and a bush every 80; maze: walls between squares of 4.8 m, one way between any two;
// open: nothing.
std::vector<BenchScene> MakeBenchScenes();

}  // namespace hardpack::command
