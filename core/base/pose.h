// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/math.h"

// Plane and space geometry. Frames (docs/frames.md): `odom` is the local odometry frame of REP-105,
// x and y level, z up; `body` is the vehicle: x forward, y left, z up, origin on the ground below
// the axle's centre (core/base/footprint.h); `sensor` is a device's own frame. Angles are
// anticlockwise from +x.

namespace hardpack {

struct Vec2 {
  float x_m = 0.0f;
  float y_m = 0.0f;
};

struct Vec3 {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float z_m = 0.0f;
};

struct Pose2 {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float theta_rad = 0.0f;  // (-pi, pi]
};

constexpr bool IsFinite(Vec2 v) {
  return IsFinite(v.x_m) && IsFinite(v.y_m);
}
constexpr bool IsFinite(const Vec3& v) {
  return IsFinite(v.x_m) && IsFinite(v.y_m) && IsFinite(v.z_m);
}
constexpr bool IsFinite(const Pose2& pose) {
  return IsFinite(pose.x_m) && IsFinite(pose.y_m) && IsFinite(pose.theta_rad);
}

constexpr Vec2 PlaceOf(const Pose2& pose) {
  return {pose.x_m, pose.y_m};
}
constexpr Vec2 Minus(Vec2 a, Vec2 b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m};
}
inline float Length(Vec2 v) {
  return Sqrt(v.x_m * v.x_m + v.y_m * v.y_m);
}
// False for what is not finite.
constexpr bool AreWithin(Vec2 a, Vec2 b, float distance_m) {
  const Vec2 arm = Minus(a, b);
  return arm.x_m * arm.x_m + arm.y_m * arm.y_m <= distance_m * distance_m;
}

// Maps a point of frame `from` to frame `to`: p_to = R p_from + t.
struct Transform3 {
  float rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // [3 x 3], row-major, orthonormal
  Vec3 translation;                                 // [m]

  constexpr Vec3 Apply(const Vec3& p) const {
    return {rotation[0] * p.x_m + rotation[1] * p.y_m + rotation[2] * p.z_m + translation.x_m,
            rotation[3] * p.x_m + rotation[4] * p.y_m + rotation[5] * p.z_m + translation.y_m,
            rotation[6] * p.x_m + rotation[7] * p.y_m + rotation[8] * p.z_m + translation.z_m};
  }
};

// The transform body -> odom of a vehicle at `pose` on level ground of height z_m.
Transform3 TransformFromPose(const Pose2& pose, float z_m);

// From roll, pitch, yaw (rotation = Rz(yaw) Ry(pitch) Rx(roll)) and a translation.
Transform3 TransformFromRollPitchYaw(float roll_rad, float pitch_rad, float yaw_rad,
                                     const Vec3& translation);

// (a * b).Apply(p) == a.Apply(b.Apply(p)) to rounding.
Transform3 operator*(const Transform3& a, const Transform3& b);

}  // namespace hardpack
