// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/footprint.h"
#include "core/base/grid.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/swept_pose.h"
#include "core/costmap/costmap.h"

// Whether a motion until rest (core/tracking/stop_motion.h) touches anything: the whole outline,
// its hind part that swings out in a turn included, against what is hard around the vehicle. What
// moves is checked, where the check of a plan (path_check.h) and the corridor (corridor.h) check
// the path. It does not roll motions out, and does not brake (core/safety/supervisor.h does).
//
//        ______                        Of the returns of obstacles it knows the place to 5 cm: bits
//      ./     /  .. :                  of 4 x 4 parts of each cell. A cell counts while the newest
//      map /  o  /  ....                   calls it hard, or since a return in it was filed that
//      this map
//     /_____/                          lacks; all of it where no part of it is known.
//
// What the outline overlaps where the motion begins does not hold it unless the overlap becomes
// deeper: so the vehicle can leave, and cannot come nearer bit by bit. What lies beyond the square
// is not looked at: nothing stops so late at zero speed. Ours.

namespace hardpack {

struct SweepResult {
  bool clear = true;
  float impact_mps = 0.0f;  // at the first pose that touches
};

class MotionSweep {
 public:
  static constexpr int kSide_cells = 64;  // of the square that is remembered: 12.8 m
  static constexpr int kParts = 8;        // of a cell, along each axis
  static constexpr float kPart_m = kCellSize_m / kParts;
  // Cells with something in them that are looked at from one Advance to the next. Beyond, whatever
  // is asked for touches: so many near the outline are one obstacle or another.
  static constexpr int kMaxTests = 8192;
  static constexpr int kMaxReach_cells = 31;  // of an outline's corner from its origin, and margin
  static constexpr int kMaxPoses = 64;
  static constexpr float kDeeper_m = 0.0005f;  // rounding
  // The margin grows from this share of it at rest to all of it at kFullMarginSpeed_mps.
  static constexpr float kLeastMarginShare = 0.1f;
  static constexpr float kFullMarginSpeed_mps = 1.5f;
  static constexpr float kMaxOff_m = 0.4f;  // of what a pose may be off by, beyond the margin

  // With nothing remembered. An outline that reaches further than kMaxReach_cells touches always.
  void Configure(const Footprint& footprint, float margin_m);
  void Reset();

  // Once a tick, before the returns of it are filed: the square follows the vehicle. One that is
  // not finite changes nothing. Cost: the rows and columns that come in, as a rule none or one.
  void Advance(Vec2 vehicle_odom);

  // A return of an obstacle. One that is not finite or not in the square is forgotten. Constant
  // cost.
  void File(Vec2 point_odom);

  // A map is begun: what is filed from now on may not be in it.
  void MapBegun();
  // It is done: its hard cells take the place of those of the map before, and of what was filed
  // before it was begun. Cost: kSide_cells^2 cells.
  void MapDone(const Costmap& map);

  // motion: poses from the present one on, finite, at most kMaxPoses; each with the margin and what
  // it may be off by. Cost: for each the rows of cells that its outline spans; of cells with
  // something in them, kMaxTests in a tick.
  SweepResult Try(std::span<const SweptPose> motion);

  const Footprint& footprint() const { return footprint_; }
  // Whether something hard is known in a cell. For tests and pictures.
  bool IsHard(Cell cell) const;

 private:
  struct Frame {  // an outline's place
    Vec2 origin;
    float cos = 1.0f;
    float sin = 0.0f;
    float along_m = 0.0f;  // margins
    float aside_m = 0.0f;
    int32_t reach_cells = 0;  // of the longest vehicles not all of the margins
  };
  // How deep a point lies between the outline's ends and between its flanks; negative outside.
  struct Depth {
    float along_m = 0.0f;
    float aside_m = 0.0f;
    // In the outline made longer and wider by so much at each end and flank.
    float Within(float ends_m, float flanks_m) const {
      return Min(along_m + ends_m, aside_m + flanks_m);
    }
  };

  bool IsInside(Cell cell) const;
  void ClearRow(int32_t y);
  void ClearColumn(int32_t x);
  uint64_t Occupied(int row) const { return mapped_[row] | waiting_[row] | fresh_[row]; }
  uint64_t BitsOf(int32_t y, int32_t x, int32_t columns) const;
  void TakeRow(const Costmap& map, int32_t y);
  Frame FrameOf(const SweptPose& swept) const;
  Depth DepthOf(const Frame& frame, Vec2 point_odom) const;
  bool TouchesAt(const Frame& frame, const Frame& start);
  bool TouchesCell(Cell cell, const Frame& frame, const Frame& start) const;

  Footprint footprint_;
  float margin_m_ = 0.0f;
  int32_t reach_cells_ = 0;
  bool has_vehicle_ = false;
  Cell low_;  // the square's first cell
  int32_t tests_left_ = kMaxTests;
  // A bit a cell, each at its own place modulo the square's side.
  uint64_t mapped_[kSide_cells] = {};   // hard in the newest map
  uint64_t waiting_[kSide_cells] = {};  // filed since that was begun, before the next was
  uint64_t fresh_[kSide_cells] = {};    // filed since the next one was begun
  uint64_t parts_[kSide_cells * kSide_cells] = {};
};
static_assert(std::is_trivially_copyable_v<MotionSweep>);
static_assert(sizeof(MotionSweep) <= 40 * 1024);

}  // namespace hardpack
