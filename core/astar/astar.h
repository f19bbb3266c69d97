// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"

// A* over the costmap, 8-connected ([OS] Base Path Generation; docs/algorithm.md section 2):
// integer costs, octile heuristic, a preallocated open set with one entry per cell (so it cannot
// overflow), resumable. It finds a least-cost path over cells. It ignores the vehicle's heading and
// turning limits; the optimizer handles those.
//
// Allowed steps. A step leads to one of the eight neighbours of a cell that is
//   - on the map, and
//   - not lethal, or lethal with strictly less hard_depth2 than the present cell, if that
//     one is lethal itself (so a start inside an obstacle is left along falling depth only, and
//     once left, never entered again).
// For a diagonal step the same must hold for the two adjacent cells: corners are not cut. Edge
// cost: length x (1 + cost of the cell entered).
//
// Tie-breaking, so that equal inputs give equal paths: among equal cost-so-far plus heuristic, the
// most recently reached cell goes first; neighbours are visited anticlockwise from +x; a cell keeps
// its parent unless another is strictly cheaper.

namespace hardpack {

// Integer length of a step: 99 / 70 is the square root of two to 0.005 %.
inline constexpr int kStraightLength = 70;
inline constexpr int kDiagonalLength = 99;

// Integer cost of a step of `length` (one of the two above) into a cell; at least `length`, since
// the dividend is length * 256 plus a non-negative number. Precondition: 0 <= cost_q8 <=
// kMaxCost_q8.
constexpr int EdgeCost(int length, int cost_q8) {
  return length * (kCostOne_q8 + cost_q8) / kCostOne_q8;
}

// The largest cost of one edge: a diagonal step into a cell of the largest cost.
inline constexpr int kMaxEdgeCost = EdgeCost(kDiagonalLength, kMaxCost_q8);

struct AstarResult {
  Status status = Status::kNotStarted;  // one of the outcomes listed at AstarSearch::result()
  bool goal_outside_map = false;
  bool goal_moved = false;
  bool start_in_obstacle = false;
  bool partial = false;
  Cell start;
  Cell goal;               // the cell searched for
  Cell end;                // the last cell of the path: goal, or the best cell seen when partial
  int32_t path_cells = 0;  // cells of the path, including start and end; 0 without a path
  int64_t cost = 0;        // sum of EdgeCost along the path
  int32_t expansions = 0;
};

class AstarSearch {
 public:
  // Most relabellings of the node array in one query: see Step.
  static constexpr int kMaxLabelMoves = 33;
  static constexpr float kGoalReach_cells = 5.0f;
  // No query takes more units than this.
  static constexpr int kMaxUnits = (3 + kMaxLabelMoves) * kMapSize_cells + 2 * kMapCells;

  // Positions in the odom frame. kNotFinite, kParameterOutOfRange (max_expansions outside 1 to
  // kMapCells, move_goal_out_of_obstacle neither 0 nor 1), kStartOutsideMap, kGoalInObstacle end
  // the search at once, tested in this order (result().status says the same); otherwise kOk. A goal
  // off the map becomes the nearest cell of the map, and is tested there. A lethal goal is replaced
  // by the free cell nearest to the start (ties: the lowest index) among those no more than
  // kGoalReach_cells farther from the goal than the nearest free one. This place stays the same
  // while the obstacle's edge is seen better, and it is not at that edge. Observed cells take
  // precedence over all others. Cost: constant.
  Status Begin(const Costmap& map, const AstarParams& params, Vec2 start_odom, Vec2 goal_odom);

  // A unit is one row of the node array cleared (512 of them in the first query and in every 127th
  // after it), one row scanned for a free cell to replace the goal (1024, only for a goal in an
  // obstacle), one expansion, one row of the node array relabelled (512 when cost so far plus
  // heuristic passes 2^18 - 2^13 and after each 3.3e7 more; the query after that clears), or one
  // cell of the path traced back. Costs above kMaxCost_q8 count as kMaxCost_q8.
  Progress Step(const Costmap& map, int units);

  // Outcomes: kOk; kGoalOutsideMap; kGoalMoved; kStartInObstacle (a path, left along falling
  // depth); kPartialPath (expansion limit; the end is the cell with the least heuristic among the
  // expanded cells that are not lethal, the first expanded among equals, or the start if all are
  // lethal); kNoPath; kStartEnclosed (the start is lethal, and no free cell can be reached from
  // it); kGoalInObstacle, and those of Begin. If several usable ones apply, status is the most
  // severe (partial > start in obstacle > goal moved > goal outside) and the flags show all of
  // them. The flags are set for failures too; end, path_cells and cost are for usable outcomes.
  // kNotStarted until Step has returned kDone.
  const AstarResult& result() const { return result_; }

  // The path, forward: the cell after `cell`. Precondition: result().status is usable and `cell` is
  // a cell of the path other than its end.
  Cell Next(Cell cell) const;

  // Whether the last query got to a cell; false off its map. Precondition: Step has returned kDone.
  bool HasReached(Cell cell) const;

 private:
  enum class Phase : uint8_t { kDone, kClear, kMoveGoal, kSearch, kMoveLabels, kTrace };

  static constexpr uint32_t kBuckets = 4096;
  static constexpr uint32_t kBucketWords = kBuckets / 64;
  static constexpr uint32_t kNone = kMapCells;  // no index

  int ClearNodes(int units);
  int MoveGoal(const Costmap& map, int units);
  void LimitGoal();
  void ScanForGoal(const Costmap& map, int32_t row, uint32_t from);
  int Search(const Costmap& map, int units);
  int MoveLabels(int units);
  int Trace(int units);

  void StartSearch();
  void Expand(const Costmap& map, uint32_t index);
  uint32_t CheaperAhead(const Costmap& map, uint32_t index, uint64_t node) const;
  uint32_t CheaperAround(const Costmap& map, uint32_t index, uint64_t node) const;
  uint32_t Cheaper(const Costmap& map, uint32_t neighbour, uint32_t length, uint32_t label) const;
  void Relax(uint32_t index, uint32_t direction, uint32_t label);
  uint32_t PopFirst();
  void Link(uint32_t index, uint32_t bucket, uint64_t fields);
  void Unlink(uint32_t index, uint32_t bucket);
  void SetNext(uint32_t index, uint32_t next);
  void SetPrev(uint32_t index, uint32_t prev);
  void MarkBucket(uint32_t bucket);
  void Unmark(uint32_t bucket);
  void UnmarkWordIf(bool empty, uint32_t word);
  uint32_t Heuristic(uint32_t index) const;
  void Finish(Status status);
  void BeginTrace(uint32_t end, uint32_t cost, bool partial);
  Status UsableStatus() const;

  // The entire search state of a cell: see astar.cpp. [kMapSize_cells x kMapSize_cells], row-major.
  uint64_t nodes_[kMapCells];

  // The open set: circular buckets of equal cost-so-far plus heuristic (f), each a doubly linked
  // list through nodes_. Only the heads of marked buckets are valid.
  uint32_t bucket_head_[kBuckets];
  uint64_t bucket_used_[kBucketWords];  // one bit per bucket
  uint64_t bucket_words_used_ = 0;      // bit per nonzero word of bucket_used_, but the present
  uint32_t least_f_ = 0;                // of the last expanded cell: not above any in the open set

  AstarResult result_;
  GridWindow window_;
  uint32_t start_ = 0;  // indices
  uint32_t goal_ = 0;
  int32_t max_expansions_ = 0;
  // Labels: base_ + g in this query, below ceiling_; at least ceiling_ for earlier queries.
  uint32_t base_ = 0;
  uint32_t ceiling_ = 0;
  uint32_t least_label_ = 0;              // in use; 0: the next query must clear
  int32_t row_ = 0;                       // next row of kClear, kMoveGoal or kMoveLabels
  int32_t nearest_distance2_cells2_ = 0;  // of the best goal seen so far
  int32_t goal_limit_cells2_ = 0;         // squared, from the requested goal
  uint32_t nearest_goal_ = 0;
  uint32_t best_ = 0;  // the best end of a partial path so far, ...
  uint32_t best_heuristic_ = 0;
  uint32_t best_cost_ = 0;
  uint32_t trace_cell_ = 0;
  uint32_t trace_direction_ = 0;  // of the step into trace_cell_
  Phase phase_ = Phase::kDone;
};
static_assert(std::is_trivially_copyable_v<AstarSearch>);
static_assert(sizeof(AstarSearch) <= 8 * kMapCells + 4 * 4096 + 1024);

}  // namespace hardpack
