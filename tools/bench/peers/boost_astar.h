// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"

// Boost.Graph's A*, for comparison with core/astar: the same cells, steps, integer costs and octile
// heuristic. Its best fair use: the grid is an implicit graph (its edges are derived from the map
// when the search requests them), the property maps are arrays kept from query to query, and a
// visitor leaves the search at the goal by an exception, as in Boost's documentation.
// astar_search_no_init is called with costs and colours filled beforehand: astar_search would write
// two more maps, cell by cell, which is slower; resetting the maps as cells are met was tried, and
// is faster only for short searches. Boost allocates its heap in each query. The start lies outside
// lethal cells: the way out of an obstacle is not searched here.

namespace hardpack::peers {

struct BoostAstarResult {
  bool reached = false;
  int64_t cost = 0;         // sum of EdgeCost along the path
  int32_t expansions = 0;   // vertices examined, the goal included, as AstarResult counts them
  std::vector<Cell> cells;  // the path, from start to goal; empty unless reached
};

class BoostAstar {
 public:
  BoostAstar();
  ~BoostAstar();

  // A path of least cost. Not reached: there is no path, or start or goal lies off the map or is
  // lethal.
  BoostAstarResult Search(const Costmap& map, Cell start, Cell goal);

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;
};

}  // namespace hardpack::peers
