// SPDX-License-Identifier: Apache-2.0
// Any bytes as a file of points, PCD or CSV by the first of them, and those as columns. Required:
// what is refused leaves nothing and names the file; what is read is finite; each point of the
// columns is in one of them, or hidden by a nearer one, or was too far away or at the origin.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "core/base/math.h"
#include "test/fuzz/accepted.h"
#include "tools/capture/point_columns.h"
#include "tools/capture/point_file.h"

namespace {

using namespace hardpack;
using namespace hardpack::capture;

void Require(bool condition) {
  if (!condition) std::abort();
}

void CheckColumns(const PointCloud& cloud, const PointColumns& columns) {
  int64_t filed = 0;
  for (size_t id = 0; id < columns.columns.size(); ++id) {
    const LidarColumn& column = columns.columns[id];
    if (!column.valid) continue;
    Require(column.measurement_id == id && column.beams == columns.model.beams);
    for (int row = 0; row < column.beams; ++row) {
      Require(column.range_mm[row] <= 500'000);
      filed += column.range_mm[row] != 0 ? 1 : 0;
    }
  }
  Require(filed > 0 && filed + columns.hidden <= static_cast<int64_t>(cloud.points.size()));
  Require(std::isfinite(columns.largest_elevation_error_rad));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const bool is_pcd = data[0] % 2 == 0;
  const std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
  PointCloud cloud;
  const ReadOutcome outcome =
      is_pcd ? ParsePcd("name", content, cloud) : ParseCsv("name", content, cloud);
  Require(outcome.ok() == !cloud.points.empty());
  Require(outcome.ok() || outcome.message.find("name") == 0);
  if (!outcome.ok()) return 0;
  Accepted(is_pcd ? "pcd" : "csv");
  for (const CloudPoint& point : cloud.points) {
    Require(IsFinite(point.position) && point.ring >= -1 && point.ring <= 65535);
  }
  const auto columns = std::make_unique<PointColumns>();
  if (MakeColumns(cloud.points, *columns).ok()) CheckColumns(cloud, *columns);
  return 0;
}
