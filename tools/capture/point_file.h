// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.h"
#include "port_linux/files/read_outcome.h"

// Files of plain points: PCD ([PCD]; DATA ascii and binary) and CSV. They do not classify points,
// and do not say from where a point was seen.

namespace hardpack::capture {

struct CloudPoint {
  Vec3 position;      // [m], in the file's own frame
  int32_t ring = -1;  // its beam; -1: the file does not say
};

struct PointCloud {
  std::vector<CloudPoint> points;  // in the order of the file
  int64_t without_position = 0;    // points that are not finite: in PCD, no return
};

inline constexpr int64_t kMaxCloudPoints = 16'000'000;

// Reads a file; the extension determines the format: .pcd or .csv. Fields x, y and z are required;
// `ring` (also called laser_id or channel) is used if present; others are skipped.
//   PCD: fields of any size and type that the format has, in any order; little-endian, as written
//        by the processors on which it is used. binary_compressed is not supported.
//   CSV: commas, and in the first line either the field names (upper or lower case) or a point,
//        whose first three numbers are x, y, z.
// On failure the status and a one-line message that names the file and the line or the field.
ReadOutcome ReadPoints(const std::string& path, PointCloud& cloud);

// The same for a file's content; `name` is for messages.
ReadOutcome ParsePcd(const std::string& name, std::string_view content, PointCloud& cloud);
ReadOutcome ParseCsv(const std::string& name, std::string_view content, PointCloud& cloud);

}  // namespace hardpack::capture
