// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/ground_guess.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/grid.h"

namespace hardpack::capture {
namespace {

constexpr int kHalfWindow_cells = 7;  // of CostmapParams::ground_window_cells' default
constexpr float kNothing = std::numeric_limits<float>::infinity();

// Lowest of the cells at most kHalfWindow_cells away along one direction; `stride` is the distance
// of neighbours in the array.
std::vector<float> LowestAlong(const std::vector<float>& heights_m, int stride) {
  std::vector<float> lowest_m(heights_m.size(), kNothing);
  for (int index = 0; index < kMapCells; ++index) {
    const int place = index / stride % kMapSize_cells;
    const int first = std::max(-place, -kHalfWindow_cells);
    const int last = std::min(kMapSize_cells - 1 - place, kHalfWindow_cells);
    float& lowest = lowest_m[static_cast<size_t>(index)];
    for (int k = first; k <= last; ++k) {
      lowest = std::min(lowest, heights_m[static_cast<size_t>(index + k * stride)]);
    }
  }
  return lowest_m;
}

}  // namespace

void GuessGround(const Vec3& vehicle_odom, std::vector<ClassedPoint>& points) {
  const GridWindow window = GridWindow::CenteredAt({vehicle_odom.x_m, vehicle_odom.y_m});
  std::vector<float> lowest_m(kMapCells, kNothing);
  for (const ClassedPoint& point : points) {
    const Cell cell = CellAt({point.point_odom.x_m, point.point_odom.y_m});
    if (!window.Contains(cell)) continue;
    float& lowest = lowest_m[static_cast<size_t>(window.Index(cell))];
    lowest = std::min(lowest, point.point_odom.z_m);
  }
  lowest_m = LowestAlong(LowestAlong(lowest_m, 1), kMapSize_cells);

  for (ClassedPoint& point : points) {
    const Vec3& p = point.point_odom;
    point.return_class = ReturnClass::kHard;
    const Cell cell = CellAt({p.x_m, p.y_m});
    if (!window.Contains(cell)) continue;
    const float distance_m = std::hypot(p.x_m - vehicle_odom.x_m, p.y_m - vehicle_odom.y_m);
    const bool low = p.z_m - lowest_m[static_cast<size_t>(window.Index(cell))] <= kGroundHeight_m;
    const bool under_cone = p.z_m - vehicle_odom.z_m <= kConeHeight_m + kConeSlope * distance_m;
    if (low && under_cone) point.return_class = ReturnClass::kGround;
  }
}

}  // namespace hardpack::capture
