// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "config/parameters.h"
#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "core/path/path.h"

// Speeds along a path ([OS] Speed Control; docs/algorithm.md section 6): a limit a point, then a
// backward pass for the deceleration and a forward pass for the acceleration.

namespace hardpack {

using SpeedProfile = FixedVector<float, kMaxPathPoints>;  // [n] m/s, never negative

// The limit at one point from the path's shape alone [m/s]: the least of the paper's
//   v_min + (v_max - v_min) (1 - min(|kappa| / gamma, 1))
// and of sqrt(a_lat / |kappa|), yaw rate / |kappa|,
//   share * w_max r / (1 + |kappa| B / 2), sqrt(rate / |kappa'|).
float CurvatureSpeedLimit(const SpeedParams& params, const VehicleParams& vehicle,
                          float curvature_per_m, float curvature_rate_per_m2);

// Way from the newest return's stamp to standstill [m], from speed_mps: reaction time and dead time
// at full speed, then braking at max_deceleration_mps2 behind a first-order lag.
float StoppingDistance(const SpeedParams& params, float speed_mps);

// The largest speed from which StoppingDistance fits into free_m: 0 when free_m <= 0. The inverse
// of StoppingDistance, never above it (tested).
float ReactionSpeedCap(const SpeedParams& params, float free_m);

// The cap near one person: `along_m` ahead on the path, `lateral_m` beside the corridor. No cap
// (max_speed_mps) when the person, walking at person_speed_mps, cannot reach the corridor before
// the vehicle has passed; else the speed from which it can stop first.
float PersonSpeedCap(const SpeedParams& params, float along_m, float lateral_m);

struct SpeedRequest {
  float start_speed_mps = 0.0f;
  float start_curvature_per_m = 0.0f;
  float goal_speed_mps = 0.0f;     // 0 at a goal; a waypoint that is passed has its own
  int32_t slow_points = 0;         // first points driven at obstacle_start_speed_mps at most
  bool narrow = false;             // the whole path at min_speed_mps at most
  std::span<const float> cap_mps;  // [n] outer caps (reaction, people), or empty
};

// Speeds for every point. Steps may be forward, reverse or pivots: a pivot and a change of
// direction have speed 0. Point 0 has the start speed, even where that is above the limits: the
// profile then brakes at the limit as soon as it can. kPathTooShort; kNotFinite; kInvalidArgument:
// negative speeds, or cap_mps of another length. Cost: three passes over at most kMaxPathPoints
// points.
Status PlanSpeed(const SpeedParams& params, const VehicleParams& vehicle, const ActuatorPath& path,
                 const SpeedRequest& request, SpeedProfile& speed);

}  // namespace hardpack
