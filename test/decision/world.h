// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/base/pose.h"
#include "core/measurements/measurements.h"

// A world of few solids on level ground (z = 0), and rays through it. Odom frame.

namespace hardpack::decision {

struct Box {
  Vec3 low;
  Vec3 high;
  ReturnClass what = ReturnClass::kHard;
};

// Upright, standing on the ground, without a lid.
struct Cylinder {
  Vec2 center;
  float radius_m = 0.0f;
  float height_m = 0.0f;
  ReturnClass what = ReturnClass::kHard;
};

struct World {
  std::span<const Box> boxes;
  std::span<const Cylinder> cylinders;
};

struct Ray {
  Vec3 origin;
  Vec3 direction;  // of length one
};

struct Hit {
  float distance_m = 0.0f;  // kFarAway_m: nothing is hit
  ReturnClass what = ReturnClass::kIgnored;
};

inline constexpr float kFarAway_m = 90.0f;

// What the ray meets first.
Hit Cast(const World& world, const Ray& ray);

}  // namespace hardpack::decision
