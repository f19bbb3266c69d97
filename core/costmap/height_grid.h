// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

namespace hardpack {

// The rolling grid of return heights ([OS] Cost Map Creation): per cell the lowest return of any
// class, the lowest and highest hard return, the highest soft return, and whether a person was
// seen. It does not age and does not decide what an obstacle is. Storage is toroidal, so rolling
// only clears what comes in. The map follows the vehicle by whole cells.
class HeightGrid {
 public:
  // Heights are centimetres in the odom frame, saturated to +-327.66 m; kNone: no such return.
  static constexpr int16_t kNone = 32767;

  struct CellHeights {
    int16_t lowest_cm = kNone;
    int16_t lowest_hard_cm = kNone;
    int16_t highest_hard_cm = kNone;
    int16_t highest_soft_cm = kNone;
    bool person = false;
  };

  // Empties the grid and centres it. kNotFinite.
  Status Reset(Vec2 center_odom);

  // Moves the window so that center_odom lies in its middle cell; cells that come in are empty.
  // kNotFinite: nothing moves. Cost: at most kMapCells cells cleared.
  Status Recenter(Vec2 center_odom);

  // Files one classed return. kIgnored returns are not filed and are kOk. kNotFinite; or
  // kInvalidArgument when the point is off the window.
  Status Insert(const Vec3& point_odom, ReturnClass return_class);

  const GridWindow& window() const { return window_; }

  // Empty for a cell off the window.
  CellHeights At(Cell cell) const;

 private:
  int Slot(Cell cell) const;
  void ClearSlot(int slot);

  GridWindow window_;
  int16_t lowest_cm_[kMapCells];
  int16_t lowest_hard_cm_[kMapCells];
  int16_t highest_hard_cm_[kMapCells];
  int16_t highest_soft_cm_[kMapCells];
  uint8_t person_[kMapCells];
};
static_assert(sizeof(HeightGrid) <= 9 * kMapCells + 64);

}  // namespace hardpack
