// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "core/optimizer/optimizer.h"
#include "core/optimizer/perturbation.h"

namespace hardpack {
namespace {

// On a straight path the joined one leaves it by s (1 - SCurve(s / D)) error, whose second
// derivative is largest at s = 0.39 D: 4.62 error / D.
constexpr float kBlendCurvature = 4.62f;

Vec2 ChordAt(const WorldPath& path, int k) {
  return {path[k + 1].x_m - path[k].x_m, path[k + 1].y_m - path[k].y_m};
}

void Reverse(WorldPath& path) {
  const int last = path.size() - 1;
  HP_LOOP_BOUND(kMaxPathPoints / 2)
  for (int k = 0; 2 * k < last; ++k) {
    const Pose2 swapped = path[k];
    path[k] = path[last - k];
    path[last - k] = swapped;
  }
}

Status CheckBase(const WorldPath& base, float heading_rad) {
  if (base.size() < Optimizer::kMinPoints) return Status::kPathTooShort;
  if (!IsFinite(heading_rad) || !IsFinite(LengthOf(base))) return Status::kNotFinite;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : base) {
    if (!IsFinite(pose)) return Status::kNotFinite;
  }
  return Status::kOk;
}

// Moves points 1 .. of `path` towards the straight line ahead of point 0: point 1 onto it, the ones
// behind less and less, none from reach_m along the path on, and never the last.
void BlendFromRay(float heading_rad, float reach_m, WorldPath& path) {
  const SinCosPair ray = SinCos(heading_rad);
  const Pose2 start = path[0];
  const float first_m = Length(ChordAt(path, 0));
  const float end_m = Min(first_m + reach_m, LengthOf(path));
  float along_m = first_m;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k + 1 < path.size() && (k == 1 || along_m < end_m); ++k) {
    const Vec2 next_chord = ChordAt(path, k);
    const float t = k == 1 ? 0.0f : (along_m - first_m) / (end_m - first_m);
    const float weight = 1.0f - perturbation::SCurve(t);
    Pose2& pose = path[k];
    pose.x_m += weight * (start.x_m + along_m * ray.cos - pose.x_m);
    pose.y_m += weight * (start.y_m + along_m * ray.sin - pose.y_m);
    along_m += Length(next_chord);
  }
}

}  // namespace

Status JoinStart(const WorldPath& base, const PathParams& params, const OptimizerParams& optimizer,
                 float start_heading_rad, WorldPath& seed) {
  seed = base;
  Status status = CheckBase(seed, start_heading_rad);
  const float error_rad = Abs(WrapAngle(start_heading_rad - BaseHeading(seed)));
  if (status == Status::kOk && !(error_rad <= params.max_join_heading_rad)) {
    status = Status::kInvalidArgument;
  }
  if (status != Status::kOk) {
    seed.Clear();
    return status;
  }
  const float first_error_rad = Abs(WrapAngle(start_heading_rad - HeadingOf(ChordAt(seed, 0))));
  const float reach_m =
      kBlendCurvature * Max(error_rad, first_error_rad) / optimizer.max_curvature_per_m;
  BlendFromRay(start_heading_rad, reach_m, seed);
  SetHeadingsFromChords(seed);
  return Status::kOk;
}

Status JoinEnd(const WorldPath& base, const PathParams& params, const OptimizerParams& optimizer,
               float end_heading_rad, WorldPath& seed) {
  seed = base;
  Reverse(seed);
  // WrapAngle would make a number of what is none.
  const float back_rad =
      IsFinite(end_heading_rad) ? WrapAngle(end_heading_rad + kPi) : end_heading_rad;
  const Status status = JoinStart(seed, params, optimizer, back_rad, seed);
  Reverse(seed);
  SetHeadingsFromChords(seed);
  return status;
}

}  // namespace hardpack
