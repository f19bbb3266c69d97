// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/perturbation.h"

#include "core/base/loop_bound.h"

namespace hardpack::perturbation {

// Lagrange's form: each point's weight is a product over the three others.
Vec2 CubicThrough(const Vec2* points, int chord, float along_m) {
  float knot_m[4] = {};
  HP_LOOP_BOUND(3)
  for (int k = 0; k < 3; ++k) {
    const float dx = points[k + 1].x_m - points[k].x_m;
    const float dy = points[k + 1].y_m - points[k].y_m;
    knot_m[k + 1] = knot_m[k] + Sqrt(dx * dx + dy * dy);
  }
  const float at_m = knot_m[chord] + along_m;
  // About points[0], so that the weights' rounding moves nothing far from the origin.
  Vec2 offset;
  HP_LOOP_BOUND(4)
  for (int k = 0; k < 4; ++k) {
    float weight = 1.0f;
    HP_LOOP_BOUND(4)
    for (int other = 0; other < 4; ++other) {
      if (other == k) continue;
      weight *= (at_m - knot_m[other]) / (knot_m[k] - knot_m[other]);
    }
    offset.x_m += weight * (points[k].x_m - points[0].x_m);
    offset.y_m += weight * (points[k].y_m - points[0].y_m);
  }
  return {points[0].x_m + offset.x_m, points[0].y_m + offset.y_m};
}

}  // namespace hardpack::perturbation
