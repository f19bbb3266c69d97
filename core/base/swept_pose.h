// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/pose.h"

// A pose of a predicted motion, and the speed there: core/tracking/stop_motion.h rolls it out, and
// core/safety/motion_sweep.h tests it against returns.

namespace hardpack {

struct SweptPose {
  Pose2 pose;  // odom
  float speed_mps = 0.0f;
  // Possible error of the pose.
  float along_m = 0.0f;
  float aside_m = 0.0f;
};

}  // namespace hardpack
