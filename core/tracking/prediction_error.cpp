// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/prediction_error.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"

namespace hardpack {

// Not by a fresh object: without optimisation that is more stack than a function may take.
void PredictionError::Reset() {
  lately_ = MotionError{};
  at_ns_ = 0;
  first_ = 0;
  size_ = 0;
}

void PredictionError::Advance(uint64_t now_ns, uint64_t ahead_ns, const DriveState& predicted,
                              const BodyMotion& body) {
  if (now_ns <= at_ns_) return;
  const float since_s = at_ns_ == 0 ? 0.0f : Min(SecondsBetween(at_ns_, now_ns), kFade_s);
  at_ns_ = now_ns;
  const float kept = 1.0f - since_s / kFade_s;
  lately_ = {lately_.speed_mps * kept, lately_.yaw_rate_radps * kept};
  Said said;
  bool is_due = false;
  HP_LOOP_BOUND(kHistory)
  while (size_ > 0 && said_[first_].of_ns <= now_ns) {
    said = said_[first_];
    is_due = true;
    first_ = (first_ + 1) % kHistory;
    --size_;
  }
  if (is_due && body.valid) {
    lately_.speed_mps = Max(lately_.speed_mps, Abs(body.speed_mps - said.speed_mps));
    lately_.yaw_rate_radps =
        Max(lately_.yaw_rate_radps, Abs(body.yaw_rate_radps - said.yaw_rate_radps));
  }
  if (size_ == kHistory) {  // the oldest is overwritten
    first_ = (first_ + 1) % kHistory;
    --size_;
  }
  said_[(first_ + size_) % kHistory] = {now_ns + ahead_ns, predicted.speed_mps,
                                        predicted.yaw_rate_radps};
  ++size_;
}

}  // namespace hardpack
