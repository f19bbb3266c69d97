// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/grid.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

// Walks a straight line through the cells of the plane: for sight lines and for ground between two
// returns (docs/algorithm.md section 1).

namespace hardpack {

// Position of a coordinate within its cell: 0 .. 1.
inline float PlaceInCell(float coordinate_m, int32_t cell) {
  return Clamp(coordinate_m * kCellsPerMeter - static_cast<float>(cell), 0.0f, 1.0f);
}

// The cells crossed by a straight line, in order, each sharing a side with the next. The line runs
// along its major axis, column by column, through one or two cells of each.
class CellWalk {
 public:
  CellWalk(Vec2 start_odom, Vec2 direction)
      : cell_(CellAt(start_odom)), along_x_(Abs(direction.x_m) >= Abs(direction.y_m)) {
    const float u = PlaceInCell(start_odom.x_m, cell_.x);
    const float v = PlaceInCell(start_odom.y_m, cell_.y);
    const float major = along_x_ ? direction.x_m : direction.y_m;
    const float minor = along_x_ ? direction.y_m : direction.x_m;
    const float ratio = major == 0.0f ? 0.0f : minor / Abs(major);
    const float place = along_x_ ? u : v;
    const float to_edge = major < 0.0f ? place : 1.0f - place;
    step_ = major < 0.0f ? -1 : 1;
    ratio_q20_ = RoundToInt(ratio * kOne_q20);
    edge_q20_ = RoundToInt(((along_x_ ? v : u) + ratio * to_edge) * kOne_q20);
  }

  Cell cell() const { return cell_; }

  // Precondition: called at most kMapSize_cells times along either axis, which keeps edge_q20_ an
  // int32.
  void Next() {
    // Branches would be mispredicted: the direction changes all the time.
    const int32_t across = (edge_q20_ >> 20) - minor_;  // -1 .. 1
    const int32_t along = across == 0 ? step_ : 0;
    edge_q20_ += across == 0 ? ratio_q20_ : 0;
    minor_ += across;
    cell_.x += along_x_ ? along : across;
    cell_.y += along_x_ ? across : along;
  }

 private:
  static constexpr float kOne_q20 = 1048576.0f;
  Cell cell_;
  bool along_x_;
  int32_t step_;       // along the major axis
  int32_t minor_ = 0;  // across it, from the first cell
  int32_t edge_q20_;   // across it, where the line exits the present column
  int32_t ratio_q20_;  // how far it goes across in one column
};

}  // namespace hardpack
