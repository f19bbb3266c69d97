// SPDX-License-Identifier: Apache-2.0
#include "core/safety/ground_watch.h"

namespace hardpack {

bool GroundWatch::Judge(float pitch_rad, float roll_rad, float driven_m) {
  const Mark here = {pitch_rad, roll_rad, driven_m};
  if (!has_marks_) {
    has_marks_ = true;
    older_ = here;
    newer_ = here;
  } else if (driven_m - newer_.driven_m >= kWindow_m) {
    older_ = newer_;
    newer_ = here;
  }
  const float pitched_rad = pitch_rad - older_.pitch_rad;
  const float rolled_rad = roll_rad - older_.roll_rad;
  const bool is_level =
      pitched_rad * pitched_rad + rolled_rad * rolled_rad <= kDrop_rad * kDrop_rad;
  return !is_level;
}

}  // namespace hardpack
