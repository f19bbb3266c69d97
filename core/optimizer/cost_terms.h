// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/costmap/costmap.h"

// One function for each term of F ([OS] Cost Function Formulation; docs/algorithm.md section 4),
// and the walk along a path that adds them up point by point. CostOf and the optimizer's windows
// both use this walk, so a window's cost matches the whole path's cost bit for bit.

namespace hardpack::cost_terms {

// A chord shorter than this has no meaningful direction: no curvature is computed there.
inline constexpr float kShortestChord_m = 1.0e-4f;

// f(u; alpha, beta, u_max): a limit as a steep slope, not a wall.
inline float BoundedTerm(float value, float alpha, float beta, float max) {
  const float size = Abs(value);
  return size < max ? alpha * size : alpha * max + beta * (size - max);
}

inline float MapTerm(const Costmap& map, Vec2 point_odom, float ds_m) {
  return ds_m * map.CostAt(point_odom.x_m, point_odom.y_m);
}

inline float CurvatureTerm(const OptimizerParams& params, float curvature_per_m, float ds_m) {
  return ds_m * BoundedTerm(curvature_per_m, params.curvature_alpha, params.curvature_beta,
                            params.max_curvature_per_m);
}

inline float CurvatureRateTerm(const OptimizerParams& params, float rate_per_m2, float ds_m) {
  return ds_m * BoundedTerm(rate_per_m2, params.curvature_rate_alpha, params.curvature_rate_beta,
                            params.max_curvature_rate_per_m2);
}

// The state of the walk along a path: before a point.
struct Walk {
  Vec2 chord;                    // the one that ends at the point; (0, 0) at the path's start
  float length_m = 0.0f;         // of that chord
  float curvature_per_m = 0.0f;  // at the point before; the vehicle's own at the path's start
};

// The share of one point in F.
struct PointCost {
  float map = 0.0f;
  float path = 0.0f;
};

// The costs at an inner point; advances the walk to the next. ds is the mean length of the two
// chords that meet.
template <typename Model>
inline PointCost WalkPoint(const Costmap& map, const OptimizerParams& params, Vec2 point_odom,
                           Vec2 next_odom, Walk& walk) {
  const Vec2 next_chord = Minus(next_odom, point_odom);
  const float next_length_m = Length(next_chord);
  const float ds_m = 0.5f * (walk.length_m + next_length_m);
  PointCost cost;
  cost.map = MapTerm(map, point_odom, ds_m);
  float curvature_per_m = 0.0f;
  if (ds_m >= kShortestChord_m) {
    curvature_per_m = Model::TurnBetween(walk.chord, next_chord) / ds_m;
    const float rate_per_m2 = (curvature_per_m - walk.curvature_per_m) / ds_m;
    cost.path =
        CurvatureTerm(params, curvature_per_m, ds_m) + CurvatureRateTerm(params, rate_per_m2, ds_m);
  }
  walk = {next_chord, next_length_m, curvature_per_m};
  return cost;
}

// The same at a path's first point: no chord before it, so no turn, and half a chord of map.
inline PointCost WalkFirstPoint(const Costmap& map, Vec2 point_odom, Vec2 next_odom,
                                float start_curvature_per_m, Walk& walk) {
  const Vec2 next_chord = Minus(next_odom, point_odom);
  const float next_length_m = Length(next_chord);
  walk = {next_chord, next_length_m, start_curvature_per_m};
  return {MapTerm(map, point_odom, 0.5f * next_length_m), 0.0f};
}

// And at its last.
inline PointCost WalkLastPoint(const Costmap& map, Vec2 point_odom, const Walk& walk) {
  return {MapTerm(map, point_odom, 0.5f * walk.length_m), 0.0f};
}

}  // namespace hardpack::cost_terms
