// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/costmap/terrain.h"
#include "core/path/path.h"

// What the ground ahead leaves of braking, cornering and speed. On a way down of angle alpha, and
// across a slope of angle beta, tyres of friction mu hold at most
//   a = g (mu cos alpha - sin alpha),   a_lateral = g (mu cos beta - sin beta),
// and over ground whose slope along the way changes by `bend` a metre, a body that follows it has
// the vertical acceleration a_vertical = v^2 bend.
//
// On a way up friction leaves as much for speeding up as it does for braking on the same way down.
//
//        o====o                     fall: tan alpha, of the way ahead, over kSmooth_m; rise: up
//      /  a ->  \ __/\__/\_        bank: tan beta, of the same;   bend: over kBend_m
//
// One value of each holds for a whole plan: the steepest of what is ahead of the vehicle on it, so
// that whoever plans, brakes or judges a stop on it counts with the same. No slope makes anything
// better than on level ground. Ours.

namespace hardpack {

// Of the friction that is configured this much is relied on.
inline constexpr float kSureFriction = 0.8f;

struct GroundAhead {
  static constexpr float kFar_m = 1.0e3f;
  // The length over which a change of the ground is spread: braking takes several metres, and a
  // seam of 5 cm in the map, as around ground that was assumed at the start, is no slope. And the
  // least length of which it is said that it is too steep.
  static constexpr float kSmooth_m = 4.0f;
  static constexpr float kSure_m = 3.0f;
  // A slope is known of a metre of ground (core/costmap/terrain.h), and its change twice smoothed
  // over this: it tells 0.45 of the bend of waves 3 m long, and 0.8 of those of 6 m.
  static constexpr float kBend_m = 0.4f;
  // A vehicle that creeps down stops with this. Where less is left, on a slope that is measured as
  // too steep by kDoubt even so, it cannot be said to stop.
  static constexpr float kLeastBraking_mps2 = 0.05f;
  static constexpr float kDoubt = 0.03f;

  float fall = 0.0f;  // the steepest way down, m/m; not below 0
  float rise = 0.0f;  // the steepest way up, m/m; not below 0
  float bank = 0.0f;  // the steepest slope across the way, m/m; not below 0
  float bend = 0.0f;  // the most by which the slope along the way changes, 1/m; not below 0
  // Along the path, to where it is too steep to stop: what lies behind counts for none of the
  // above.
  float too_steep_m = kFar_m;
};

// Of a path's chords, whichever way the vehicle heads on them, as far as the ground is told; where
// it is not, it goes on as before. Cost: one pass.
GroundAhead LookAtGround(const Terrain& terrain, const GridWindow& window,
                         const SpeedParams& params, const WorldPath& path);

// The parameters with what the ground leaves of max_deceleration_mps2, max_acceleration_mps2 and
// max_lateral_acceleration_mps2, and with the largest speed from which the vehicle stands within
// the distance that it needs on level ground from max_speed_mps, and at which its body has no more
// than max_vertical_acceleration_mps2: who looks no farther ahead than that distance need not look
// farther on a slope. On level ground, with enough friction, they are the same numbers. Constant
// cost.
SpeedParams OnGround(const SpeedParams& params, const GroundAhead& ground);

}  // namespace hardpack
