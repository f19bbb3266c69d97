// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/autonomy/mapper.h"
#include "core/base/pose.h"
#include "core/measurements/measurements.h"
#include "tools/capture/rellis_labels.h"

// Passes one revolution through the mapper, as on a vehicle that stands still, and reports how its
// returns were filed.

namespace hardpack::capture {

// Adds the revolution's valid columns, spread over a tenth of a second, each followed directly by
// its labels. `mapper` is configured; `labels`: nullptr for none. Returns the status of the first
// column that the mapper did not accept.
Status MapRevolution(std::span<const LidarColumn> columns, const StampedPose& pose,
                     const ScanLabels* labels, Mapper& mapper);

// One return as it was filed.
struct ClassedPoint {
  Vec3 point_odom;
  ReturnClass return_class = ReturnClass::kIgnored;
};

struct FiledReturns {
  int64_t returns = 0;               // with a range
  int64_t self_returns = 0;          // of these, the vehicle itself or outside the usable range
  int64_t ignored_returns = 0;       // of the others, those of class kIgnored
  int64_t returns_off_grid = 0;      // of the others, those too far away for the grid
  std::vector<ClassedPoint> points;  // all but self and ignored, in the order of columns and rows
};

// The returns in the mapper's ring. A return labelled as a person is never the vehicle itself.
FiledReturns ReturnsIn(const Mapper& mapper);

}  // namespace hardpack::capture
