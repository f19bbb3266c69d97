// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/moved_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/optimizer/cost_terms.h"
#include "core/optimizer/perturbation.h"

namespace hardpack::peers {
namespace {

Vec2 PositionOf(const Pose2& pose) {
  return {pose.x_m, pose.y_m};
}

}  // namespace

MovedPath::MovedPath(const WorldPath& seed, bool keep_end_heading)
    : free_end_(seed.size() - (keep_end_heading ? 2 : 1)) {
  for (const Pose2& pose : seed) {
    seed_m_.push_back(pose.x_m);
    seed_m_.push_back(pose.y_m);
  }
  moved_m_ = seed_m_;
  offsets_m_.assign(seed_m_.size() / 2, 0.0);
  normals_.assign(seed_m_.size(), 0.0);
  for (int k = kFirstFree; k < free_end_; ++k) {
    const double* const here = seed_m_.data() + 2 * k;
    double x = here[2] - here[-2];
    double y = here[3] - here[-1];
    if (x == 0.0 && y == 0.0) {  // there and back again
      x = here[2] - here[0];
      y = here[3] - here[1];
    }
    const double length = std::sqrt(x * x + y * y);
    double* const normal = normals_.data() + 2 * k;
    normal[0] = -y / length;
    normal[1] = x / length;
  }
}

void MovedPath::Place() {
  for (int k = kFirstFree; k < free_end_; ++k) {
    const double offset_m = offsets_m_.data()[k];
    for (int i = 2 * k; i < 2 * k + 2; ++i) {
      moved_m_.data()[i] = seed_m_.data()[i] + normals_.data()[i] * offset_m;
    }
  }
}

void MovedPath::CopyTo(WorldPath& path) const {
  for (int k = kFirstFree; k < free_end_; ++k) {
    path[k].x_m = static_cast<float>(moved_m_.data()[2 * k]);
    path[k].y_m = static_cast<float>(moved_m_.data()[2 * k + 1]);
  }
  SetHeadingsFromChords(path);
}

WorldPath Spread(const WorldPath& path, bool keep_end_heading) {
  const int first = MovedPath::kFirstFree - 1;               // the last point that stays ...
  const int end = path.size() - (keep_end_heading ? 2 : 1);  // ... and the next that does
  std::vector<float> along_m = {0.0f};
  for (int k = first; k < end; ++k) {
    const Vec2 chord = Minus(PositionOf(path[k + 1]), PositionOf(path[k]));
    along_m.push_back(along_m.back() + Length(chord));
  }
  WorldPath spread = path;
  const float step_m = along_m.back() / static_cast<float>(end - first);
  size_t chord = 0;
  for (int k = first + 1; k < end; ++k) {
    const float at_m = step_m * static_cast<float>(k - first);
    while (chord + 2 < along_m.size() && along_m[chord + 1] <= at_m) ++chord;
    const int from = first + static_cast<int>(chord);
    const int window = std::clamp(from - 1, 0, path.size() - 4);
    Vec2 points[4];
    for (int i = 0; i < 4; ++i) points[i] = PositionOf(path[window + i]);
    const Vec2 point = perturbation::CubicThrough(points, from - window, at_m - along_m[chord]);
    spread[k].x_m = point.x_m;
    spread[k].y_m = point.y_m;
  }
  SetHeadingsFromChords(spread);
  return spread;
}

}  // namespace hardpack::peers
