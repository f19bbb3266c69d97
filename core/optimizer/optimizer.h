// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"

// The path optimizer of the paper ([OS] Cost Function Formulation and Path Solver, Algorithm 1;
// docs/algorithm.md sections 4 and 5): gradient descent over single heading changes, each
// perturbation damped back into the unperturbed path by an S-curve over the next N steps.

namespace hardpack {

// F(P) = map + path; the sums of docs/algorithm.md section 4. Dimensionless.
struct PathCost {
  float map = 0.0f;
  float path = 0.0f;
  float total() const { return map + path; }
};

// Cost of a whole path. start_curvature_per_m: the vehicle's present curvature, against which the
// first change of curvature is taken.
//   F_map = sum_k cost(p_k) |dr_k|
//   F_path = sum_k ds_k [ f(kappa_k; alpha, beta, kappa_max) + f(kappa'_k; alpha', beta',
//   kappa'_max) ] kappa_k = phi_k / ds_k, ds_k the mean length of the two chords that meet there,
//   kappa'_k = (kappa_k - kappa_{k-1}) / ds_k
//   f(u) = alpha |u| below u_max, alpha u_max + beta (|u| - u_max) above
PathCost CostOf(const Costmap& map, const OptimizerParams& params, const WorldPath& path,
                float start_curvature_per_m);

// Perturb(i, delta) of the paper: adds delta_rad to the heading change at point i, integrates the
// next `window` steps forward and blends them back into the unperturbed ones with a quintic
// S-curve. Points 0 .. i and i + window .. n - 1 stay where they are. The window shrinks near the
// end. damped = false leaves the blend out (the paper's figure): everything behind point i turns.
// kInvalidArgument: no such point, or window < 2; kNotFinite.
Status Perturb(const WorldPath& path, int point, float delta_rad, int window, bool damped,
               WorldPath& perturbed);

struct OptimizerResult {
  Status status = Status::kNotStarted;  // kOk (converged) or kIterationLimit
  PathCost before;                      // of the seed
  PathCost after;                       // never above before
  int32_t sweeps = 0;
  int32_t perturbations_kept = 0;
};

class Optimizer {
 public:
  // seed: forward steps only; its first chord is kept as it is (join it first, see JoinStart), and
  // so are both end points; the last chord too when keep_end_heading.
  // kPathTooShort: fewer than 4 points; kNotFinite; kInvalidArgument: a chord has no length;
  // kParameterOutOfRange.
  Status Begin(const Costmap& map, const OptimizerParams& params, const PathParams& path_params,
               const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading);

  // A unit is one point: its left and its right perturbation, tried and perhaps kept. Resampling
  // and evaluating the whole path between sweeps are cut into units too.
  Progress Step(const Costmap& map, int units);

  const OptimizerResult& result() const { return result_; }

  // The best path so far; after every Step a complete path from start to end whose cost is not
  // above the seed's.
  const WorldPath& path() const { return path_; }

 private:
  OptimizerParams params_;
  OptimizerResult result_;
  WorldPath path_;
};

// The seed whose first chord points along the vehicle's heading: the base path, perturbed at its
// start by the heading error and damped over a window long enough for the curvature limit where the
// path is long enough. Precondition: the error is at most max_join_heading_rad (else pivot first).
// kPathTooShort; kNotFinite.
Status JoinStart(const WorldPath& base, const PathParams& params, const OptimizerParams& optimizer,
                 float start_heading_rad, WorldPath& seed);

}  // namespace hardpack
