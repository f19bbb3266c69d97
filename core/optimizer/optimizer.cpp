// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/optimizer.h"

#include "core/optimizer/basic_optimizer.h"

namespace hardpack {
template class BasicOptimizer<PlanarModel>;

Status Optimizer::Begin(const Costmap& map, const OptimizerParams& params,
                        const PathParams& path_params, const WorldPath& seed,
                        float start_curvature_per_m, bool keep_end_heading,
                        const PassingPlaces& places) {
  by_paper_ = params.method == OptimizerParams::kPaperDescent;
  return by_paper_ ? descent_.Begin(map, params, path_params, seed, start_curvature_per_m,
                                    keep_end_heading)
                   : newton_.Begin(map, params, path_params, seed, start_curvature_per_m,
                                   keep_end_heading, places);
}

Progress Optimizer::Step(const Costmap& map, int units) {
  return by_paper_ ? descent_.Step(map, units) : newton_.Step(map, units);
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
  const Vec2 pivot = PlaceOf(path[point]);
  const float share = 1.0f / static_cast<float>(steps);
  const int end = damped ? point + steps : last + 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = point + 1; k < end; ++k) {
    const float weight =
        damped ? 1.0f - perturbation::SCurve(static_cast<float>(k - point) * share) : 1.0f;
    const Vec2 moved =
        perturbation::PerturbedPoint<PlanarModel>(pivot, PlaceOf(path[k]), turn, weight);
    perturbed[k].x_m = moved.x_m;
    perturbed[k].y_m = moved.y_m;
  }
  SetHeadingsFromChords(perturbed);
  return Status::kOk;
}

}  // namespace hardpack
