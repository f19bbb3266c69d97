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
// including its rear that swings out in a turn, against hard cells and returns around the vehicle.
// This checks the actual motion, while the check of a plan (path_check.h) and the corridor
// (corridor.h) check the path. It does not roll motions out, and does not brake
// (core/safety/supervisor.h does).
//
//        ______                The position of obstacle returns is known to 2.5 cm: bits of
//      ./     /  .. :          8 x 8 parts of each cell. A cell counts while the newest map
//      /  o  /  ....           calls it hard, or since a return was filed in it that this map
//     /_____/                  lacks; all of it if no part is known.
//
// What the outline overlaps where the motion begins does not hold the vehicle unless the overlap
// becomes deeper: so it can leave, and cannot creep closer step by step. Anything beyond the square
// is ignored: no immediate stop is that long. Ours.

namespace hardpack {

struct SweepResult {
  bool clear = true;
  float impact_mps = 0.0f;  // at the first pose that touches
};

class MotionSweep {
 public:
  static constexpr int kSide_cells = 64;  // of the remembered square: 12.8 m
  static constexpr int kParts = 8;        // of a cell, along each axis
  static constexpr float kPart_m = kCellSize_m / kParts;
  // Most occupied cells tested from one Advance to the next. Beyond that, every motion counts as
  // touching: with so many near the outline, one will be an obstacle.
  static constexpr int kMaxTests = 8192;
  static constexpr int kMaxReach_cells = 31;  // of an outline's corner from its origin, plus margin
  static constexpr int kMaxPoses = 64;
  static constexpr float kDeeper_m = 0.0005f;  // rounding
  // The margin grows from this share of it at rest to all of it at kFullMarginSpeed_mps.
  static constexpr float kLeastMarginShare = 0.1f;
  static constexpr float kFullMarginSpeed_mps = 1.5f;
  static constexpr float kMaxOff_m = 0.4f;  // of a pose's error, beyond the margin

  // Nothing remembered. An outline that reaches farther than kMaxReach_cells always touches.
  void Configure(const Footprint& footprint, float margin_m);
  void Reset();

  // Once a tick, before its returns are filed: the square follows the vehicle. A position that is
  // not finite changes nothing. Cost: the rows and columns that come in, usually none or one.
  void Advance(Vec2 vehicle_odom);

  // An obstacle return. One that is not finite or not in the square is ignored. Constant cost.
  void File(Vec2 point_odom);

  // A map is begun: returns filed from now on may not be in it.
  void MapBegun();
  // It is done: its hard cells replace those of the previous map, and the returns filed before it
  // was begun. Cost: kSide_cells^2 cells.
  void MapDone(const Costmap& map);

  // motion: poses from the present one on, finite, at most kMaxPoses; each with the margin and its
  // possible error. Cost: for each, the rows of cells that its outline spans; of occupied cells,
  // kMaxTests per tick.
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
    int32_t reach_cells = 0;  // for the longest vehicles without all of the margins
  };
  // How deep a point lies between the outline's ends and between its flanks; negative outside.
  struct Depth {
    float along_m = 0.0f;
    float aside_m = 0.0f;
    // Depth in the outline extended by this much at each end and flank.
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
  // One bit per cell, each at its own index modulo the square's side.
  uint64_t mapped_[kSide_cells] = {};   // hard in the newest map
  uint64_t waiting_[kSide_cells] = {};  // filed since that map was begun, before the next was
  uint64_t fresh_[kSide_cells] = {};    // filed since the next one was begun
  uint64_t parts_[kSide_cells * kSide_cells] = {};
};
static_assert(std::is_trivially_copyable_v<MotionSweep>);
static_assert(sizeof(MotionSweep) <= 40 * 1024);

}  // namespace hardpack
