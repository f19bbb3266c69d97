// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/decision_hash.h"
#include "core/costmap/costmap.h"
#include "core/costmap/height_grid.h"

namespace hardpack::decision {

inline void AddCostmap(const Costmap& map, DecisionHash& hash) {
  hash.AddI32(map.window.origin.x);
  hash.AddI32(map.window.origin.y);
  for (int index = 0; index < kMapCells; ++index) {
    hash.AddU32(map.cost_q8[index]);
    hash.AddU8(map.flags[index]);
    hash.AddU8(map.hard_distance2[index]);
    hash.AddU8(map.hard_depth2[index]);
  }
}

// Of the cells that were seen.
inline void AddHeights(const HeightGrid& heights, DecisionHash& hash) {
  for (int index = 0; index < kMapCells; ++index) {
    const HeightGrid::CellHeights cell = heights.At(heights.window().FromIndex(index));
    if (cell.lowest_cm == HeightGrid::kNone) continue;
    hash.AddI32(index);
    hash.AddI32(cell.lowest_cm);
    hash.AddI32(cell.lowest_hard_cm);
    hash.AddI32(cell.highest_hard_cm);
    hash.AddI32(cell.highest_soft_cm);
    hash.AddU8(cell.ground);
    hash.AddU8(cell.person);
  }
}

}  // namespace hardpack::decision
