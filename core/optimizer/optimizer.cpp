// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/optimizer.h"

#include "core/optimizer/basic_optimizer.h"

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

template class BasicOptimizer<PlanarModel>;

Status CheckOptimizerParams(const OptimizerParams& params, const PathParams& path_params) {
  const bool good =
      IsPositive(params.max_curvature_per_m) && IsPositive(params.max_curvature_rate_per_m2) &&
      IsWeight(params.curvature_alpha) && IsWeight(params.curvature_beta) &&
      IsWeight(params.curvature_rate_alpha) && IsWeight(params.curvature_rate_beta) &&
      IsPositive(params.perturbation_rad) && IsPositive(params.max_perturbation_rad) &&
      params.perturbation_rad <= params.max_perturbation_rad &&
      params.max_perturbation_rad <= kHalfPi && IsWeight(params.perturbation_scale) &&
      params.window_steps >= 2 && params.window_steps < kMaxPathPoints && params.max_sweeps >= 0 &&
      params.max_sweeps <= Optimizer::kMaxSweeps && IsWeight(params.min_relative_decrease) &&
      IsFinite(path_params.step_m) && path_params.step_m >= PathSampler::kMinStep_m;
  return good ? Status::kOk : Status::kParameterOutOfRange;
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

Status Perturb(const WorldPath& path, int point, float delta_rad, int window, bool damped,
               WorldPath& perturbed) {
  perturbed = path;
  Status status = Status::kOk;
  const int last = path.size() - 1;
  const int behind = damped ? 2 : 1;
  if (point < 0 || point > last - behind || window < 2) status = Status::kInvalidArgument;
  if (!IsFinite(delta_rad)) status = Status::kNotFinite;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : path) {
    if (!IsFinite(pose)) status = Status::kNotFinite;
  }
  if (status != Status::kOk) {
    perturbed.Clear();
    return status;
  }
  const int steps = window < last - point ? window : last - point;
  const SinCosPair turn = SinCos(delta_rad);
  const Vec2 pivot = Position(path[point]);
  const float share = 1.0f / static_cast<float>(steps);
  const int end = damped ? point + steps : last + 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = point + 1; k < end; ++k) {
    const float weight =
        damped ? 1.0f - perturbation::SCurve(static_cast<float>(k - point) * share) : 1.0f;
    const Vec2 moved =
        perturbation::PerturbedPoint<PlanarModel>(pivot, Position(path[k]), turn, weight);
    perturbed[k].x_m = moved.x_m;
    perturbed[k].y_m = moved.y_m;
  }
  SetHeadingsFromChords(perturbed);
  return Status::kOk;
}

}  // namespace hardpack
