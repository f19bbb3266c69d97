// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"
#include "core/speed/speed.h"

// The last judge of a plan before it may be driven (docs/algorithm.md section 5, end): at full
// resolution, with the footprint's discs, against the hard cells themselves. It trusts nothing that
// the planner computed but the map.

namespace hardpack {

struct PathCheckResult {
  Status status = Status::kNotStarted;  // kOk, kLimitExceeded, kCollision
  // Least distance from the footprint's discs to a hard cell's square [m]; negative: overlap depth.
  // Saturates at kClearanceReach_m.
  float smallest_clearance_m = 0.0f;
  // Least distance from the vehicle's middle to a hard cell's centre [m]; saturates too.
  float smallest_hard_distance_m = 0.0f;
  int32_t smallest_clearance_point = 0;
  float curvature_excess_per_m = 0.0f;        // largest |kappa| - max, 0 when within
  float curvature_rate_excess_per_m2 = 0.0f;  // the same for |kappa'|
  float largest_curvature_per_m = 0.0f;
  float largest_curvature_rate_per_m2 = 0.0f;
  bool leaves_map = false;  // a point of the path is off the map
};

inline constexpr float kClearanceReach_m = 2.0f;

class PathCheck {
 public:
  // path: poses of the path, pivots included (two points at one place). kPathTooShort; kNotFinite.
  Status Begin(const VehicleParams& vehicle, const OptimizerParams& limits, const WorldPath& path,
               float start_curvature_per_m);

  // A unit is one point and the chord behind it, sampled at half a cell.
  Progress Step(const Costmap& map, const WorldPath& path, int units);

  // kCollision when the clearance is not positive or the path leaves the map; kLimitExceeded when
  // a limit is exceeded by more than kLimitTolerance of itself.
  const PathCheckResult& result() const { return result_; }

  static constexpr float kLimitTolerance = 0.01f;

 private:
  PathCheckResult result_;
};

}  // namespace hardpack
