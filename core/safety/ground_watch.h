// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

// Whether a wheel drops while the vehicle creeps over ground that nothing has shown
// (core/speed/hidden_ground.h), from the body's pitch and roll. A wheel of radius r whose axle is x
// beyond an edge has dropped by r - sqrt(r^2 - x^2). Both front wheels tilt the body by that over
// the wheelbase: 0.04 rad on a Warthog (0.3 m, 1 m) at half a radius. One of them tilts it by half
// of that forwards and half sideways: 0.04 rad together at 0.6 of a radius. Slopes that change over
// more than 2 kWindow_m are not judged. Ours.

namespace hardpack {

class GroundWatch {
 public:
  static constexpr float kWindow_m = 0.25f;  // of way, between the tilts that are kept
  static constexpr float kDrop_rad = 0.04f;

  // The vehicle does not creep.
  void Reset() { has_marks_ = false; }

  // Once a tick while it creeps. Attitude of the body; the way driven since any fixed place, never
  // less than before. True: it has tilted by more than kDrop_rad, pitch and roll together, within
  // the last 2 kWindow_m of that way, or since the last Reset if that is less. True for what is not
  // finite. Constant cost.
  bool Judge(float pitch_rad, float roll_rad, float driven_m);

 private:
  struct Mark {
    float pitch_rad = 0.0f;
    float roll_rad = 0.0f;
    float driven_m = 0.0f;
  };
  bool has_marks_ = false;
  Mark older_;
  Mark newer_;
};
static_assert(std::is_trivially_copyable_v<GroundWatch>);

}  // namespace hardpack
