// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/costmap/costmap.h"
#include "tools/map_server/map_server.h"

namespace hardpack::map_server {
namespace {

// A measure of 1e-6 of a cell or pixel is rounding, not a touch.
constexpr double kRounding = 1.0e-6;

int FirstIndex(double position) {
  return static_cast<int>(std::floor(position + kRounding));
}
int LastIndex(double position) {
  return static_cast<int>(std::ceil(position - kRounding)) - 1;
}

int WindowOrigin(double low_m, double extent_m, float start_m) {
  const double cells_per_meter = double{kCellsPerMeter};
  const int first = FirstIndex(low_m * cells_per_meter);
  const int cells = LastIndex((low_m + extent_m) * cells_per_meter) - first + 1;
  if (cells <= kMapSize_cells) return first - (kMapSize_cells - cells) / 2;
  return CellAt({start_m, start_m}).x - kMapSize_cells / 2;
}

// The pixels of one axis that a cell touches: first .. last, of which all must be on the map.
struct PixelRange {
  int first = 0;
  int last = 0;
};

std::vector<PixelRange> RangesAlong(int first_cell, double low_m, double resolution_m) {
  const double cell_m = 1.0 / double{kCellsPerMeter};
  std::vector<PixelRange> ranges(kMapSize_cells);
  for (int i = 0; i < kMapSize_cells; ++i) {
    const double from_px = ((first_cell + i) * cell_m - low_m) / resolution_m;
    const double to_px = ((first_cell + i + 1) * cell_m - low_m) / resolution_m;
    ranges[static_cast<size_t>(i)] = {FirstIndex(from_px), LastIndex(to_px)};
  }
  return ranges;
}

Occupancy Gravest(const OccupancyMap& map, PixelRange columns, PixelRange rows) {
  Occupancy gravest = Occupancy::kFree;
  for (int row = rows.first; row <= rows.last; ++row) {
    const auto line = map.pixels.begin() + std::ptrdiff_t{row} * map.width_px;
    gravest = std::max(gravest, *std::max_element(line + columns.first, line + columns.last + 1));
  }
  return gravest;
}

uint8_t FlagsOf(Occupancy occupancy, UnknownIs unknown_is) {
  switch (occupancy) {
    case Occupancy::kFree:
      return Costmap::kObserved;
    case Occupancy::kSoft:
      return Costmap::kSoft | Costmap::kObserved;
    case Occupancy::kHard:
      return Costmap::kHard | Costmap::kObserved;
    case Occupancy::kUnknown:
      break;
  }
  if (unknown_is == UnknownIs::kFree) return 0;
  return unknown_is == UnknownIs::kSoft ? Costmap::kSoft : Costmap::kHard;
}

}  // namespace

GridWindow WindowFor(const OccupancyMap& map, Vec2 start_m) {
  return {{WindowOrigin(map.origin_x_m, map.width_m(), start_m.x_m),
           WindowOrigin(map.origin_y_m, map.height_m(), start_m.y_m)}};
}

std::vector<uint8_t> CellFlags(const OccupancyMap& map, const GridWindow& window,
                               UnknownIs unknown_is) {
  const auto columns = RangesAlong(window.origin.x, map.origin_x_m, map.resolution_m);
  const auto rows = RangesAlong(window.origin.y, map.origin_y_m, map.resolution_m);
  std::vector<uint8_t> flags;
  flags.reserve(kMapCells);
  for (const PixelRange& row : rows) {
    for (const PixelRange& column : columns) {
      const bool on_map = column.first >= 0 && row.first >= 0 && column.last < map.width_px &&
                          row.last < map.height_px;
      flags.push_back(on_map ? FlagsOf(Gravest(map, column, row), unknown_is)
                             : uint8_t{Costmap::kHard});
    }
  }
  return flags;
}

}  // namespace hardpack::map_server
