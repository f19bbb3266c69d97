// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/pose.h"

// A pose of a motion that is looked ahead at, and how fast the vehicle is there: what
// core/tracking/stop_motion.h rolls out and core/safety/motion_sweep.h holds against returns.

namespace hardpack {

struct SweptPose {
  Pose2 pose;  // odom
  float speed_mps = 0.0f;
  // That it may be off by.
  float along_m = 0.0f;
  float aside_m = 0.0f;
};

}  // namespace hardpack
