// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/fixed_vector.h"
#include "core/base/swept_pose.h"
#include "core/tracking/drive_model.h"
#include "core/tracking/prediction_error.h"

// Where the vehicle goes until it is at rest, if the stop begins with the next command: from its
// actual state (measured wheel speeds and yaw rate), through the commands under way and their lags,
// by the drive model. It judges nothing (core/safety/motion_sweep.h does). Ours.
//
//   now           dead time, one tick more      brakes                       at rest
//   o----------------------------------------->o-------------------------->o
//     commands as told                            kAlong: ramp, the path's curvature; kZero: zero

namespace hardpack {

enum class StopKind : uint8_t {
  kAlong,  // the reference goes down by the plan's deceleration, the turn is the path's
  kZero,   // zero speed for both sides
};

// What a stop along the path needs to know of it.
struct StopWay {
  static constexpr int kCurvatures = 32;
  static constexpr float kStep_m = 0.4f;
  float reference_mps = 0.0f;               // that the vehicle has been told to have by now
  float deceleration_mps2 = 0.0f;           // of the reference; positive
  float curvature_per_m[kCurvatures] = {};  // from the vehicle's place on, each kStep_m
  MotionError error;                        // of such predictions lately
};

inline constexpr int kMaxSweptPoses = 48;
using SweptMotion = FixedVector<SweptPose, kMaxSweptPoses>;

// The first pose is the present one, the last that of rest (or that after kLongestStop_s). Poses
// between lie apart by a share of the way, or by what turns the outline's corners by as much. Each
// may be off by what way.error grows to until then, for 0.5 s at most.
// pose: odom, finite. Cost: at most DriveModel::kMaxDeadSteps + kMaxStopSteps steps of the model.
inline constexpr float kStopStep_s = 0.04f;
inline constexpr int kMaxStopSteps = 100;
void RollOutStop(const DriveModel& model, const Pose2& pose, const StopWay& way, StopKind kind,
                 SweptMotion& motion);

}  // namespace hardpack
