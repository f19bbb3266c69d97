// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/onboard_parameters.h"
#include "core/base/status.h"
#include "core/committed_plan/committed_plan.h"
#include "core/tracking/tracking.h"

// What the committed plan specifies for the tracker at a place: the path, its curvature, its speed
// there and the distance to the next stop. It does not find the place (Project,
// core/committed_plan/committed_plan.h) and commands nothing. Not part of the paper;
// docs/algorithm.md section 7.

namespace hardpack {

// The predicted vehicle, as Tracker::predicted() and the replanner know it.
struct PathFollower {
  Pose2 pose;                  // odom, when this tick's command takes effect
  PathPlace place;             // of that pose on the plan's path
  float speed_mps = 0.0f;      // commanded: for the lookahead of pure pursuit
  float turn_ahead_m = 0.0f;   // Tracker::TurnAhead_m()
  float wheel_ahead_m = 0.0f;  // Tracker::WheelAhead_m()
  bool stands = false;         // may turn on the spot
};

// A path whose poses point against its chords is driven in reverse (core/path/path.h says so for
// every pose). A path is driven in one direction: if it changes direction between two turns on the
// spot, the part beyond the change is ignored, and the vehicle comes to rest there. At rest, the
// speed is taken kStartWay_m ahead, because the speed at the place itself would stay 0 forever.
// Within kAtPoint_m of a turn on the spot the input is that turn, once the vehicle stands; before
// that, it coasts straight ahead, because beyond the turn the path points elsewhere. kPathTooShort:
// no path of two points, or the place is not on it; `target` then has speed 0. Cost: a few passes
// over the path.
inline constexpr float kStartWay_m = 0.08f;
Status PathTarget(const CommittedPlan& plan, const PathFollower& follower,
                  const TrackingParams& params, TrackingInput& target);

}  // namespace hardpack
