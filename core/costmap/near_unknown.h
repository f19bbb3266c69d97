// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/grid.h"
#include "core/base/pose.h"

// Where the outline would cover ground that was not observed and that lies near the lidar and near
// something hard. What is farther off is mostly seen before it is reached; but the lidar cannot see
// the ground beside it, so what is still unknown there stays so: behind the corner that the vehicle
// turns around, in the shadow of a low rock. It creeps over such ground
// (docs/decisions/0047-hidden-ground.md), while ground beside it may have been seen. Unknown ground
// with nothing hard near it is a gap, and it is the speeds that end before it: a way along a gap
// for the sake of what was observed beside it would be along a ditch. Ours.
//
//     ////////|  ?  ? /.
//     ////////|  ?  /.  .      ?  unknown, near
//       o---->  \ /.  .  .     \/ not farther from that than the vehicle's flanks from its middle
//     . . . . . . .  .  .  .   .  observed
//
// All is in whole cells: from the lidar's cell, and between cells.

namespace hardpack {

struct NearUnknownParams {
  Vec2 lidar_odom = {};
  float reach_m = 0.0f;       // from the lidar, at most kMostReach_cells count; 0: none is near
  float half_width_m = 0.0f;  // of the outline, at most kMostWidth_cells count
};

class NearUnknown {
 public:
  static constexpr int kSide_cells = 64;
  static constexpr int kMostReach_cells = 27;  // 5.4 m
  static constexpr int kMostWidth_cells = 4;
  static_assert(kMostReach_cells + kMostWidth_cells < kSide_cells / 2);

  // The lidar may be anywhere, also off the window. Precondition: finite, none negative. Cost:
  // constant.
  void Begin(const GridWindow& window, const NearUnknownParams& params);

  // Of the row's cells, Costmap::Flag and the squared distance to the nearest hard cell, saturated:
  // [kMapSize_cells] each. Every row once before the first AddCost; 0 <= row < kMapSize_cells.
  // Cost: kSide_cells.
  void Look(const uint8_t* flags, const uint8_t* hard_distance2, int row);

  // Adds cost_q8 where a row's cells are such that the outline, with its middle there, would cover
  // what is unknown and near. costs_q8: [kMapSize_cells]. Cost: kSide_cells.
  void AddCost(int row, uint16_t cost_q8, uint16_t* costs_q8) const;

 private:
  bool Covers(int row) const { return row >= first_row_ && row < first_row_ + kSide_cells; }

  int32_t first_row_ = 0;  // of the square looked at, on the window
  int32_t first_column_ = 0;
  int32_t lidar_row_ = 0;  // on the window, or beside it
  int32_t lidar_column_ = 0;
  int32_t reach2_cells2_ = -1;  // none
  int32_t rows_away_ = 0;       // so far does a width reach
  // How many cells more to either side it reaches so many rows away than one row further.
  int8_t widen_[kMostWidth_cells + 1] = {};
  uint64_t unknown_[kSide_cells] = {};  // a bit for each column, near the lidar
};
static_assert(std::is_trivially_copyable_v<NearUnknown>);

}  // namespace hardpack
