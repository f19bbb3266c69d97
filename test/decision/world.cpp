// SPDX-License-Identifier: Apache-2.0
#include "test/decision/world.h"

#include "core/base/math.h"

namespace hardpack::decision {
namespace {

// Where a ray is inside something: from `begin` to `end` along it; empty when begin > end.
struct Stretch {
  float begin_m = 0.0f;
  float end_m = kFarAway_m;
};

// Cuts the stretch to where origin + t * direction lies in [low, high], one axis.
void CutToSlab(float origin, float direction, float low, float high, Stretch& stretch) {
  if (Abs(direction) < 1.0e-6f) {
    if (origin < low || origin > high) stretch.end_m = -1.0f;
    return;
  }
  const float a = (low - origin) / direction;
  const float b = (high - origin) / direction;
  stretch.begin_m = Max(stretch.begin_m, Min(a, b));
  stretch.end_m = Min(stretch.end_m, Max(a, b));
}

float DistanceTo(const Box& box, const Ray& ray) {
  Stretch stretch;
  CutToSlab(ray.origin.x_m, ray.direction.x_m, box.low.x_m, box.high.x_m, stretch);
  CutToSlab(ray.origin.y_m, ray.direction.y_m, box.low.y_m, box.high.y_m, stretch);
  CutToSlab(ray.origin.z_m, ray.direction.z_m, box.low.z_m, box.high.z_m, stretch);
  return stretch.begin_m <= stretch.end_m ? stretch.begin_m : kFarAway_m;
}

float DistanceTo(const Cylinder& cylinder, const Ray& ray) {
  const float dx = ray.direction.x_m;
  const float dy = ray.direction.y_m;
  const float ox = ray.origin.x_m - cylinder.center.x_m;
  const float oy = ray.origin.y_m - cylinder.center.y_m;
  const float a = dx * dx + dy * dy;
  const float half_b = ox * dx + oy * dy;
  const float c = ox * ox + oy * oy - cylinder.radius_m * cylinder.radius_m;
  const float discriminant = half_b * half_b - a * c;
  if (a < 1.0e-6f || discriminant < 0.0f) return kFarAway_m;
  const float t = (-half_b - Sqrt(discriminant)) / a;
  const float z = ray.origin.z_m + t * ray.direction.z_m;
  return t > 0.0f && z >= 0.0f && z <= cylinder.height_m ? t : kFarAway_m;
}

}  // namespace

Hit Cast(const World& world, const Ray& ray) {
  Hit nearest{kFarAway_m, ReturnClass::kIgnored};
  const auto keep_nearer = [&nearest](float distance_m, ReturnClass what) {
    if (distance_m < nearest.distance_m) nearest = {distance_m, what};
  };
  if (ray.direction.z_m < -1.0e-6f) {
    keep_nearer(-ray.origin.z_m / ray.direction.z_m, ReturnClass::kGround);
  }
  for (const Box& box : world.boxes) keep_nearer(DistanceTo(box, ray), box.what);
  for (const Cylinder& cylinder : world.cylinders) {
    keep_nearer(DistanceTo(cylinder, ray), cylinder.what);
  }
  return nearest;
}

}  // namespace hardpack::decision
