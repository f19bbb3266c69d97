// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/measurements/measurements.h"
#include "tools/capture/point_file.h"

// Converts plain points to the columns of a lidar that would have seen them: rows by elevation,
// columns by azimuth, the range unchanged. The points are in the lidar's frame, and all were seen
// from its origin.

namespace hardpack::capture {

// How the rows were determined.
enum class RowsFrom : uint8_t {
  kRing,       // the file gives the beam of each point
  kElevation,  // the elevations form kMaxBeams groups or fewer: beams
  kEven,       // they do not: kMaxBeams rows, evenly spaced from the lowest to the highest
};
const char* NameOf(RowsFrom rows);

struct PointColumns {
  RowsFrom rows = RowsFrom::kEven;
  BeamModel model;
  std::vector<LidarColumn>
      columns;         // [model.columns_per_revolution]; those without a point: invalid
  int64_t hidden = 0;  // points behind a nearer one of the same row and column
  // Largest difference between the elevation of a point and that of its row: at a range r the point
  // is filed up to r * this too high or too low.
  float largest_elevation_error_rad = 0.0f;
};

// Makes 2048 columns, or 1024 with more than 64 rows. Points at the origin, and points farther than
// a column can represent, are left out. kCapacityExceeded: more than kMaxBeams rings; kEmpty: no
// point is left; otherwise a one-line message without a file name.
ReadOutcome MakeColumns(const std::vector<CloudPoint>& points, PointColumns& columns);

}  // namespace hardpack::capture
