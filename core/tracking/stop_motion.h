// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/fixed_vector.h"
#include "core/base/swept_pose.h"
#include "core/tracking/drive_model.h"
#include "core/tracking/prediction_error.h"

// The vehicle's motion until rest, if the stop begins with the next command: from its actual state
// (measured wheel speeds and yaw rate), through the commands in flight and their lags, by the drive
// model. It does not evaluate the motion (core/safety/motion_sweep.h does). Ours.
//
//   now           dead time, one tick more      brakes                       at rest
//   o----------------------------------------->o-------------------------->o
//     commands as told                            kAlong: ramp, the path's curvature; kZero: zero
//
// At zero the turn of a skid-steered vehicle dies out with its own lag. Steered wheels hold their
// angle while the vehicle brakes (docs/twist_drive.md), so it goes on along its curve: w = kappa v.

namespace hardpack {

enum class StopKind : uint8_t {
  kAlong,  // the reference falls with the plan's deceleration, the turn is the path's
  kZero,   // zero speed at once
};

// What a stop along the path needs to know about it.
struct StopWay {
  static constexpr int kCurvatures = 32;
  static constexpr float kStep_m = 0.4f;
  float reference_mps = 0.0f;               // commanded by now; in reverse: negative
  float deceleration_mps2 = 0.0f;           // of the reference; positive
  float curvature_per_m[kCurvatures] = {};  // from the vehicle's place on, every kStep_m
  float held_curvature_per_m = 0.0f;        // of steered wheels: the largest; 0: skid-steered
  MotionError error;                        // of recent predictions
};

inline constexpr int kMaxSweptPoses = 48;
using SweptMotion = FixedVector<SweptPose, kMaxSweptPoses>;

// The first pose is the present one, the last that at rest (or after kLongestStop_s). The poses
// between are spaced by a share of the distance, or by a turn that moves the outline's corners by
// as much. Each has a possible error of what way.error accumulates until then, for 0.5 s at most.
// pose: odom, finite. Cost: at most DriveModel::kMaxDeadSteps + kMaxStopSteps steps of the model.
inline constexpr float kStopStep_s = 0.04f;
inline constexpr int kMaxStopSteps = 100;
void RollOutStop(const DriveModel& model, const Pose2& pose, const StopWay& way, StopKind kind,
                 SweptMotion& motion);

}  // namespace hardpack
