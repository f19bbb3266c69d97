// SPDX-License-Identifier: Apache-2.0
#include "core/base/pose.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {

Transform3 TransformFromPose(const Pose2& pose, float z_m) {
  return TransformFromRollPitchYaw(0.0f, 0.0f, pose.theta_rad, {pose.x_m, pose.y_m, z_m});
}

Transform3 TransformFromRollPitchYaw(float roll_rad, float pitch_rad, float yaw_rad,
                                     const Vec3& translation) {
  const SinCosPair r = SinCos(roll_rad);
  const SinCosPair p = SinCos(pitch_rad);
  const SinCosPair y = SinCos(yaw_rad);
  return {{y.cos * p.cos, y.cos * p.sin * r.sin - y.sin * r.cos,
           y.cos * p.sin * r.cos + y.sin * r.sin,  //
           y.sin * p.cos, y.sin * p.sin * r.sin + y.cos * r.cos,
           y.sin * p.sin * r.cos - y.cos * r.sin,  //
           -p.sin, p.cos * r.sin, p.cos * r.cos},
          translation};
}

Transform3 operator*(const Transform3& a, const Transform3& b) {
  Transform3 product;
  HP_LOOP_BOUND(3)
  for (int row = 0; row < 3; ++row) {
    HP_LOOP_BOUND(3)
    for (int column = 0; column < 3; ++column) {
      product.rotation[3 * row + column] = a.rotation[3 * row] * b.rotation[column] +
                                           a.rotation[3 * row + 1] * b.rotation[3 + column] +
                                           a.rotation[3 * row + 2] * b.rotation[6 + column];
    }
  }
  product.translation = a.Apply(b.translation);
  return product;
}

}  // namespace hardpack
