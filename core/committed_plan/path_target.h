// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/onboard_parameters.h"
#include "core/base/status.h"
#include "core/committed_plan/committed_plan.h"
#include "core/tracking/tracking.h"

// What the committed plan says to the tracker at a place: where the path is, how it bends, how fast
// it is to be driven there and how far it is to where the vehicle has to stand. It does not find
// the place (Project, core/committed_plan/committed_plan.h) and commands nothing. The paper has no
// part in it; docs/algorithm.md section 7.

namespace hardpack {

// Where the vehicle will be, as Tracker::predicted() and the replanner know it.
struct PathFollower {
  Pose2 pose;                  // odom, when this tick's command takes effect
  PathPlace place;             // of that pose on the plan's path
  float speed_mps = 0.0f;      // that it has been told to have: the lookahead of pure pursuit
  float turn_ahead_m = 0.0f;   // Tracker::TurnAhead_m()
  float wheel_ahead_m = 0.0f;  // Tracker::WheelAhead_m()
  bool stands = false;         // a turn on the spot may be made
};

// A path whose poses look against their chords is driven in reverse (core/path/path.h says so of
// every pose). A path is driven one way: where it changes its direction between two turns on the
// spot, what lies behind the change is not looked at, and the vehicle comes to rest there.
// At rest a speed is taken kStartWay_m ahead: the place itself says 0 for ever. Within kAtPoint_m
// of a turn on the spot the input is that turn, once the vehicle stands; before, it rolls out
// straight on, since the path looks elsewhere behind the turn. kPathTooShort: no path of
// two points, or the place is not on it; then `target` has speed 0. Cost: some passes over the
// path.
inline constexpr float kStartWay_m = 0.08f;
Status PathTarget(const CommittedPlan& plan, const PathFollower& follower,
                  const TrackingParams& params, TrackingInput& target);

}  // namespace hardpack
