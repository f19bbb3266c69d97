// SPDX-License-Identifier: Apache-2.0
#include "core/safety/tilt_watch.h"

#include "core/base/math.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

// Whether an angle, or where its change leads, is not within the limit. Not finite is not.
bool IsBeyond(float limit_rad, float now_rad, float change_rad) {
  if (limit_rad == 0.0f && IsFinite(now_rad)) return false;
  const float ahead_rad =
      now_rad + Clamp(change_rad, -TiltWatch::kMostAhead_rad, TiltWatch::kMostAhead_rad);
  return !(Abs(now_rad) <= limit_rad && Abs(ahead_rad) <= limit_rad);
}

}  // namespace

bool TiltWatch::Judge(const SafetyParams& limits, uint64_t now_ns, float roll_rad,
                      float pitch_rad) {
  const bool is_new =
      !has_base_ || now_ns < next_ns_ || !IsFinite(base_roll_rad_ + base_pitch_rad_);
  if (is_new) {
    has_base_ = true;
    base_ns_ = next_ns_ = now_ns;
    base_roll_rad_ = next_roll_rad_ = roll_rad;
    base_pitch_rad_ = next_pitch_rad_ = pitch_rad;
  }
  if (now_ns - next_ns_ >= kBase_ns) {
    base_ns_ = next_ns_;
    base_roll_rad_ = next_roll_rad_;
    base_pitch_rad_ = next_pitch_rad_;
    next_ns_ = now_ns;
    next_roll_rad_ = roll_rad;
    next_pitch_rad_ = pitch_rad;
  }
  // Over less than kBase_ns a change tells of the noise.
  const bool has_rate = now_ns - base_ns_ >= kBase_ns;
  const float share = has_rate ? kAhead_s / SecondsBetween(base_ns_, now_ns) : 0.0f;
  const bool is_beyond =
      IsBeyond(limits.max_roll_rad, roll_rad, share * (roll_rad - base_roll_rad_)) ||
      IsBeyond(limits.max_pitch_rad, pitch_rad, share * (pitch_rad - base_pitch_rad_));
  if (!is_beyond) {
    beyond_since_ns_ = 0;
    return false;
  }
  if (beyond_since_ns_ == 0) beyond_since_ns_ = now_ns;
  return now_ns - beyond_since_ns_ >= kPersist_ns;
}

}  // namespace hardpack
