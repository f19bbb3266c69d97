// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "core/base/status.h"

// Whether the vehicle moves as commanded, within a wide margin: detects one that runs away, turns
// against its command, does not move at all, or whose wheels slip (docs/safety.md). It does not
// measure tracking quality. Spinning wheels are detected by the INS's ground speed; without one
// they count as moving. Ours.
//
//     speed
//       |      ____ + margin            what was commanded lately: it rises at once, and falls by
//       |  ___/....\____                fall_* a second, so that drives may brake as slowly as
//       that; | /  commanded  \____           zero is always inside
//     0 +--------------------------
//       |  - margin

namespace hardpack {

enum class MotionFault : uint8_t {
  kNone,
  kRunaway,    // faster than commanded, or moving when told to stand
  kWrongTurn,  // turning against its command, or much faster
  kStuck,      // told to move, and does not
  kSpin,       // wheel speed differs from the vehicle's speed, or it stands
};

// Data of one tick. Forward and anticlockwise positive.
struct MotionSample {
  float commanded_mps = 0.0f;
  float commanded_radps = 0.0f;  // yaw rate
  bool has_wheels = false;       // fresh speeds of both
  float wheels_mps = 0.0f;       // mean of both sides
  float wheels_radps = 0.0f;     // yaw rate corresponding to their difference
  bool has_yaw_rate = false;     // a fresh one from the INS
  float yaw_rate_radps = 0.0f;
  bool has_ground = false;  // a fresh, valid ground speed from the INS
  float ground_mps = 0.0f;  // not negative: its magnitude
};

class MotionWatch {
 public:
  static constexpr float kFall_mps2 = 1.0f;  // half of what a stop is planned with
  static constexpr float kFall_radps2 = 1.0f;
  // Commands below these count as standing for kStuck, speeds below as not moving.
  static constexpr float kGoes_mps = 0.3f;
  static constexpr float kGoes_radps = 0.3f;
  static constexpr float kStill_mps = 0.05f;
  static constexpr float kStill_radps = 0.05f;

  // kParameterOutOfRange.
  Status Configure(const SafetyParams& params);

  // As if it had been standing, without a fault: while the drives have no torque, anybody may push
  // it.
  void Reset();

  // Once a tick. A fault must last for motion_time_s without a break (kStuck: stuck_time_s; kSpin:
  // spin_time_s, in a turn on the spot stuck_time_s); the first fault stays until Reset. A measured
  // number that is not finite is out of every range; such a command is zero. Constant cost.
  MotionFault Judge(const MotionSample& sample, float dt_s);

  MotionFault fault() const { return fault_; }

 private:
  // What was recently commanded.
  struct Range {
    float low = 0.0f;
    float high = 0.0f;
    void Follow(float commanded, float fall);
    bool Excludes(float measured, float margin) const;
  };
  static void Count(bool is_wrong, float dt_s, float& time_s);
  bool Slips(const MotionSample& sample) const;
  static bool SpinsOnTheSpot(const MotionSample& sample);

  SafetyParams params_;
  bool configured_ = false;
  MotionFault fault_ = MotionFault::kNone;
  Range speed_mps_;
  Range yaw_rate_radps_;
  float runaway_s_ = 0.0f;
  float wrong_turn_s_ = 0.0f;
  float stuck_s_ = 0.0f;
  float spin_s_ = 0.0f;
  float spot_spin_s_ = 0.0f;
};
static_assert(std::is_trivially_copyable_v<MotionWatch>);

}  // namespace hardpack
