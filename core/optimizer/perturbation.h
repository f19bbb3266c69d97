// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/math.h"
#include "core/base/pose.h"

// The geometry of perturbing and of respacing a path's points ([OS] Path Solver; docs/algorithm.md
// section 5).

namespace hardpack::perturbation {

// Quintic S-curve: 0 to 1 over t in [0, 1], first and second derivative zero at both ends, so that
// the blended curvature has no step where the blend begins and ends.
inline float SCurve(float t) {
  return t * t * t * (10.0f + t * (-15.0f + t * 6.0f));
}

// A point after `pivot` once the heading change there has grown by `turn`, blended back: weight 1
// takes the turned point, 0 the point itself.
template <typename Model>
inline Vec2 PerturbedPoint(Vec2 pivot, Vec2 point, const SinCosPair& turn, float weight) {
  const Vec2 arm = {point.x_m - pivot.x_m, point.y_m - pivot.y_m};
  const Vec2 turned = Model::Turned(arm, turn);
  return {point.x_m + weight * (turned.x_m - arm.x_m), point.y_m + weight * (turned.y_m - arm.y_m)};
}

// The point at a distance along_m after the start of chord `chord` (0, 1 or 2) on the cubic through
// four points, parametrised by the length of the chords between them. No chord may have zero
// length.
Vec2 CubicThrough(const Vec2* points, int chord, float along_m);  // points: [4]

}  // namespace hardpack::perturbation
