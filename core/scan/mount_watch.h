// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"

// Whether the lidar has turned in its mount, about an axis that is not upright: the ground then
// lies tilted against where it lay before (docs/safety.md, "Blindness"). It is given how far each
// return of the ground lies above what the map has at its place, fits a plane through a tenth of a
// second of them and tells a tilt that stays. It finds no ground and stops nothing. Ours.
//
// Slopes, ruts and growth are in the map as they are in the returns: they cancel. The map keeps the
// lowest that was seen, so that where the ground seems to sink nothing is left: a turn by an angle
// shows as half of it or more. A turn about the vertical does not show.

namespace hardpack {

class MountWatch {
 public:
  static constexpr uint64_t kWindow_ns = 100'000'000;
  // Beyond this tilt ...
  static constexpr float kLimit_rad = 0.03f;
  // ... for so many windows in a row, each of so many returns: turned.
  static constexpr int kWindows = 3;
  static constexpr int kLeastReturns = 60;
  // A return that is further off the map's ground is of something else.
  static constexpr float kMaxStep_m = 2.0f;

  // Nothing is known, and nothing has turned.
  void Reset();

  // A return of the ground at a place of the body frame, step_m above the map's ground there.
  void Add(Vec2 place_body, float step_m);

  // Once a tick, after its returns. Constant cost.
  void Advance(uint64_t now_ns);

  bool has_turned() const { return turned_since_ns_ != 0; }
  // Since when it shows; 0: it does not. Kept until Reset.
  uint64_t turned_since_ns() const { return turned_since_ns_; }
  // Of the last window that had enough returns.
  float tilt_rad() const { return tilt_rad_; }

 private:
  void Judge(uint64_t now_ns);

  uint64_t begun_ns_ = 0;  // of the window; 0: none yet
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
