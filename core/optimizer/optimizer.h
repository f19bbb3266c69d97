// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/optimizer/cost_terms.h"
#include "core/optimizer/lateral_newton.h"
#include "core/optimizer/path_cost.h"
#include "core/path/path.h"

// The path optimizer of the paper ([OS] Cost Function Formulation and Path Solver, Algorithm 1;
// docs/algorithm.md sections 4 and 5): gradient descent over single heading changes, each
// perturbation damped back into the unperturbed path by an S-curve over the next N steps. It finds
// a local optimum near its seed; it does not evaluate the result (core/safety does), and it does
// not look for a path on another side of an obstacle.

namespace hardpack {

// Perturb(i, delta) of the paper: adds delta_rad to the heading change at point i, integrates the
// next `window` steps forward and blends them back into the unperturbed ones with a quintic
// S-curve. Points 0 .. i and i + window .. n - 1 do not move. The window shrinks near the end.
// damped = false omits the blend (the paper's figure): everything after point i turns. Headings by
// SetHeadingsFromChords. `perturbed` may be `path` itself. kInvalidArgument: no point after i could
// move (i < 0 or i > n - 3; undamped i > n - 2), or window < 2; kNotFinite. On failure `perturbed`
// is empty.
Status Perturb(const WorldPath& path, int point, float delta_rad, int window, bool damped,
               WorldPath& perturbed);

// Algorithm 1 over a vehicle model (see PlanarModel). Our additions, each bounded:
// - the better of the left and the right perturbation is taken; the step scaled by its decrease is
//   tried if it is larger than the unit step, and kept only if it is better, so that every kept
//   change lowers F;
// - after each sweep the points are respaced evenly along the path, unless that raises F;
// - a sweep that gains less than min_relative_decrease halves the unit step, and ends the descent
//   when it has been halved kMaxHalvings times;
// - a point tried in vain is not retried before something in its window has changed, which gives
//   the same path sooner.
template <typename Model>
class BasicOptimizer {
 public:
  static constexpr int kMinPoints = kMinSeedPoints;
  static constexpr int kMaxHalvings = 3;
  static constexpr int kMaxSweeps = 1000;
  // A whole run for any seed: each sweep's points, respacing them and the cost of that.
  static constexpr int kMaxUnits = 3 * kMaxPathPoints * kMaxSweeps;

  // seed: forward steps only; its first chord is kept (join it first, see JoinStart), as are both
  // end points, and the last chord if keep_end_heading (see JoinEnd). kPathTooShort: fewer than
  // kMinPoints points; kNotFinite (the seed's cost too); kInvalidArgument: a chord is shorter than
  // 0.1 mm; kParameterOutOfRange. On failure path() is empty. Cost: the seed's, one pass over its
  // points.
  Status Begin(const Costmap& map, const OptimizerParams& params, const PathParams& path_params,
               const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading);

  // A unit is one point: its left and its right perturbation, tried and possibly kept (at most
  // three windows evaluated). Respacing the points between sweeps, and its cost, are also divided
  // into units of one point.
  Progress Step(const Costmap& map, int units);

  // Valid once Step has returned kDone (before: once Begin has returned kOk).
  const OptimizerResult& result() const { return result_; }

  // The best path so far; after every Step a complete path from start to end, including headings,
  // with a cost not above the seed's (meanwhile to the rounding of a sum; at the end exactly).
  const WorldPath& path() const { return path_; }

 private:
  enum class Phase : uint8_t { kIdle, kSweep, kSpread, kSpreadCost };

  // A path and the cost of each of its points.
  struct Line {
    Vec2 point[kMaxPathPoints];
    float curvature_per_m[kMaxPathPoints] = {};
    float map_cost[kMaxPathPoints] = {};
    float path_cost[kMaxPathPoints] = {};
  };

  // A perturbation at `pivot` moves the points between pivot and end, both exclusive, and changes
  // the costs of pivot .. last, which now add up to `cost`.
  struct Window {
    int32_t pivot;
    int32_t end;
    int32_t last;
    float cost;
  };

  static PathCost SumOf(const Line& line, int points);

  void DoUnit(const Costmap& map);
  void CostNextPoint(const Costmap& map, Line& line, int points);
  void End(Status status);

  int WindowEnd(int pivot) const;
  Window WindowAt(int pivot) const;
  void BeginSweep();
  bool TryPoint(const Costmap& map, int pivot);
  float TryTurn(const Costmap& map, const Window& window, float delta_rad, float limit,
                Line& candidate);
  void MovePoints(const Window& window, float delta_rad, Line& candidate) const;
  void Keep(const Window& window, const Line& candidate);
  void Unsettle(int first, int last);
  void EndSweep();

  bool BeginSpread();
  void SpreadNextPoint();
  void EndSpread();
  void JudgeSweep();
  void Publish();

  OptimizerParams params_;
  OptimizerResult result_;
  WorldPath path_;
  Phase phase_ = Phase::kIdle;
  bool moved_ = false;  // line_ has changed since it was last published to path_
  float wanted_step_m_ = 0.0f;
  float start_curvature_per_m_ = 0.0f;
  int32_t end_points_ = 0;  // fixed points: the last, or the last two
  int32_t points_ = 0;      // of line_
  int32_t at_ = 0;          // the phase's next point
  float unit_step_rad_ = 0.0f;
  int32_t halvings_ = 0;
  bool settled_[kMaxPathPoints] = {};  // tried in vain, and nothing it looks at has changed since
  cost_terms::Walk walk_;              // of a whole line's cost

  Line line_;
  Line candidate_[2];
  Line sweep_start_;  // line_ when the sweep began ...
  PathCost cost_;     // ... and its cost

  // Respacing: line_'s points redistributed into candidate_[0].
  int32_t spread_points_ = 0;
  float spread_step_m_ = 0.0f;
  int32_t spread_chord_ = 0;     // of line_: the next new point lies on it ...
  float spread_along_m_ = 0.0f;  // ... this far from its start
};

extern template class BasicOptimizer<PlanarModel>;
static_assert(sizeof(BasicOptimizer<PlanarModel>) <= 32 * 1024);

// The optimizer selected by params.method. Begin, Step and the results are as above. The paper's
// method does not know `places`: its path may pass them farther away.
class Optimizer {
 public:
  static constexpr int kMinPoints = kMinSeedPoints;
  static constexpr int kMaxSweeps = BasicOptimizer<PlanarModel>::kMaxSweeps;
  static constexpr int kMaxUnits = BasicOptimizer<PlanarModel>::kMaxUnits > LateralNewton::kMaxUnits
                                       ? BasicOptimizer<PlanarModel>::kMaxUnits
                                       : LateralNewton::kMaxUnits;

  Status Begin(const Costmap& map, const OptimizerParams& params, const PathParams& path_params,
               const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading,
               const PassingPlaces& places = {});
  Progress Step(const Costmap& map, int units);
  const OptimizerResult& result() const { return by_paper_ ? descent_.result() : newton_.result(); }
  const WorldPath& path() const { return by_paper_ ? descent_.path() : newton_.path(); }

 private:
  bool by_paper_ = true;
  BasicOptimizer<PlanarModel> descent_;
  LateralNewton newton_;
};
static_assert(std::is_trivially_copyable_v<Optimizer>);
static_assert(sizeof(Optimizer) <= 96 * 1024);

// Makes the seed's first chord point along the vehicle's heading: over a window at its start the
// base path is blended, by the same S-curve, out of the straight line ahead. The window is long
// enough for the curvature limit (on a straight base path 4.62 error / kappa_max, the largest
// second derivative of the blend) if the path is long enough. `error` is the larger of those to the
// base path's first chord and to BaseHeading(base). Points beyond the window and point 0 do not
// move, and each keeps its index. `seed` may be `base` itself. kPathTooShort: fewer than 4 points;
// kNotFinite; kInvalidArgument: BaseHeading is more than params.max_join_heading_rad off (pivot
// first). On failure `seed` is empty.
Status JoinStart(const WorldPath& base, const PathParams& params, const OptimizerParams& optimizer,
                 float start_heading_rad, WorldPath& seed);

// The same at the path's end: the last chord points along end_heading_rad, the end stays.
Status JoinEnd(const WorldPath& base, const PathParams& params, const OptimizerParams& optimizer,
               float end_heading_rad, WorldPath& seed);

}  // namespace hardpack
