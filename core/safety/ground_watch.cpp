// SPDX-License-Identifier: Apache-2.0
#include "core/safety/ground_watch.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {

bool GroundWatch::Judge(float pitch_rad, float roll_rad, float yaw_rad, float driven_m) {
  // It rises forward by -pitch, and to its left by roll.
  const SinCosPair yaw = SinCos(yaw_rad);
  const Vec2 here = {-yaw.cos * pitch_rad - yaw.sin * roll_rad,
                     -yaw.sin * pitch_rad + yaw.cos * roll_rad};
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
  const Vec2& oldest = kept_[marks_ <= kMarks ? 0 : next];
  const bool is_level =
      Squared(here.x_m - oldest.x_m) + Squared(here.y_m - oldest.y_m) <= Squared(kDrop_rad);
  return !is_level;
}

}  // namespace hardpack
