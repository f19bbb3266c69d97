// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "core/astar/astar.h"

// The search written again from its definition, slowly: Dijkstra with a binary heap over (x, y),
// and a walk along a result's path that judges every step. It shares no code with core/astar.

namespace hardpack {

// Where a search may go and what it costs.
class MapRules {
 public:
  static constexpr int kSize = 512;

  explicit MapRules(const Costmap& map) : map_(map) {}

  static bool OnMap(int x, int y) { return x >= 0 && x < kSize && y >= 0 && y < kSize; }
  bool Lethal(int x, int y) const { return (map_.flags[y * kSize + x] & Costmap::kLethal) != 0; }

  // Whether a vehicle in (x, y) may be in (to_x, to_y) next, corners aside.
  bool MayEnter(int x, int y, int to_x, int to_y) const {
    if (!OnMap(to_x, to_y)) return false;
    if (!Lethal(to_x, to_y)) return true;
    return Lethal(x, y) && map_.hard_depth2[to_y * kSize + to_x] < map_.hard_depth2[y * kSize + x];
  }

  bool MayStep(int x, int y, int dx, int dy) const {
    if (!MayEnter(x, y, x + dx, y + dy)) return false;
    return dx == 0 || dy == 0 || (MayEnter(x, y, x + dx, y) && MayEnter(x, y, x, y + dy));
  }

  // floor(length * (1 + cost)) in exact arithmetic.
  int64_t StepCost(int to_x, int to_y, bool diagonal) const {
    const int64_t scaled = int64_t{diagonal ? 99 : 70} * (256 + map_.cost_q8[to_y * kSize + to_x]);
    return (scaled - scaled % 256) / 256;
  }

 private:
  const Costmap& map_;
};

class ReferenceSearch {
 public:
  static constexpr int64_t kUnreached = std::numeric_limits<int64_t>::max();

  explicit ReferenceSearch(const Costmap& map) : rules_(map), cost_(kMapCells, kUnreached) {}

  // Least costs from a start to every cell.
  void Solve(int start_x, int start_y) {
    for (const int cell : reached_) cost_[static_cast<size_t>(cell)] = kUnreached;
    reached_.clear();
    left_obstacle_ = !rules_.Lethal(start_x, start_y);
    Lower(start_y * kSize + start_x, 0);
    while (!open_.empty()) {
      const auto [cost, cell] = open_.top();
      open_.pop();
      if (cost == cost_[static_cast<size_t>(cell)]) SolveFrom(cell, cost);
    }
  }

  int64_t CostTo(int x, int y) const { return cost_[static_cast<size_t>(y * kSize + x)]; }
  // After Solve: whether any cell that is not lethal was reached.
  bool left_obstacle() const { return left_obstacle_; }

 private:
  using Entry = std::pair<int64_t, int>;  // cost, cell

  void SolveFrom(int cell, int64_t cost) {
    const int x = cell % kSize;
    const int y = cell / kSize;
    left_obstacle_ = left_obstacle_ || !rules_.Lethal(x, y);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !rules_.MayStep(x, y, dx, dy)) continue;
        Lower((y + dy) * kSize + x + dx,
              cost + rules_.StepCost(x + dx, y + dy, dx != 0 && dy != 0));
      }
    }
  }

  void Lower(int cell, int64_t cost) {
    int64_t& known = cost_[static_cast<size_t>(cell)];
    if (cost >= known) return;
    if (known == kUnreached) reached_.push_back(cell);
    known = cost;
    open_.emplace(cost, cell);
  }

  static constexpr int kSize = MapRules::kSize;
  MapRules rules_;
  std::vector<int64_t> cost_;
  std::vector<int> reached_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_;
  bool left_obstacle_ = false;
};

// Walks the path of a usable result; what is wrong with it, or empty.
inline std::string FaultOfPath(const Costmap& map, const AstarSearch& search) {
  const AstarResult& result = search.result();
  const MapRules rules(map);
  Cell cell = result.start;
  int64_t cost = 0;
  int cells = 1;
  while (cell != result.end) {
    const Cell next = search.Next(cell);
    const int x = cell.x - map.window.origin.x;
    const int y = cell.y - map.window.origin.y;
    const int dx = next.x - cell.x;
    const int dy = next.y - cell.y;
    const std::string where = " at (" + std::to_string(x) + ", " + std::to_string(y) + ")";
    if (dx < -1 || dx > 1 || dy < -1 || dy > 1 || (dx == 0 && dy == 0)) return "a jump" + where;
    if (!rules.MayStep(x, y, dx, dy)) return "a forbidden step" + where;
    cost += rules.StepCost(x + dx, y + dy, dx != 0 && dy != 0);
    cell = next;
    if (++cells > kMapCells) return "a loop";
  }
  if (cells != result.path_cells) return "path_cells is not the number of cells";
  if (cost != result.cost) return "cost is not the sum of the steps";
  return {};
}

}  // namespace hardpack
