// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"

// Whether a wheel drops while the vehicle creeps over ground that nothing has shown
// (core/speed/hidden_ground.h), from the body's pitch and roll. A wheel of radius r whose axle is x
// beyond the edge of a hole has dropped by r - sqrt(r^2 - x^2), which grows the faster the farther
// it is; one that rolls down a slope behind an edge, by x tan alpha. Both front wheels tilt the
// body by that over the wheelbase. So what is judged is the tilt over a short way: for a Warthog
// (0.3 m, 1 m) kDrop_rad in kWindow_m is a hole at half a radius, and a slope of 19 degrees. One
// wheel tilts it by half of that forwards and half sideways: it is told at 0.6 of a radius. Ours.

namespace hardpack {

class GroundWatch {
 public:
  static constexpr float kWindow_m = 0.08f;  // of way, at least, with kApart_m more at most
  static constexpr float kDrop_rad = 0.034f;

  // The vehicle does not creep.
  void Reset() { marks_ = 0; }

  // Once a tick while it creeps. Attitude of the body; the way driven since any fixed place, never
  // less than before. True: it has tilted by more than kDrop_rad, pitch and roll together, as seen
  // from the ground (one that turns on a slope does not tilt), within the last kWindow_m of that
  // way, or since the last Reset if that is less. True for what is not finite. Constant cost.
  bool Judge(float pitch_rad, float roll_rad, float yaw_rad, float driven_m);

 private:
  static constexpr int32_t kMarks = 16;
  static constexpr float kApart_m = kWindow_m / static_cast<float>(kMarks);
  int32_t marks_ = 0;  // since the last Reset; the last kMarks + 1 are kept
  int32_t newest_ = 0;
  float newest_m_ = 0.0f;
  Vec2 kept_[kMarks + 1];  // the rise along x and y [rad], kApart_m from one to the next
};
static_assert(std::is_trivially_copyable_v<GroundWatch>);

}  // namespace hardpack
