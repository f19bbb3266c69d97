// SPDX-License-Identifier: Apache-2.0
#include "core/safety/motion_watch.h"

#include "core/base/math.h"
#include "core/base/validate.h"

namespace hardpack {

Status MotionWatch::Configure(const SafetyParams& params) {
  *this = MotionWatch{};
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  params_ = params;
  configured_ = true;
  return Status::kOk;
}

void MotionWatch::Reset() {
  fault_ = MotionFault::kNone;
  speed_mps_ = Range{};
  yaw_rate_radps_ = Range{};
  runaway_s_ = 0.0f;
  wrong_turn_s_ = 0.0f;
  stuck_s_ = 0.0f;
  spin_s_ = 0.0f;
  spot_spin_s_ = 0.0f;
}

// Commands that are not finite are zero: the gate sends that instead.
void MotionWatch::Range::Follow(float commanded, float fall) {
  const float told = IsFinite(commanded) ? commanded : 0.0f;
  high = Max(Max(told, 0.0f), high - fall);
  low = Min(Min(told, 0.0f), low + fall);
}

bool MotionWatch::Range::Excludes(float measured, float margin) const {
  return !(measured <= high + margin && measured >= low - margin);
}

void MotionWatch::Count(bool is_wrong, float dt_s, float& time_s) {
  time_s = is_wrong ? time_s + dt_s : 0.0f;
}

// Either way: wheels that spin in place, and wheels that stand while the vehicle slides.
bool MotionWatch::Slips(const MotionSample& sample) const {
  if (!sample.has_wheels || !sample.has_ground) return false;
  const float wheels_mps = Abs(sample.wheels_mps);
  const float margin_mps =
      params_.spin_speed_margin_mps + params_.spin_share * Max(wheels_mps, sample.ground_mps);
  return !(Abs(wheels_mps - sample.ground_mps) <= margin_mps);
}

bool MotionWatch::SpinsOnTheSpot(const MotionSample& sample) {
  return sample.has_wheels && sample.has_yaw_rate && Abs(sample.wheels_mps) < kGoes_mps &&
         Abs(sample.wheels_radps) >= kGoes_radps && Abs(sample.yaw_rate_radps) <= kStill_radps;
}

MotionFault MotionWatch::Judge(const MotionSample& sample, float dt_s) {
  if (!configured_ || fault_ != MotionFault::kNone) return fault_;
  if (!IsFinite(dt_s) || dt_s <= 0.0f) return fault_;
  speed_mps_.Follow(sample.commanded_mps, kFall_mps2 * dt_s);
  yaw_rate_radps_.Follow(sample.commanded_radps, kFall_radps2 * dt_s);
  const bool runs =
      sample.has_wheels && speed_mps_.Excludes(sample.wheels_mps, params_.motion_speed_margin_mps);
  const float margin_radps = params_.motion_yaw_margin_radps;
  const bool turns =
      sample.has_yaw_rate && yaw_rate_radps_.Excludes(sample.yaw_rate_radps, margin_radps);
  const bool is_told =
      Abs(sample.commanded_mps) >= kGoes_mps || Abs(sample.commanded_radps) >= kGoes_radps;
  const bool stands = sample.has_wheels && Abs(sample.wheels_mps) <= kStill_mps &&
                      Abs(sample.wheels_radps) <= kStill_radps;
  Count(runs, dt_s, runaway_s_);
  Count(turns, dt_s, wrong_turn_s_);
  Count(is_told && stands, dt_s, stuck_s_);
  Count(Slips(sample), dt_s, spin_s_);
  Count(SpinsOnTheSpot(sample), dt_s, spot_spin_s_);
  if (spin_s_ >= params_.spin_time_s || spot_spin_s_ >= params_.stuck_time_s) {
    fault_ = MotionFault::kSpin;
  }
  if (stuck_s_ >= params_.stuck_time_s) fault_ = MotionFault::kStuck;
  if (wrong_turn_s_ >= params_.motion_time_s) fault_ = MotionFault::kWrongTurn;
  if (runaway_s_ >= params_.motion_time_s) fault_ = MotionFault::kRunaway;
  return fault_;
}

}  // namespace hardpack
