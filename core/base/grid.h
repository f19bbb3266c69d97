// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/pose.h"

namespace hardpack {

// The planning grid: 512 x 512 square cells of 0.2 m, aligned to the odom frame ([OS] System
// Overview). A map is a window onto an unbounded plane of cells; it moves by whole cells.
inline constexpr int kMapSize_cells = 512;
inline constexpr int kMapCells = kMapSize_cells * kMapSize_cells;
inline constexpr float kCellSize_m = 0.2f;
inline constexpr float kCellsPerMeter = 5.0f;  // exact in binary, unlike its inverse
inline constexpr float kCellDiagonal_m = 0.28284271f;

// A cell of the plane: it covers [x, x+1) x [y, y+1) in units of kCellSize_m, odom frame.
struct Cell {
  int32_t x = 0;
  int32_t y = 0;
  constexpr bool operator==(const Cell&) const = default;
};

// The cell that a point lies in, to the rounding of the product: within 1e-7 of a point's own size
// of a border it may be either neighbour. Saturates; NaN gives 0: callers validate points first.
Cell CellAt(Vec2 point_odom);

// The middle of a cell, odom frame. CellAt(CellCenter(cell)) == cell within 2^22 cells (838 km) of
// the origin.
Vec2 CellCenter(Cell cell);

// Where a map lies: cells origin.x .. origin.x + 511, and the same in y. All of them must be
// int32s: a window from CenteredAt is.
struct GridWindow {
  Cell origin;

  constexpr bool Contains(Cell cell) const {
    const int64_t dx = int64_t{cell.x} - origin.x;
    const int64_t dy = int64_t{cell.y} - origin.y;
    return dx >= 0 && dx < kMapSize_cells && dy >= 0 && dy < kMapSize_cells;
  }

  // Row-major index, rows along y. Precondition: Contains(cell).
  constexpr int Index(Cell cell) const {
    HP_ASSERT(Contains(cell));
    return (cell.y - origin.y) * kMapSize_cells + (cell.x - origin.x);
  }

  // Precondition: 0 <= index < kMapCells.
  constexpr Cell FromIndex(int index) const {
    HP_ASSERT(index >= 0 && index < kMapCells);
    return {origin.x + index % kMapSize_cells, origin.y + index / kMapSize_cells};
  }

  // The cell of the window nearest to `cell` (Euclidean distance between cell centres).
  Cell Nearest(Cell cell) const;

  // The window whose middle cell (256, 256) is the one that holds point_odom.
  static GridWindow CenteredAt(Vec2 point_odom);

  constexpr bool operator==(const GridWindow&) const = default;
};

}  // namespace hardpack
