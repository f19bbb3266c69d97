// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/measurements/measurements.h"
#include "tools/capture/point_file.h"

// Plain points as the columns of a lidar that would have seen them: rows by elevation, columns by
// azimuth, the range as it is. The points are in the lidar's frame, whose origin saw them all.

namespace hardpack::capture {

// How the rows came about.
enum class RowsFrom : uint8_t {
  kRing,       // the file says of which beam each point is
  kElevation,  // the elevations lie in kMaxBeams groups or fewer: beams
  kEven,       // they do not: kMaxBeams rows, evenly between the lowest and the highest
};
const char* NameOf(RowsFrom rows);

struct PointColumns {
  RowsFrom rows = RowsFrom::kEven;
  BeamModel model;
  std::vector<LidarColumn>
      columns;         // [model.columns_per_revolution]; those without a point: invalid
  int64_t hidden = 0;  // points behind a nearer one of the same row and column
  // How far a point's elevation is from that of its row, at most: at a range r it is filed up to
  // r * this too high or too low.
  float largest_elevation_error_rad = 0.0f;
};

// The columns: 2048, or 1024 with more than 64 rows. Points at the origin, and those farther than a
// column can tell, are left out. kCapacityExceeded: more than kMaxBeams rings; kEmpty: no point is
// left; else a one-line message without a file's name.
ReadOutcome MakeColumns(const std::vector<CloudPoint>& points, PointColumns& columns);

}  // namespace hardpack::capture
