// SPDX-License-Identifier: Apache-2.0
#include "core/base/grid.h"

#include "core/base/saturate.h"

namespace hardpack {
namespace {

int32_t Within(int32_t cell, int32_t origin) {
  const int64_t offset = int64_t{cell} - origin;
  if (offset < 0) return origin;
  if (offset >= kMapSize_cells) return origin + (kMapSize_cells - 1);
  return cell;
}

// Saturated so that the far edge of a window is still an int32.
int32_t OriginFor(int32_t middle) {
  return ClampInt(middle, INT32_MIN + kMapSize_cells, INT32_MAX - kMapSize_cells) -
         kMapSize_cells / 2;
}

}  // namespace

Vec2 CellCenter(Cell cell) {
  return {(static_cast<float>(cell.x) + 0.5f) / kCellsPerMeter,
          (static_cast<float>(cell.y) + 0.5f) / kCellsPerMeter};
}

Cell GridWindow::Nearest(Cell cell) const {
  return {Within(cell.x, origin.x), Within(cell.y, origin.y)};
}

GridWindow GridWindow::CenteredAt(Vec2 point_odom) {
  const Cell middle = CellAt(point_odom);
  return {{OriginFor(middle.x), OriginFor(middle.y)}};
}

}  // namespace hardpack
