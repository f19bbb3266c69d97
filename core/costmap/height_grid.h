// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

namespace hardpack {

// The rolling grid of return heights ([OS] Cost Map Creation; docs/algorithm.md section 1): per
// cell the lowest return of any class, the lowest and highest hard return, the highest soft return,
// and whether ground and whether a person was seen. It does not age and does not decide what an
// obstacle is. Storage is toroidal, so rolling only clears what comes in. The map follows the
// vehicle by whole cells.
class HeightGrid {
 public:
  // Heights are centimetres in the odom frame, rounded to the nearest and saturated to
  // +-327.66 m; kNone: no such return.
  static constexpr int16_t kNone = 32767;

  struct CellHeights {
    int16_t lowest_cm = kNone;
    int16_t lowest_hard_cm = kNone;
    int16_t highest_hard_cm = kNone;
    int16_t highest_soft_cm = kNone;
    bool ground = false;  // a return classed as ground was seen
    bool person = false;
  };

  // Cells side by side along x, as arrays, so that loops over them vectorise.
  static constexpr int kStripCells = 32;
  struct Strip {
    int16_t lowest_cm[kStripCells];
    int16_t lowest_hard_cm[kStripCells];
    int16_t highest_hard_cm[kStripCells];
    int16_t highest_soft_cm[kStripCells];
    uint8_t ground[kStripCells];  // 0 or 1
    uint8_t person[kStripCells];  // 0 or 1
  };

  // Empty, centred at the odom frame's origin. Cost: kMapCells cells cleared.
  HeightGrid();

  // Empties the grid and centres it. kNotFinite: nothing changes. Cost: kMapCells cells cleared.
  Status Reset(Vec2 center_odom);

  // Moves the window so that center_odom lies in its middle cell; cells that come in are empty.
  // kNotFinite: nothing moves. Cost: the cells that come in, at most kMapCells, cleared.
  Status Recenter(Vec2 center_odom);

  // Files one classed return. kIgnored returns are not filed and are kOk. kNotFinite; or
  // kInvalidArgument when the point is off the window or the class is none of ReturnClass: nothing
  // is filed. Cost: constant.
  Status Insert(const Vec3& point_odom, ReturnClass return_class);

  const GridWindow& window() const { return window_; }

  // Empty for a cell off the window. Cost: constant.
  CellHeights At(Cell cell) const;

  // The cells first.x .. first.x + kStripCells - 1 of row first.y, each as At gives it.
  // Precondition: first.x <= INT32_MAX - kStripCells. Cost: constant.
  void Read(Cell first, Strip& strip) const;

 private:
  static constexpr uint8_t kGroundSeen = 1;
  static constexpr uint8_t kPersonSeen = 2;

  // The storage place of a cell of the plane; the cells of one window all have different ones.
  static constexpr int Slot(Cell cell) {
    constexpr uint32_t kMask = kMapSize_cells - 1;
    return static_cast<int>((static_cast<uint32_t>(cell.y) & kMask) * kMapSize_cells +
                            (static_cast<uint32_t>(cell.x) & kMask));
  }

  // Empties width x height cells, their lowest corner at offset (dx, dy) from the window's origin.
  void Clear(int dx, int dy, int width, int height);

  GridWindow window_;
  int16_t lowest_cm_[kMapCells];
  int16_t lowest_hard_cm_[kMapCells];
  int16_t highest_hard_cm_[kMapCells];
  int16_t highest_soft_cm_[kMapCells];
  uint8_t seen_[kMapCells];  // kGroundSeen, kPersonSeen
};
static_assert((kMapSize_cells & (kMapSize_cells - 1)) == 0);
static_assert(sizeof(HeightGrid) <= 9 * kMapCells + 64);
static_assert(std::is_trivially_copyable_v<HeightGrid>);

}  // namespace hardpack
