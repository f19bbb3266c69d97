// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/map_world.h"

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

using map_server::Occupancy;
using map_server::OccupancyMap;

// Removes rectangles from a map until no pixel of a kind is left: as far as possible along the row,
// then upward for as long as complete rows follow.
class Rectangles {
 public:
  explicit Rectangles(const OccupancyMap& map) : map_(map), taken_(map.pixels.size(), false) {}

  template <typename Use>
  void ForEach(Occupancy kind, Use&& use) {
    for (int row = 0; row < map_.height_px; ++row) {
      for (int column = 0; column < map_.width_px; ++column) {
        if (!IsLeft(kind, column, row)) continue;
        int end = column;
        while (end < map_.width_px && IsLeft(kind, end, row)) ++end;
        int top = row + 1;
        while (top < map_.height_px && IsRowLeft(kind, column, end, top)) ++top;
        Take(column, end, row, top);
        use(column, end, row, top);
      }
    }
  }

 private:
  size_t Index(int column, int row) const {
    return static_cast<size_t>(row) * static_cast<size_t>(map_.width_px) +
           static_cast<size_t>(column);
  }
  bool IsLeft(Occupancy kind, int column, int row) const {
    return map_.pixels[Index(column, row)] == kind && !taken_[Index(column, row)];
  }
  bool IsRowLeft(Occupancy kind, int column, int end, int row) const {
    for (int x = column; x < end; ++x) {
      if (!IsLeft(kind, x, row)) return false;
    }
    return true;
  }
  void Take(int column, int end, int row, int top) {
    for (int y = row; y < top; ++y) {
      for (int x = column; x < end; ++x) taken_[Index(x, y)] = true;
    }
  }

  const OccupancyMap& map_;
  std::vector<bool> taken_;
};

}  // namespace

World WorldOfMap(const OccupancyMap& map) {
  constexpr double kAround_m = 20.0;
  constexpr double kRoots_m = 0.5;
  World world({map.origin_x_m - kAround_m, map.origin_y_m - kAround_m,
               map.origin_x_m + map.width_m() + kAround_m,
               map.origin_y_m + map.height_m() + kAround_m});
  Rectangles rectangles(map);
  const auto add = [&](Occupancy kind, double height_m, const Material& material) {
    rectangles.ForEach(kind, [&](int column, int end, int row, int top) {
      const Point2 middle = {map.origin_x_m + (column + end) * map.resolution_m / 2.0,
                             map.origin_y_m + (row + top) * map.resolution_m / 2.0};
      world.AddBox(middle, 0.0, (end - column) * map.resolution_m, (top - row) * map.resolution_m,
                   -kRoots_m, height_m, material);
    });
  };
  add(Occupancy::kHard, 2.0, kWall);
  add(Occupancy::kSoft, 1.0, kBushLeaves);
  return world;
}

}  // namespace hardpack::world
