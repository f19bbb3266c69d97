// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "config/parameters.h"
#include "core/costmap/costmap.h"
#include "core/optimizer/optimizer.h"
#include "core/path/path.h"

// Ceres as a path smoother, beside core/optimizer: it moves the free points of a path across it,
// each along the normal that it has on the seed, so that F (core/optimizer/optimizer.h) falls, with
// F's |u| rounded off at 0, which Ceres needs. Two of its solvers can do that, and both are
// offered:
// - kTrustRegion: F as nonlinear least squares, one residual block a term. A term a |u| is the
//   residual u under a loss function, which Ceres solves by reweighting; the map's term is the
//   square of its root. Levenberg-Marquardt with sparse Cholesky, as nav2's constrained smoother.
// - kLineSearch: F as one function of all offsets (GradientProblemSolver), by L-BFGS.
// That is its best fair use: derivatives are analytic and found once a step for all residuals
// (EvaluationCallback), one thread, tolerances at Ceres' defaults. Points free in x and y, which
// has twice the unknowns and lets points slide along the path, was tried and is slower and worse.
// The points of the solution are spread evenly where F is lower so, as core/optimizer does. The
// problem is built anew for each path, as nav2 does, so that belongs to the time.

namespace hardpack::peers {

enum class CeresMethod : uint8_t { kTrustRegion, kLineSearch };

struct CeresResult {
  bool usable = false;  // what Ceres says of its solution; otherwise `path` is the seed
  bool converged = false;
  int32_t iterations = 0;
  PathCost before;  // CostOf the seed: the true F, in single precision
  PathCost after;   // CostOf `path`; Ceres does not promise that it is lower
  WorldPath path;   // as many points as the seed; headings from the chords
};

// What stays where it is is what stays in Optimizer::Begin: the first two points and the last one,
// the last two when keep_end_heading. Fewer than 4 points, points that are not finite and chords
// without a length are not usable.
CeresResult Smooth(CeresMethod method, const Costmap& map, const OptimizerParams& params,
                   const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading,
                   int max_iterations);

// The rounded F that a method minimises, and its derivative by the offset of each free point from
// the seed, along the normal to the left (for tests). offsets_m: one a free point, from point 2 on.
// Without a gradient where Smooth is not usable.
struct CeresObjective {
  double value = 0.0;                  // less what no free point changes
  std::vector<double> gradient_per_m;  // [free points]
};
CeresObjective ObjectiveOf(CeresMethod method, const Costmap& map, const OptimizerParams& params,
                           const WorldPath& seed, float start_curvature_per_m,
                           bool keep_end_heading, std::span<const double> offsets_m);

}  // namespace hardpack::peers
