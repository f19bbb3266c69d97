// SPDX-License-Identifier: Apache-2.0
#include "core/path/path_smoother.h"

#include "core/base/loop_bound.h"

namespace hardpack {

Status PathSmoother::Begin(const WorldPath& path, int passes) {
  passes_left_ = 0;
  if (path.size() < 2) return Status::kPathTooShort;
  if (passes < 0 || passes > kMaxPasses) return Status::kParameterOutOfRange;
  path_ = path;
  passes_left_ = passes;
  return Status::kOk;
}

Progress PathSmoother::Step(int units) {
  HP_LOOP_BOUND(kMaxPasses)
  for (int left = units; left > 0 && passes_left_ > 0; --left) {
    AverageOnce();
    --passes_left_;
  }
  if (passes_left_ > 0) return Progress::kBusy;
  SetHeadingsFromChords(path_);
  return Progress::kDone;
}

void PathSmoother::AverageOnce() {
  Vec2 before = {path_[0].x_m, path_[0].y_m};  // as it was before this pass
  HP_LOOP_BOUND(kMaxPathPoints - 2)
  for (int i = 1; i + 1 < path_.size(); ++i) {
    const Vec2 here = {path_[i].x_m, path_[i].y_m};
    const Pose2& behind = path_[i + 1];
    path_[i].x_m = 0.25f * (before.x_m + behind.x_m) + 0.5f * here.x_m;
    path_[i].y_m = 0.25f * (before.y_m + behind.y_m) + 0.5f * here.y_m;
    before = here;
  }
}

}  // namespace hardpack
