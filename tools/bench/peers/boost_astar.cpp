// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/boost_astar.h"

#include <algorithm>
#include <boost/graph/astar_search.hpp>
#include <boost/property_map/property_map.hpp>
#include <cstdlib>
#include <functional>
#include <limits>

#include "core/astar/astar.h"
#include "tools/bench/peers/grid_graph.h"

namespace hardpack::peers {
namespace {

constexpr int32_t kUnreached = std::numeric_limits<int32_t>::max();

class Octile : public boost::astar_heuristic<GridGraph, int32_t> {
 public:
  explicit Octile(uint32_t goal) : x_(ColumnOf(goal)), y_(RowOf(goal)) {}

  int32_t operator()(uint32_t cell) const {
    const int32_t dx = std::abs(ColumnOf(cell) - x_);
    const int32_t dy = std::abs(RowOf(cell) - y_);
    const int32_t diagonal = std::min(dx, dy);
    return kStraightLength * (std::max(dx, dy) - diagonal) + kDiagonalLength * diagonal;
  }

 private:
  static int32_t ColumnOf(uint32_t cell) { return static_cast<int32_t>(cell % kMapSize_cells); }
  static int32_t RowOf(uint32_t cell) { return static_cast<int32_t>(cell / kMapSize_cells); }

  int32_t x_;
  int32_t y_;
};

struct GoalReached {};

class StopsAtGoal : public boost::default_astar_visitor {
 public:
  StopsAtGoal(uint32_t goal, int32_t& expansions) : goal_(goal), expansions_(&expansions) {}

  void examine_vertex(uint32_t cell, const GridGraph&) const {
    ++*expansions_;
    if (cell == goal_) throw GoalReached{};
  }

 private:
  uint32_t goal_;
  int32_t* expansions_;
};

// Property maps, under the names that Boost finds them by.
// NOLINTBEGIN(readability-identifier-naming)

struct EdgeCosts {
  using key_type = GridEdge;
  using value_type = int32_t;
  using reference = int32_t;
  using category = boost::readable_property_map_tag;
  const Costmap* map;
};

int32_t get(const EdgeCosts& costs, GridEdge edge) {
  const uint32_t to = GridGraph::Neighbour(edge.from, edge.direction);
  const int length = edge.direction % 2 != 0 ? kDiagonalLength : kStraightLength;
  return EdgeCost(length, costs.map->cost_q8[to]);
}

// Boost's colours in a byte each instead of four.
struct Colors {
  using key_type = uint32_t;
  using value_type = boost::default_color_type;
  using reference = boost::default_color_type;
  using category = boost::read_write_property_map_tag;
  uint8_t* of_cells;
};

boost::default_color_type get(const Colors& colors, uint32_t cell) {
  return static_cast<boost::default_color_type>(colors.of_cells[cell]);
}

void put(const Colors& colors, uint32_t cell, boost::default_color_type color) {
  colors.of_cells[cell] = static_cast<uint8_t>(color);
}

// NOLINTEND(readability-identifier-naming)

}  // namespace

// [kMapCells] each, by cell.
struct BoostAstar::Maps {
  std::vector<int32_t> cost = std::vector<int32_t>(kMapCells);  // so far
  std::vector<int32_t> rank = std::vector<int32_t>(kMapCells);  // with the heuristic
  std::vector<uint32_t> before = std::vector<uint32_t>(kMapCells);
  std::vector<uint8_t> color = std::vector<uint8_t>(kMapCells);
};

BoostAstar::BoostAstar() : maps_(std::make_unique<Maps>()) {}

BoostAstar::~BoostAstar() = default;

BoostAstarResult BoostAstar::Search(const Costmap& map, Cell start, Cell goal) {
  BoostAstarResult result;
  if (!map.window.Contains(start) || !map.window.Contains(goal)) return result;
  const int start_index = map.window.Index(start);
  const int goal_index = map.window.Index(goal);
  if (map.Lethal(start_index) || map.Lethal(goal_index)) return result;
  const auto from = static_cast<uint32_t>(start_index);
  const auto to = static_cast<uint32_t>(goal_index);

  const Octile heuristic(to);
  std::fill(maps_->cost.begin(), maps_->cost.end(), kUnreached);
  std::fill(maps_->color.begin(), maps_->color.end(), uint8_t{boost::white_color});
  maps_->cost[from] = 0;
  maps_->rank[from] = heuristic(from);
  const boost::typed_identity_property_map<uint32_t> index;
  try {
    boost::astar_search_no_init(GridGraph(map), from, heuristic, StopsAtGoal(to, result.expansions),
                                boost::make_iterator_property_map(maps_->before.data(), index),
                                boost::make_iterator_property_map(maps_->rank.data(), index),
                                boost::make_iterator_property_map(maps_->cost.data(), index),
                                EdgeCosts{&map}, Colors{maps_->color.data()}, index, std::less<>(),
                                std::plus<>(), kUnreached, 0);
    return result;
  } catch (GoalReached) {
    result.reached = true;
  }
  result.cost = maps_->cost[to];
  for (uint32_t cell = to; cell != from; cell = maps_->before[cell]) {
    result.cells.push_back(map.window.FromIndex(static_cast<int>(cell)));
  }
  result.cells.push_back(start);
  std::reverse(result.cells.begin(), result.cells.end());
  return result;
}

}  // namespace hardpack::peers
