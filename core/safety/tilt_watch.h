// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"

// Whether the body leans so far, or is about to, that the vehicle must not drive on: its roll
// against safety.max_roll_rad and its pitch against safety.max_pitch_rad. A vehicle slides where
// the tangent of either exceeds the friction, and rolls over where that of its roll exceeds track /
// (2 height of its mass) (docs/safety.md). What it will be in kAhead_s is told by how it has
// changed over the last kBase_ns, kMostAhead_rad at most: where a ramp begins it changes fast.
// Beyond the limits for kPersist_ns counts: a wheel that hits a stone is over it by then. Ours.

namespace hardpack {

class TiltWatch {
 public:
  static constexpr float kAhead_s = 0.3f;
  static constexpr float kMostAhead_rad = 0.1f;
  static constexpr uint64_t kBase_ns = 100'000'000;
  static constexpr uint64_t kPersist_ns = 50'000'000;

  // Once a tick: the body's attitude now. True: it leans too far. True for what is not finite; a
  // limit of 0 is none. Constant cost.
  bool Judge(const SafetyParams& limits, uint64_t now_ns, float roll_rad, float pitch_rad);

 private:
  bool has_base_ = false;
  uint64_t base_ns_ = 0;  // of the older attitude, and when it is to be replaced
  uint64_t next_ns_ = 0;
  float base_roll_rad_ = 0.0f;
  float base_pitch_rad_ = 0.0f;
  float next_roll_rad_ = 0.0f;
  float next_pitch_rad_ = 0.0f;
  uint64_t beyond_since_ns_ = 0;  // 0: within the limits
};
static_assert(std::is_trivially_copyable_v<TiltWatch>);

}  // namespace hardpack
