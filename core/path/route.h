// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/path/path.h"

// The way to a goal by places that are passed on it, without a stop (ours; docs/algorithm.md
// section 3, "Waypoints that are passed"). A leg leads from one of these places to the next.
//
//   start ---- leg 0 ---- via 0 ---- leg 1 ---- via 1 ---- leg 2 ---- goal

namespace hardpack {

inline constexpr int kMaxVias = 7;

// Beyond the radius in which a path passes a place, the vehicle may be so far from it and still
// have passed it: the tracking error.
inline constexpr float kPassSlack_m = 0.5f;

struct Via {
  Vec2 position_odom;
  float speed_mps = 0.0f;  // limit on the leg that leads here; 0: none
};

struct Route {
  FixedVector<Via, kMaxVias> vias;  // in order
  float goal_speed_mps = 0.0f;      // limit on the leg that leads to the goal; 0: none
};
static_assert(std::is_trivially_copyable_v<Route>);

// kNotFinite; kInvalidArgument: a negative limit, or one above kMaxLegSpeed_mps. Otherwise kOk.
inline constexpr float kMaxLegSpeed_mps = 100.0f;
Status CheckRoute(const Route& route);

// The same without its first `passed` vias.
Route RouteBehind(const Route& route, int passed);

// Where a path passes a place: of the first points from `from` on that are within reach_m of it,
// one behind the other, the nearest; -1: none is. Cost: one pass.
int PassingPoint(const WorldPath& path, int from, Vec2 place_odom, float reach_m);

// How many vias of the route are passed in order by the path, up to its point `point` inclusive.
// Cost: one pass over the points for each via.
int ViasPassed(const WorldPath& path, const Route& route, float reach_m, int point);

// Whether a corner can be passed within radius_m on an arc of max_curvature_per_m: the arc that
// touches both legs of a corner of angle a cuts it by (1 / cos(a / 2) - 1) / kappa, so
//   cos(a / 2) >= 1 / (1 + kappa radius).
// `before` and `behind`: the legs' directions, any length; false if one has none. Constant cost.
bool IsGentle(Vec2 before, Vec2 behind, float max_curvature_per_m, float radius_m);

}  // namespace hardpack
