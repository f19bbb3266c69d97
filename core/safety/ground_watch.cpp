// SPDX-License-Identifier: Apache-2.0
#include "core/safety/ground_watch.h"

namespace hardpack {

bool GroundWatch::Judge(float pitch_rad, float roll_rad, float driven_m) {
  const Mark here = {pitch_rad, roll_rad, driven_m};
  if (marks_ == 0) {
    marks_ = 1;
    newest_ = 0;
    kept_[0] = here;
  } else if (driven_m >= kept_[newest_].driven_m + kApart_m) {
    const float due_m = kept_[newest_].driven_m + kApart_m;
    newest_ = newest_ < kMarks ? newest_ + 1 : 0;
    kept_[newest_] = here;
    // As if it had been just there, unless a tick is longer than that.
    if (here.driven_m - due_m < kApart_m) kept_[newest_].driven_m = due_m;
    marks_ = marks_ <= kMarks ? marks_ + 1 : marks_;
  }
  const int32_t next = newest_ < kMarks ? newest_ + 1 : 0;
  const Mark& oldest = kept_[marks_ <= kMarks ? 0 : next];
  const float pitched_rad = pitch_rad - oldest.pitch_rad;
  const float rolled_rad = roll_rad - oldest.roll_rad;
  const bool is_level =
      pitched_rad * pitched_rad + rolled_rad * rolled_rad <= kDrop_rad * kDrop_rad;
  return !is_level;
}

}  // namespace hardpack
