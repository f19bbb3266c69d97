// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/tracking/drive_model.h"

// How far the drive model was off lately: what it said of the body's speed and yaw rate one dead
// time ahead, when no command that was given later could change them, against what was measured
// when that time had come. Dead times, lags and slips that differ from the parameters show in it,
// whatever their cause. It corrects nothing (DriveModel learns); who relies on a motion that is
// rolled out keeps away by what it says (StopWay, core/tracking/stop_motion.h). Ours.

namespace hardpack {

// Magnitudes.
struct MotionError {
  float speed_mps = 0.0f;
  float yaw_rate_radps = 0.0f;
};

class PredictionError {
 public:
  // The largest difference counts in full, and falls to 1/e of itself in this time.
  static constexpr float kFade_s = 10.0f;
  static constexpr int kHistory = 64;  // of ticks; a dead time beyond is compared too early

  void Reset();

  // Once a tick, after the model's step. ahead_ns: how far `predicted` lies ahead of now.
  // Motion that is not valid, and a tick that comes before the one before, are left out. Cost: at
  // most kHistory comparisons.
  void Advance(uint64_t now_ns, uint64_t ahead_ns, const DriveState& predicted,
               const BodyMotion& body);

  const MotionError& lately() const { return lately_; }

 private:
  struct Said {
    uint64_t of_ns = 0;
    float speed_mps = 0.0f;
    float yaw_rate_radps = 0.0f;
  };

  MotionError lately_;
  uint64_t at_ns_ = 0;
  int32_t first_ = 0;  // the oldest that is not due yet
  int32_t size_ = 0;
  Said said_[kHistory];
};
static_assert(std::is_trivially_copyable_v<PredictionError>);

}  // namespace hardpack
