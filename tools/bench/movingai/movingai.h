// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "core/costmap/costmap.h"

// The grid benchmark of movingai.com (N. Sturtevant, "Benchmarks for Grid-Based Pathfinding", 2012)
// as a test of core/astar: maps of 0 / 1 cells, and scenarios that list the length of a shortest
// path (1 a straight step, sqrt(2) a diagonal one, no corner cutting).

namespace hardpack {

// One map; cells beyond its size are blocked.
struct MovingaiMap {
  int width_cells = 0;     // 1 to kMapSize_cells
  int height_cells = 0;    // 1 to kMapSize_cells
  std::vector<bool> free;  // [height x width], row-major, in the order of the file
};

struct MovingaiProblem {
  int line = 0;  // in the scenario file, from 1
  int map_width_cells = 0;
  int map_height_cells = 0;
  Cell start;  // on that map
  Cell goal;
  double optimum_cells = 0.0;   // the listed length
  double rounding_cells = 0.0;  // of the listed length, from its number of decimals
};

// Either the data read, or one line that names the file, the line and the error.
template <typename T>
using MovingaiOr = std::variant<T, std::string>;

// The .map format: "type octile", "height H", "width W", "map", then H rows of W characters;
// '.', 'G' and 'S' are free, '@', 'O', 'T' and 'W' blocked, others an error. LF or CRLF.
MovingaiOr<MovingaiMap> ReadMovingaiMap(const std::string& path);

// The .scen format: "version 1" or "version 1.0", then nine columns a line, separated by tabs or
// spaces: bucket, map, width, height, start x and y, goal x and y, length. Positions outside the
// listed width and height are an error.
MovingaiOr<std::vector<MovingaiProblem>> ReadMovingaiScenarios(const std::string& path);

// The map in the lower left corner of a window at (0, 0): free cells cost nothing, all others are
// hard and lethal; nothing is dilated and there is no halo.
void FillMovingaiCostmap(const MovingaiMap& map, Costmap& costmap);

struct MovingaiReport {
  int problems = 0;    // that were tried
  int solved = 0;      // for which a complete, valid path was found
  int mismatches = 0;  // unsolved, or longer or shorter than listed by more than 0.1 % + rounding
  double largest_relative_error = 0.0;  // |length - listed| / listed, over the solved
  std::string first_mismatch;           // one line; empty without one
  int64_t expansions = 0;               // over all problems
  int64_t total_ns = 0;                 // of the searches alone
  int64_t median_ns = 0;                // a problem
  int64_t worst_ns = 0;                 // a problem
};

// Solves problems 0, stride, 2 stride, ... of the file with core/astar. Each path is walked and
// checked cell by cell; its length is summed in double precision from its steps. Precondition:
// stride >= 1.
MovingaiOr<MovingaiReport> RunMovingai(const std::string& map_path, const std::string& scen_path,
                                       int stride = 1);

}  // namespace hardpack
