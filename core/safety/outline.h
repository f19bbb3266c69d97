// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/footprint.h"
#include "core/base/pose.h"
#include "core/costmap/costmap.h"

// The vehicle's outline on the map: the rectangle itself against the squares of the hard cells, to
// rounding. The whole cell is hard. It knows nothing of paths; core/safety/path_check.h does.

namespace hardpack {

// The rectangle, in cells, relative to the low corner of the map's first cell.
struct Outline {
  // The largest that the parameters allow (config/parameter_tables.h): 6 m long, 4 m wide.
  static constexpr float kMaxLength_m = 6.0f;
  static constexpr float kMaxWidth_m = 4.0f;
  // Its half diagonal is 18.1 cells. Everything within 2 m of it lies in this many columns and rows
  // at most ...
  static constexpr int kMaxSpan_cells = 60;
  // ... and everything within 0.6 m in this many.
  static constexpr int kMaxNearSpan_cells = 46;

  Vec2 middle;  // of the rectangle, not the axle [cells, despite the type]
  float cos = 1.0f;
  float sin = 0.0f;
  float half_length_cells = 0.0f;
  float half_width_cells = 0.0f;
  // Half the extent of the rectangle along the map's axes, and of a cell along the body's.
  float half_x_cells = 0.0f;
  float half_y_cells = 0.0f;
  float half_cell_cells = 0.0f;
};

// pose: of the body frame, odom; finite.
Outline OutlineAt(const GridWindow& window, const Footprint& footprint, const Pose2& pose);

// A cell relative to the outline, along the four axes that can separate two rectangles (separating
// axes): negative if they overlap along one.
struct CellApart {
  float along_cells = 0.0f;  // ahead of the front or behind the rear
  float aside_cells = 0.0f;  // beside a flank
  // The largest of the four. Above 0, the two are at least this far apart; otherwise they overlap,
  // and this is how far either would have to be moved, negative.
  float least_cells = 0.0f;
};

// x, y: the cell's column and row of the map.
CellApart ApartFrom(const Outline& outline, int32_t x, int32_t y);

// Squared distance from the outline to a cell's square [cells^2]; 0 where they overlap or touch.
float Distance2To(const Outline& outline, int32_t x, int32_t y);

// Lowers nearest2_cells2 to the squared distance from the outline to the nearest square of a hard
// cell, if that is closer. Precondition: nearest2_cells2 is at most that of 2 m. Cost: at most
// kMaxSpan_cells rows, in each the cells from the outline's middle to either side up to the first
// hard one.
void LowerToNearestHard(const Costmap& map, const Outline& outline, float& nearest2_cells2);

// A lower bound on the distance from the outline to every hard square, from the map's own distances
// at the centres of the discs that cover it [cells]; negative if they do not give one. Cost: one
// cell per disc.
float NearestHardAtLeast(const Costmap& map, const Footprint& footprint, const Pose2& pose);

// Whether every hard cell's square is at least margin_m from the outline; with 0, whether it
// overlaps and touches none. Precondition: 0 <= margin_m <= 2. Cost: that of LowerToNearestHard.
bool IsClear(const Costmap& map, const Footprint& footprint, const Pose2& pose, float margin_m);

}  // namespace hardpack
