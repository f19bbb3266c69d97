// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/point_columns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "core/scan/scan.h"

namespace hardpack::capture {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMillimetres = 1000.0;
// Farther than any lidar sees, and within the packed range of a return.
constexpr double kMaxRange_m = 500.0;

struct Direction {
  double range_m = 0.0;
  double elevation_rad = 0.0;
  double azimuth_rad = 0.0;  // anticlockwise from +x
  int32_t ring = -1;
};

std::vector<Direction> DirectionsOf(const std::vector<CloudPoint>& points) {
  std::vector<Direction> directions;
  directions.reserve(points.size());
  for (const CloudPoint& point : points) {
    const double x_m = double{point.position.x_m};
    const double y_m = double{point.position.y_m};
    const double z_m = double{point.position.z_m};
    const double level_m = std::hypot(x_m, y_m);
    const double range_m = std::hypot(level_m, z_m);
    if (range_m * kMillimetres < 1.0 || range_m > kMaxRange_m) continue;
    directions.push_back({range_m, std::atan2(z_m, level_m), std::atan2(y_m, x_m), point.ring});
  }
  return directions;
}

// The elevation of each row, from the highest down, and the row of each direction.
struct Rows {
  RowsFrom from = RowsFrom::kEven;
  std::vector<double> elevation_rad;
  std::vector<int> of;  // [directions]
};

// Numbers groups by their elevations' means, the highest first. `group`: of each direction.
Rows RowsOfGroups(RowsFrom from, const std::vector<Direction>& directions,
                  const std::vector<int>& group, int groups) {
  std::vector<double> sum_rad(static_cast<size_t>(groups), 0.0);
  std::vector<int64_t> count(static_cast<size_t>(groups), 0);
  for (size_t i = 0; i < directions.size(); ++i) {
    sum_rad[static_cast<size_t>(group[i])] += directions[i].elevation_rad;
    ++count[static_cast<size_t>(group[i])];
  }
  std::vector<int> order(static_cast<size_t>(groups));
  for (int i = 0; i < groups; ++i) {
    order[static_cast<size_t>(i)] = i;
    sum_rad[static_cast<size_t>(i)] /= static_cast<double>(count[static_cast<size_t>(i)]);
  }
  std::ranges::sort(order, [&sum_rad](int a, int b) {
    return sum_rad[static_cast<size_t>(a)] > sum_rad[static_cast<size_t>(b)];
  });
  Rows rows{from, {}, std::vector<int>(directions.size())};
  std::vector<int> row_of(static_cast<size_t>(groups));
  for (const int i : order) {
    row_of[static_cast<size_t>(i)] = static_cast<int>(rows.elevation_rad.size());
    rows.elevation_rad.push_back(sum_rad[static_cast<size_t>(i)]);
  }
  for (size_t i = 0; i < directions.size(); ++i) {
    rows.of[i] = row_of[static_cast<size_t>(group[i])];
  }
  return rows;
}

std::optional<Rows> RowsOfRings(const std::vector<Direction>& directions) {
  std::map<int32_t, int> groups;
  for (const Direction& direction : directions) {
    groups.try_emplace(direction.ring, static_cast<int>(groups.size()));
  }
  if (groups.size() > kMaxBeams) return std::nullopt;
  std::vector<int> group;
  group.reserve(directions.size());
  for (const Direction& direction : directions) group.push_back(groups.at(direction.ring));
  return RowsOfGroups(RowsFrom::kRing, directions, group, static_cast<int>(groups.size()));
}

// The rows if the elevations form groups, as for a spinning lidar: narrow ones with a step between
// them.
std::optional<Rows> RowsOfElevations(const std::vector<Direction>& directions) {
  constexpr double kLeastStep_rad = 0.05 / kDegrees;
  constexpr double kMaxWidth_rad = 0.1 / kDegrees;
  std::vector<size_t> order(directions.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, [&directions](size_t a, size_t b) {
    return directions[a].elevation_rad < directions[b].elevation_rad;
  });
  std::vector<int> group(directions.size());
  int groups = 0;
  double first_rad = 0.0;
  double last_rad = -1.0e9;
  for (const size_t i : order) {
    const double elevation_rad = directions[i].elevation_rad;
    if (elevation_rad - last_rad > kLeastStep_rad) {
      ++groups;
      first_rad = elevation_rad;
    }
    if (groups > kMaxBeams || elevation_rad - first_rad > kMaxWidth_rad) return std::nullopt;
    last_rad = elevation_rad;
    group[i] = groups - 1;
  }
  return RowsOfGroups(RowsFrom::kElevation, directions, group, groups);
}

Rows EvenRows(const std::vector<Direction>& directions) {
  const auto [low, high] =
      std::ranges::minmax(directions, {}, [](const Direction& one) { return one.elevation_rad; });
  const double step_rad = (high.elevation_rad - low.elevation_rad) / (kMaxBeams - 1);
  Rows rows;
  for (int row = 0; row < kMaxBeams; ++row) {
    rows.elevation_rad.push_back(high.elevation_rad - row * step_rad);
  }
  for (const Direction& direction : directions) {
    rows.of.push_back(
        static_cast<int>(std::lround((high.elevation_rad - direction.elevation_rad) / step_rad)));
  }
  return rows;
}

// Those of a file with rings that has a point without one are by elevation.
std::optional<Rows> RowsOf(const std::vector<Direction>& directions) {
  if (std::ranges::all_of(directions, [](const Direction& one) { return one.ring >= 0; })) {
    return RowsOfRings(directions);
  }
  const std::optional<Rows> rows = RowsOfElevations(directions);
  return rows ? rows : EvenRows(directions);
}

// The column whose direction is nearest: EncoderSinCos's angles, the other way about.
int ColumnOf(double azimuth_rad, int columns) {
  const double turns = -azimuth_rad / (2.0 * std::numbers::pi);
  const auto column = static_cast<int>(std::lround((turns - std::floor(turns)) * columns));
  return column % columns;
}

void File(const Direction& direction, int row, PointColumns& columns) {
  const int id = ColumnOf(direction.azimuth_rad, columns.model.columns_per_revolution);
  LidarColumn& column = columns.columns[static_cast<size_t>(id)];
  column.measurement_id = static_cast<uint16_t>(id);
  column.valid = true;
  column.beams = columns.model.beams;
  const auto range_mm = static_cast<uint32_t>(std::lround(direction.range_m * kMillimetres));
  uint32_t& filed_mm = column.range_mm[row];
  columns.hidden += filed_mm != 0 ? 1 : 0;
  if (filed_mm == 0 || range_mm < filed_mm) filed_mm = range_mm;
}

}  // namespace

const char* NameOf(RowsFrom rows) {
  switch (rows) {
    case RowsFrom::kRing:
      return "ring";
    case RowsFrom::kElevation:
      return "elevation";
    default:
      return "even";
  }
}

ReadOutcome MakeColumns(const std::vector<CloudPoint>& points, PointColumns& columns) {
  columns = {};
  const std::vector<Direction> directions = DirectionsOf(points);
  if (directions.empty()) return {Status::kEmpty, "no point within 500 m of the lidar"};
  const std::optional<Rows> rows = RowsOf(directions);
  if (!rows) {
    return {Status::kCapacityExceeded,
            "ring: more than " + std::to_string(kMaxBeams) + " different ones"};
  }
  std::vector<float> altitude_deg;
  for (const double elevation_rad : rows->elevation_rad) {
    altitude_deg.push_back(static_cast<float>(elevation_rad * kDegrees));
  }
  constexpr size_t kMostRowsOfManyColumns = 64;
  const int count =
      rows->elevation_rad.size() > kMostRowsOfManyColumns ? 1024 : kMaxColumnsPerRevolution;
  const std::vector<float> azimuth_deg(altitude_deg.size(), 0.0f);
  const Status status =
      MakeBeamModel(altitude_deg, azimuth_deg, count, 0.0f, Transform3{}, columns.model);
  if (!IsUsable(status)) return {status, "the points' elevations match no lidar"};
  columns.rows = rows->from;
  columns.columns.resize(static_cast<size_t>(count));
  for (size_t i = 0; i < directions.size(); ++i) {
    const auto row = static_cast<size_t>(rows->of[i]);
    const double error_rad = std::abs(directions[i].elevation_rad - rows->elevation_rad[row]);
    columns.largest_elevation_error_rad =
        std::max(columns.largest_elevation_error_rad, static_cast<float>(error_rad));
    File(directions[i], rows->of[i], columns);
  }
  return {};
}

}  // namespace hardpack::capture
