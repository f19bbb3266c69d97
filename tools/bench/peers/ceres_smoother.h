// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "config/parameters.h"
#include "core/costmap/costmap.h"
#include "core/optimizer/optimizer.h"
#include "core/path/path.h"

// Ceres as a path smoother, for comparison with core/optimizer: it moves the free points of a path
// sideways, each along its normal on the seed, so that F (core/optimizer/optimizer.h) falls, with
// |u| in F rounded at 0, as Ceres requires. Two of its solvers can do that, and both are offered:
// - kTrustRegion: F as nonlinear least squares, one residual block a term. A term a |u| is the
//   residual u under a loss function, which Ceres solves by reweighting; the map's term is the
//   square of its root. Levenberg-Marquardt with sparse Cholesky, as nav2's constrained smoother.
// - kLineSearch: F as one function of all offsets (GradientProblemSolver), by L-BFGS.
// That is its best fair use: derivatives are analytic and computed once per step for all residuals
// (EvaluationCallback), one thread, tolerances at Ceres' defaults. Points free in x and y, with
// twice the unknowns, so that points can slide along the path, were tried: slower and worse. The
// points of the solution are spread evenly if that lowers F, as in core/optimizer. The problem is
// built for each path, as in nav2, so building it is part of the time.

namespace hardpack::peers {

enum class CeresMethod : uint8_t { kTrustRegion, kLineSearch };

struct CeresResult {
  bool usable = false;  // according to Ceres; otherwise `path` is the seed
  bool converged = false;
  int32_t iterations = 0;
  PathCost before;  // CostOf the seed: the true F, in single precision
  PathCost after;   // CostOf `path`; Ceres does not promise that it is lower
  WorldPath path;   // as many points as the seed; headings from the chords
};

// The same points stay fixed as in Optimizer::Begin: the first two and the last one, or the last
// two if keep_end_heading. Fewer than 4 points, points that are not finite and chords of length 0
// are not usable.
CeresResult Smooth(CeresMethod method, const Costmap& map, const OptimizerParams& params,
                   const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading,
                   int max_iterations);

// The rounded F that a method minimises, and its derivative by the offset of each free point from
// the seed, along the normal to the left (for tests). offsets_m: one a free point, from point 2 on.
// Without a gradient where Smooth is not usable.
struct CeresObjective {
  double value = 0.0;                  // without terms that no free point changes
  std::vector<double> gradient_per_m;  // [free points]
};
CeresObjective ObjectiveOf(CeresMethod method, const Costmap& map, const OptimizerParams& params,
                           const WorldPath& seed, float start_curvature_per_m,
                           bool keep_end_heading, std::span<const double> offsets_m);

}  // namespace hardpack::peers
