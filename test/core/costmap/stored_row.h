// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "core/costmap/height_grid.h"

namespace hardpack {

// One row of a grid as it is read at once, told cell by cell.
class StoredRow {
 public:
  StoredRow(const HeightGrid& grid, Cell first) : datum_cm_(grid.datum_cm()) {
    grid.ReadGround(first, lowest_cm_, seen_);
    grid.ReadObstacles(first, lowest_hard_cm_, highest_hard_cm_, highest_soft_cm_);
  }

  // The cell first.x + x.
  HeightGrid::CellHeights At(int x) const {
    const auto i = static_cast<size_t>(x);
    const bool known = (seen_[i] & HeightGrid::kGroundHeightKnown) != 0;
    const bool beside = (seen_[i] & HeightGrid::kGroundFromBeside) != 0;
    return {Told(lowest_cm_[i]),
            Told(lowest_hard_cm_[i]),
            Told(highest_hard_cm_[i]),
            Told(highest_soft_cm_[i]),
            known,
            (seen_[i] & HeightGrid::kPersonMask) != 0,
            known || beside,
            known && beside};
  }

 private:
  template <typename T>
  using Row = std::array<T, kMapSize_cells>;

  int16_t Told(int16_t stored_cm) const {
    const bool none = stored_cm == HeightGrid::kNone;
    return static_cast<int16_t>(none ? stored_cm : stored_cm + datum_cm_);
  }

  int32_t datum_cm_;
  Row<int16_t> lowest_cm_ = {};
  Row<uint8_t> seen_ = {};
  Row<int16_t> lowest_hard_cm_ = {};
  Row<int16_t> highest_hard_cm_ = {};
  Row<int16_t> highest_soft_cm_ = {};
};

}  // namespace hardpack
