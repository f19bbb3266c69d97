// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/path_cost.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/optimizer/cost_terms.h"
#include "core/optimizer/optimizer.h"

namespace hardpack {
namespace {

Vec2 Position(const Pose2& pose) {
  return {pose.x_m, pose.y_m};
}

bool IsPositive(float value) {
  return IsFinite(value) && value > 0.0f;
}

bool IsWeight(float value) {
  return IsFinite(value) && value >= 0.0f;
}

}  // namespace

Status CheckOptimizerParams(const OptimizerParams& params, const PathParams& path_params) {
  const bool counts = (params.method == OptimizerParams::kPaperDescent ||
                       params.method == OptimizerParams::kLateralNewton) &&
                      params.window_steps >= 2 && params.window_steps < kMaxPathPoints &&
                      params.max_sweeps >= 0 && params.max_sweeps <= Optimizer::kMaxSweeps &&
                      params.max_newton_steps >= 0 &&
                      params.max_newton_steps <= LateralNewton::kMaxSteps;
  const bool numbers =
      IsPositive(params.max_curvature_per_m) && IsPositive(params.max_curvature_rate_per_m2) &&
      IsPositive(params.preferred_curvature_rate_per_m2) &&
      IsWeight(params.preferred_curvature_rate_beta) && IsWeight(params.curvature_alpha) &&
      IsWeight(params.curvature_beta) && IsWeight(params.curvature_rate_alpha) &&
      IsWeight(params.curvature_rate_beta) && IsPositive(params.perturbation_rad) &&
      IsPositive(params.max_perturbation_rad) &&
      params.perturbation_rad <= params.max_perturbation_rad &&
      params.max_perturbation_rad <= kHalfPi && IsWeight(params.perturbation_scale) &&
      IsWeight(params.min_relative_decrease) && IsFinite(path_params.step_m) &&
      path_params.step_m >= PathSampler::kMinStep_m;
  return counts && numbers ? Status::kOk : Status::kParameterOutOfRange;
}

// Forward steps, each with a direction, and room for a perturbation.
Status CheckSeed(const WorldPath& seed, float start_curvature_per_m) {
  if (!IsFinite(start_curvature_per_m)) return Status::kNotFinite;
  if (seed.size() < kMinSeedPoints) return Status::kPathTooShort;
  if (!IsFinite(seed[0])) return Status::kNotFinite;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 1; k < seed.size(); ++k) {
    const Vec2 chord = {seed[k].x_m - seed[k - 1].x_m, seed[k].y_m - seed[k - 1].y_m};
    const float length_m = Length(chord);
    if (!IsFinite(seed[k]) || !IsFinite(length_m)) return Status::kNotFinite;
    if (length_m < cost_terms::kShortestChord_m) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

PathCost CostOf(const Costmap& map, const OptimizerParams& params, const WorldPath& path,
                float start_curvature_per_m) {
  const int last = path.size() - 1;
  PathCost sum;
  if (last < 1) return sum;
  cost_terms::Walk walk;
  sum.map = cost_terms::WalkFirstPoint(map, Position(path[0]), Position(path[1]),
                                       start_curvature_per_m, walk)
                .map;
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int k = 1; k < last; ++k) {
    const cost_terms::PointCost cost = cost_terms::WalkPoint<PlanarModel>(
        map, params, Position(path[k]), Position(path[k + 1]), walk);
    sum.map += cost.map;
    sum.path += cost.path;
  }
  sum.map += cost_terms::WalkLastPoint(map, Position(path[last]), walk).map;
  return sum;
}

}  // namespace hardpack
