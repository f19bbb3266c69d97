// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"

// What an optimizer minimises, F of a whole path ([OS] Cost Function Formulation; docs/algorithm.md
// section 4), and the common inputs and results of the optimizers.

namespace hardpack {

// F(P) = map + path; the sums of docs/algorithm.md section 4. Dimensionless.
struct PathCost {
  float map = 0.0f;
  float path = 0.0f;
  float total() const { return map + path; }
};

// Whether the preferred limit of the curvature rate differs from the final one.
inline bool HasPreferredRate(const OptimizerParams& params) {
  return params.preferred_curvature_rate_per_m2 < params.max_curvature_rate_per_m2;
}

// `params` with the preferred limit of the curvature rate and its weight in place of the final
// ones, if there is one.
inline OptimizerParams AtPreferredRate(OptimizerParams params) {
  if (!HasPreferredRate(params)) return params;
  params.max_curvature_rate_per_m2 = params.preferred_curvature_rate_per_m2;
  params.curvature_rate_beta = params.preferred_curvature_rate_beta;
  return params;
}

// Cost of a whole path of n points. start_curvature_per_m: the vehicle's present curvature, against
// which the first change of curvature is computed.
//   F_map  = sum_{k=0}^{n-1} ds_k cost(p_k)
//   F_path = sum_{k=1}^{n-2} ds_k [ f(kappa_k; alpha, beta, kappa_max)
//                                 + f(kappa'_k; alpha', beta', kappa'_max) ]
//   ds_k the mean length of the two chords that meet at p_k (half the one chord at the ends),
//   kappa_k = phi_{k-1} / ds_k, the turn between those chords, kappa_0 = start_curvature_per_m,
//   kappa'_k = (kappa_k - kappa_{k-1}) / ds_k,
//   f(u) = alpha |u| below u_max, alpha u_max + beta (|u| - u_max) above.
// Chords count, headings do not: forward steps only. No turn is counted where ds_k is below
// 0.1 mm. Fewer than two points cost nothing. Points must be finite. Cost: one pass over the
// path.
PathCost CostOf(const Costmap& map, const OptimizerParams& params, const WorldPath& path,
                float start_curvature_per_m);

// With fewer points there is nothing to bend.
inline constexpr int kMinSeedPoints = 4;

// Whether a path can be optimized: kPathTooShort: fewer than kMinSeedPoints points; kNotFinite;
// kInvalidArgument: a chord is shorter than 0.1 mm. Cost: one pass over the path.
Status CheckSeed(const WorldPath& seed, float start_curvature_per_m);

// kParameterOutOfRange unless every number is finite, weights are not negative, limits and steps
// are positive, and counts are within the optimizers' own bounds.
Status CheckOptimizerParams(const OptimizerParams& params, const PathParams& path_params);

struct OptimizerResult {
  Status status = Status::kNotStarted;  // kOk (converged) or kIterationLimit
  PathCost before;                      // of the seed
  PathCost after;                       // never above before; CostOf(path()), bit for bit
  int32_t sweeps = 0;                   // rounds over the path: of Algorithm 1, or Newton steps
  int32_t perturbations_kept = 0;       // changes that lowered F
  int32_t spreads_kept = 0;
};

}  // namespace hardpack
