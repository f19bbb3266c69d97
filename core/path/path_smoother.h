// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/path/path.h"

namespace hardpack {

// Removes the staircase from a resampled cell path (docs/algorithm.md section 3, ours): repeated
// binomial averaging of neighbouring points, which spreads each corner of 45 degrees over about
// sqrt(2 x passes) points to either side (with the defaults, no point moves by more than about half
// a metre). It uses no map and no limits: the planner takes the result only if it costs less. End
// points stay.
class PathSmoother {
 public:
  static constexpr int kMaxPasses = 200;

  // kPathTooShort: fewer than two points; kParameterOutOfRange: passes not in 0 .. kMaxPasses.
  Status Begin(const WorldPath& path, int passes);

  // A unit is one pass over the points: p_i = (p_{i-1} + 2 p_i + p_{i+1}) / 4.
  Progress Step(int units);

  // Headings by SetHeadingsFromChords. Valid once Step has returned kDone.
  const WorldPath& result() const { return path_; }

 private:
  void AverageOnce();

  WorldPath path_;
  int32_t passes_left_ = 0;
};
static_assert(std::is_trivially_copyable_v<PathSmoother>);

}  // namespace hardpack
