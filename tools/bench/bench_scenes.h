// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/autonomy/mapper.h"
#include "core/base/pose.h"

// Maps to measure on. The synthetic ones are the same on every machine: 512 x 512 cells around the
// origin. Those from recordings are in bench_recordings.h.

namespace hardpack::command {

struct BenchQuery {
  Vec2 start_m;  // odom
  Vec2 goal_m;
  float heading_rad = 0.0f;  // at the start; StageChain turns it along the base path
};

struct BenchScene {
  std::string name;
  std::vector<uint8_t> flags = {};  // [kMapCells] of Costmap::Flag; empty: the mapper's map
  std::shared_ptr<const Mapper> mapper = {};  // of a recorded revolution, or none
  std::vector<BenchQuery> queries = {};  // candidates, the best ones first: some lie in an obstacle
                                         // or have no path
};

// A scene is made when it is measured.
struct SceneMaker {
  std::string name;
  std::function<BenchScene()> make;
};

// random_10, random_25, random_40: that share of the 4.8 m squares is a hard box; cells_10,
// cells_40: that share of the cells is hard, each by itself; forest: a trunk every 40 m^2 and a
// bush every 80; maze: walls between squares of 4.8 m, one way between any two; comb: one way 7
// cells wide, back and forth over the whole map; spiral: one way of 6 m into the middle; cup: the
// start lies inside it, the goal behind its bottom; corner: one hard cell in the map's corner;
// open: nothing; full: only obstacles.
std::vector<SceneMaker> BuiltInScenes();

}  // namespace hardpack::command
