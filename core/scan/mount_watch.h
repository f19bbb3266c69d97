// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"

// Detects that the lidar has turned in its mount about an axis that is not vertical: the ground
// then appears tilted against the ground seen before (docs/safety.md, "Blindness"). The input is
// the height of each ground return above the map's ground at its place. The watch fits a plane
// through a tenth of a second of returns and reports a tilt that persists. It does not find ground
// and stops nothing. Ours.
//
// Slopes, ruts and growth are in both the map and the returns, so they cancel. The map keeps the
// lowest height seen, so nothing remains where the ground seems to sink: a turn by an angle shows
// as half of it or more. A turn about the vertical does not show.

namespace hardpack {

class MountWatch {
 public:
  static constexpr uint64_t kWindow_ns = 100'000'000;
  // A tilt beyond this ...
  static constexpr float kLimit_rad = 0.03f;
  // ... in this many windows in a row, each with at least this many returns, counts as turned.
  static constexpr int kWindows = 3;
  static constexpr int kLeastReturns = 60;
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
  // Tilt of the last window that had enough returns.
  float tilt_rad() const { return tilt_rad_; }

 private:
  void Judge(uint64_t now_ns);

  uint64_t begun_ns_ = 0;  // start of the window; 0: none yet
  int32_t returns_ = 0;
  float product_[5] = {};  // of xx, xy, yy, x step, y step
  int32_t windows_ = 0;    // beyond the limit, in a row ...
  uint64_t since_ns_ = 0;  // ... since then
  Vec2 slope_;             // of the window before
  float tilt_rad_ = 0.0f;
  uint64_t turned_since_ns_ = 0;
};
static_assert(std::is_trivially_copyable_v<MountWatch>);

}  // namespace hardpack
