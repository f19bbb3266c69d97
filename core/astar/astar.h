// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"

// A* over the costmap, 8-connected ([OS] Base Path Generation; docs/algorithm.md section 2):
// integer costs, octile heuristic, a preallocated open set with one entry a cell (so it cannot
// overflow), resumable. Edge cost: length x (1 + cost of the cell entered). No diagonal past a
// lethal neighbour; lethal cells are never entered, except along strictly falling hard depth from a
// start inside one. Ties are broken by a fixed rule, so equal inputs give equal paths.

namespace hardpack {

// Integer length of a step: 99 / 70 is the square root of two to 0.005 %.
inline constexpr int kStraightLength = 70;
inline constexpr int kDiagonalLength = 99;

// The largest cost of one edge: a diagonal into a cell of the largest cost.
inline constexpr int kMaxEdgeCost = kDiagonalLength * (kMaxCost_q8 + kCostOne_q8) / kCostOne_q8;

// Integer cost of a step of `length` (one of the two above) into a cell.
constexpr int EdgeCost(int length, int cost_q8) {
  return length * (kCostOne_q8 + cost_q8) / kCostOne_q8;
}

struct AstarResult {
  Status status = Status::kNotStarted;  // one of the outcomes listed at AstarSearch::result()
  bool goal_outside_map = false;
  bool goal_moved = false;
  bool start_in_obstacle = false;
  bool partial = false;
  Cell start;
  Cell goal;               // the cell searched for
  Cell end;                // the last cell of the path: goal, or the best cell seen when partial
  int32_t path_cells = 0;  // cells of the path, start and end included; 0 without a path
  int64_t cost = 0;        // sum of EdgeCost along the path
  int32_t expansions = 0;
};

class AstarSearch {
 public:
  // Positions in the odom frame. kNotFinite, kStartOutsideMap, kParameterOutOfRange,
  // kGoalInObstacle end the search at once (result().status says the same); otherwise kOk. Cost:
  // constant.
  Status Begin(const Costmap& map, const AstarParams& params, Vec2 start_odom, Vec2 goal_odom);

  // A unit is one row scanned for a free goal cell, one expansion, one row of the node array
  // cleared (once in many queries), or one cell of the path traced back.
  Progress Step(const Costmap& map, int units);

  // Outcomes: kOk; kGoalOutsideMap; kGoalMoved; kStartInObstacle (a path, left along falling
  // depth); kPartialPath (expansion limit; the cell with the least heuristic is the end);
  // kNoPath; kStartEnclosed; kGoalInObstacle. When several of the usable ones hold, status is the
  // gravest (partial > start in obstacle > goal moved > goal outside) and the flags say all.
  const AstarResult& result() const { return result_; }

  // The path, forward: the cell after `cell`. Precondition: result().status is usable and `cell` is
  // a cell of the path other than its end.
  Cell Next(Cell cell) const;

 private:
  static constexpr int kBuckets = 4096;
  static_assert(kBuckets > kMaxEdgeCost + kDiagonalLength);

  // One cell's whole search state in 64 bits: links of its bucket's list, cost so far modulo 2^16,
  // direction to its parent, open / closed, and the query that wrote it.
  uint64_t nodes_[kMapCells];
  int32_t bucket_head_[kBuckets];
  uint64_t bucket_used_[kBuckets / 64];
  AstarResult result_;
};

}  // namespace hardpack
