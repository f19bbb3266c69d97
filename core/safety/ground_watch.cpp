// SPDX-License-Identifier: Apache-2.0
#include "core/safety/ground_watch.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {

bool GroundWatch::Judge(float pitch_rad, float roll_rad, float driven_m) {
  const Tilt here = {pitch_rad, roll_rad};
  if (marks_ == 0) {
    marks_ = 1;
    newest_ = 0;
    newest_m_ = driven_m;
    kept_[0] = here;
  }
  // On a way that a tick leads over several marks they all are what it ends with.
  const int passed = ClampInt(FloorToInt((driven_m - newest_m_) / kApart_m), 0, kMarks + 1);
  newest_m_ = passed > kMarks ? driven_m : newest_m_ + static_cast<float>(passed) * kApart_m;
  marks_ = ClampInt(marks_ + passed, 1, kMarks + 1);
  HP_LOOP_BOUND(kMarks + 1)
  for (int k = 0; k < passed; ++k) {
    newest_ = newest_ < kMarks ? newest_ + 1 : 0;
    kept_[newest_] = here;
  }
  const int32_t next = newest_ < kMarks ? newest_ + 1 : 0;
  const Tilt& oldest = kept_[marks_ <= kMarks ? 0 : next];
  const float pitched_rad = pitch_rad - oldest.pitch_rad;
  const float rolled_rad = roll_rad - oldest.roll_rad;
  const bool is_level =
      pitched_rad * pitched_rad + rolled_rad * rolled_rad <= kDrop_rad * kDrop_rad;
  return !is_level;
}

}  // namespace hardpack
