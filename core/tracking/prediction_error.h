// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/tracking/drive_model.h"

// Recent error of the drive model: its prediction of the body's speed and yaw rate one dead time
// ahead, when no later command could change them, against the measurement at that time. It shows
// dead times, lags and slip that differ from the parameters, whatever their cause. It corrects
// nothing (DriveModel learns); users of a rolled-out motion widen their margins by it (StopWay,
// core/tracking/stop_motion.h). Ours.

namespace hardpack {

// Magnitudes.
struct MotionError {
  float speed_mps = 0.0f;
  float yaw_rate_radps = 0.0f;
};

class PredictionError {
 public:
  // The largest difference counts in full, and decays to 1/e in this time.
  static constexpr float kFade_s = 10.0f;
  static constexpr int kHistory = 64;  // in ticks; a longer dead time is compared too early

  void Reset();

  // Once a tick, after the model's step. ahead_ns: how far `predicted` lies ahead of now. Invalid
  // motion, and a tick earlier than the previous one, are skipped. Cost: at most kHistory
  // comparisons.
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
  int32_t first_ = 0;  // the oldest not due yet
  int32_t size_ = 0;
  Said said_[kHistory];
};
static_assert(std::is_trivially_copyable_v<PredictionError>);

}  // namespace hardpack
