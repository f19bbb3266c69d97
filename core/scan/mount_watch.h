// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"

// Detects that the lidar has turned in its mount about an axis that is not vertical: the ground
// then appears tilted against the ground seen before (docs/safety.md, "Blindness"). The input is
// the height of each ground return above the map's ground at its place. The watch reports a tilt
// that persists. It does not find ground and stops nothing. Ours.
//
// Slopes, ruts and growth are in both the map and the returns, so they cancel. The map keeps the
// lowest height seen, so nothing remains where the ground seems to sink: a turn shows on the side
// that it lifts. A turn about the vertical does not show.
//
// A turn by t lifts the ground in the direction phi by the angle t cos(phi - phi_t) at every range,
// in all directions at once. Returns of bushes or banks that pass for ground are lifted by any
// angle, and in their own directions only. So the angle's median counts in each of 16 sectors, less
// the level of the sectors that were not lifted, which takes out a common change of height. Each of
// the 7 sectors within 67.5 degrees of a direction gives an estimate of the tilt toward it, and the
// second lowest counts.

namespace hardpack {

class MountWatch {
 public:
  static constexpr uint64_t kWindow_ns = 100'000'000;
  // A tilt beyond this in this many windows in a row counts as turned.
  static constexpr float kLimit_rad = 0.03f;
  static constexpr int kWindows = 3;
  // A sector with fewer returns is ignored, and so is one with less than 1 / kLeastShare of the
  // returns of the fullest sector.
  static constexpr int kLeastReturns = 6;
  static constexpr int kLeastShare = 6;
  static constexpr int kLeastSectors = 5;  // of the 7 toward a direction
  // Closer, a bush or a bank more easily passes for ground: no beam meets the ground before it.
  static constexpr float kNear_m = 5.0f;
  // A return further from the map's ground comes from something else.
  static constexpr float kMaxStep_m = 2.0f;

  // Back to the start: nothing is known, and nothing has turned.
  void Reset();

  // Adds a ground return at a place in the body frame, step_m above the map's ground there.
  void Add(Vec2 place_body, float step_m);

  // Call once per tick, after adding its returns. Constant cost.
  void Advance(uint64_t now_ns);

  bool has_turned() const { return turned_since_ns_ != 0; }
  // When the turn was first seen; 0: not turned. Kept until Reset.
  uint64_t turned_since_ns() const { return turned_since_ns_; }
  // Largest tilt of the last window that had enough sectors; not below 0.
  float tilt_rad() const { return tilt_rad_; }

 private:
  static constexpr int kSectors = 16;
  static constexpr int kBins = 32;              // of an angle; the outermost hold all larger ones
  static constexpr int kMiddleBin = kBins / 2;  // from an angle of 0 on
  static constexpr float kBin_rad = 0.0125f;

  void ClearWindow();
  static int SectorOf(Vec2 place_body);
  float MedianOf(int sector) const;
  float Level(const float* median_rad) const;
  float TiltToward(int sector, const float* median_rad, float level_rad) const;
  bool IsKnown(int sector) const { return count_[sector] >= least_returns_; }
  void Count();
  void Judge(uint64_t begun_ns);

  uint64_t begun_ns_ = 0;  // start of the window; 0: none yet
  int32_t returns_[kSectors][kBins] = {};
  int32_t count_[kSectors] = {};  // once the window has ended
  int32_t least_returns_ = 0;     // a sector with fewer is ignored in this window
  int32_t windows_ = 0;           // beyond the limit, in a row ...
  uint64_t since_ns_ = 0;         // ... since then
  float tilt_rad_ = 0.0f;
  uint64_t turned_since_ns_ = 0;
};
static_assert(std::is_trivially_copyable_v<MountWatch>);

}  // namespace hardpack
