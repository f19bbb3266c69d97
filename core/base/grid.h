// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/assert.h"
#include "core/base/pose.h"
#include "core/base/saturate.h"

namespace hardpack {

// The planning grid: 512 x 512 square cells of 0.2 m, aligned to the odom frame ([OS] System
// Overview). A map is a window onto an unbounded plane of cells; it moves by whole cells.
inline constexpr int kMapSize_cells = 512;
inline constexpr int kRowWords = kMapSize_cells / 32;  // of 32 bits: one for each cell of a row
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

// The cell that contains a point, up to the rounding of the product: a point closer to a border
// than 1e-7 of its own size may fall into either neighbour. Saturates. NaN gives 0: callers
// validate points first. Inline: every return goes through it, and more than once.
inline Cell CellAt(Vec2 point_odom) {
  return {FloorToInt(point_odom.x_m * kCellsPerMeter), FloorToInt(point_odom.y_m * kCellsPerMeter)};
}

// The centre of a cell, odom frame. CellAt(CellCenter(cell)) == cell within 2^22 cells (838 km) of
// the origin.
Vec2 CellCenter(Cell cell);

// The position of a map: cells origin.x .. origin.x + 511, and the same in y. All of them must be
// int32s; a window from CenteredAt satisfies this.
struct GridWindow {
  Cell origin;

  // Modulo 2^32, an offset is less than the window's size only if it really is, because all cells
  // are int32s.
  constexpr bool Contains(Cell cell) const {
    const uint32_t dx = static_cast<uint32_t>(cell.x) - static_cast<uint32_t>(origin.x);
    const uint32_t dy = static_cast<uint32_t>(cell.y) - static_cast<uint32_t>(origin.y);
    return dx < kMapSize_cells && dy < kMapSize_cells;
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

  // The window whose middle cell (256, 256) contains point_odom.
  static GridWindow CenteredAt(Vec2 point_odom);

  constexpr bool operator==(const GridWindow&) const = default;
};

}  // namespace hardpack
