// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "config/parameters.h"
#include "core/base/fixed_vector.h"
#include "core/base/math.h"
#include "core/base/status.h"
#include "core/path/path.h"

// Speeds along a path ([OS] Speed Control; docs/algorithm.md section 6): a limit per point, then a
// backward pass for the deceleration and a forward pass for the acceleration. It uses neither the
// map nor the clock: limits from the surroundings come in as caps. Parameters are assumed valid
// (config/parameter_tables.h): the owner of the chain checks them.

namespace hardpack {

using SpeedProfile = FixedVector<float, kMaxPathPoints>;  // [n] m/s, never negative

// Requests above this are refused, which keeps every squared speed far from the limit of float32.
inline constexpr float kMaxRequestSpeed_mps = 100.0f;

// The limit at one point from the path's shape alone [m/s]: the least of the paper's
//   v_min + (v_max - v_min) (1 - min(|kappa| / gamma, 1))
// and of sqrt(a_lat / |kappa|), yaw rate / |kappa|,
//   share * w_max r / (1 + |kappa| B / 2), sqrt(rate / |kappa'|).
float CurvatureSpeedLimit(const SpeedParams& params, const VehicleParams& vehicle,
                          float curvature_per_m, float curvature_rate_per_m2);

// Distance from the newest return's stamp to standstill [m], from speed_mps >= 0: reaction time t_r
// and dead time t_d at full speed, then a commanded ramp of deceleration a, which the drives follow
// with a first-order lag tau. The lag adds exactly tau v for any command, because tau v' =
// v_command - v integrates to tau (0 - v):
//   s = v (t_r + t_d + tau) + v^2 / (2 a)
float StoppingDistance(const SpeedParams& params, float speed_mps);

// The corresponding time [s]: t_r + t_d + tau + v / a, at which the lag leaves at most a tau / e of
// speed, 0.4 m/s.
float StoppingTime(const SpeedParams& params, float speed_mps);

// The largest speed, up to max_speed_mps, from which StoppingDistance fits into free_m: its
// closed-form inverse, lowered by 2^-20 of itself so that rounding never puts it above (tested). 0
// if free_m is below a micrometre or NaN.
float ReactionSpeedCap(const SpeedParams& params, float free_m);

// Time to pass somebody, from the newest return's stamp: to drive way_m and to reach min_speed_mps,
// since a person walking beside a slower vehicle stays beside it [s]. For a vehicle that drives at
// speed_mps now and accelerates to min_speed_mps as fast as it can, with s the share of
// min_speed_mps that it lacks,
//   t = t_r + max(way / v_min + s (t_d + tau) + s^2 v_min / (2 a_max),
//                 s (t_d + tau + v_min / a_max)),
// the first exact if it reaches that speed within the distance, otherwise an upper bound. For a
// vehicle that does so, or is faster, the remaining time falls as fast as time passes.
float PassingTime(const SpeedParams& params, float way_m, float speed_mps);

// The cap for one person: along_m ahead of the vehicle's centre along the path, lateral_m beside
// the corridor that the vehicle covers (0 or less: inside it), for a vehicle that drives at
// speed_mps now. With a margin of person_margin_m everywhere, v_p = person_speed_mps and T(v) the
// StoppingTime, there is no cap (max_speed_mps) if the vehicle's tail is past the person, or will
// be by PassingTime before the person can be in the corridor; otherwise it is the largest v from
// which the vehicle stands before they meet, whether the person walks towards the corridor or
// towards the vehicle:
//   v_p T(v) <= lateral   or   StoppingDistance(v) + v_p T(v) <= along - length / 2.
// To creep, at person_creep_mps at most, it is enough that StoppingDistance(v) fits. If the person
// stays farther away than the distance walked while the vehicle reacts and brakes from its speed,
// or from person_creep_mps if that is more,
//   lateral > v_p (t_r + max(v, v_creep) / a),
// the cap is at least person_creep_mps: otherwise a person standing beside the path would block it
// forever. Once a vehicle has begun to pass, the answer does not turn against it beside the person.
// reverse: the path is driven in reverse there, so the rear goes first.
// Source: docs/algorithm.md section 6 (ours).
float PersonSpeedCap(const SpeedParams& params, const VehicleParams& vehicle, float along_m,
                     float lateral_m, float speed_mps, bool reverse = false);

struct SpeedRequest {
  float start_speed_mps = 0.0f;        // magnitude, along the first step
  float start_curvature_per_m = 0.0f;  // reference for the first change of curvature
  float goal_speed_mps = 0.0f;         // 0 at a goal; nonzero at a waypoint to be passed
  int32_t slow_points = 0;             // first points driven at obstacle_start_speed_mps at most
  std::span<const float> cap_mps;      // [n] outer caps (reaction, people), or empty
};

// Speeds for every point. Steps may be forward, reverse or without length (turns on the spot): both
// ends of a turn on the spot, and a change of direction, have speed 0. Point 0 has the start speed,
// even if that exceeds the limits: the profile then brakes at max_deceleration_mps2 until it is
// within them. If the path ends first, the last speed says how fast; at a turn on the spot or a
// change of direction it is still 0, because neither can be driven through. kPathTooShort: no
// steps; kNotFinite; kInvalidArgument: negative or above kMaxRequestSpeed_mps, negative
// slow_points, or cap_mps of another length or negative. On failure `speed` is empty. Cost: at most
// eleven passes over at most kMaxPathPoints points, two of them from point to point.
Status PlanSpeed(const SpeedParams& params, const VehicleParams& vehicle, const ActuatorPath& path,
                 const SpeedRequest& request, SpeedProfile& speed);

}  // namespace hardpack
