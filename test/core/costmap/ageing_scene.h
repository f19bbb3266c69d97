// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/math.h"
#include "core/costmap/height_grid.h"

// A small world for the ageing tests: upright boxes on level ground, and a lidar of 64 beams and
// 1024 directions that is turned over a part of its revolution.

namespace hardpack {

struct Upright {
  float min_x_m, max_x_m, min_y_m, max_y_m, min_z_m, max_z_m;
  ReturnClass what = ReturnClass::kHard;
};

struct Return {
  Vec3 point;
  ReturnClass what;
};

class LidarScene {
 public:
  static constexpr int kDirections = 1024;
  static constexpr int kBeams = 64;

  Vec3 sensor = {0.05f, 0.03f, 1.3f};
  float max_range_m = 60.0f;
  std::vector<Upright> boxes;

  // What one direction sees; direction 0 is along x, anticlockwise.
  SightFan Look(int direction, std::vector<Return>& returns) const {
    SightFan fan;
    fan.sensor_odom = sensor;
    const SinCosPair at = SinCos(kTwoPi * static_cast<float>(direction) / kDirections);
    fan.direction_odom = {at.cos, at.sin};
    fan.beams = kBeams;
    returns.clear();
    for (int beam = 0; beam < kBeams; ++beam) {
      const float slope = -0.3f + 0.6f * static_cast<float>(beam) / (kBeams - 1);
      fan.slope[beam] = slope;
      ReturnClass what = ReturnClass::kGround;
      fan.level_m[beam] = Cast(fan.direction_odom, slope, what);
      if (fan.level_m[beam] <= 0.0f) continue;
      const float level_m = fan.level_m[beam];
      returns.push_back({{sensor.x_m + at.cos * level_m, sensor.y_m + at.sin * level_m,
                          sensor.z_m + slope * level_m},
                         what});
    }
    fan.lowest_slope = -0.3f;
    fan.highest_slope = 0.3f;
    return fan;
  }

  // One revolution, from direction -reach to +reach: everything is filed and seen at once.
  void Revolve(HeightGrid& grid, int reach, uint32_t revolution, int ageing_revolutions) const {
    std::vector<Return> returns;
    for (int direction = -reach; direction <= reach; ++direction) {
      const SightFan fan = Look(direction, returns);
      (void)grid.Age(fan, revolution, ageing_revolutions);
      for (const Return& item : returns) (void)grid.Insert(item.point, item.what, revolution);
    }
  }

 private:
  // Level distance of what stops a beam; 0: nothing.
  float Cast(Vec2 direction, float slope, ReturnClass& what) const {
    float nearest_m = slope < 0.0f ? sensor.z_m / -slope : 2.0f * max_range_m;
    for (const Upright& box : boxes) {
      float in_m = 0.0f;
      float out_m = 1.0e6f;
      Slab(sensor.x_m, direction.x_m, box.min_x_m, box.max_x_m, in_m, out_m);
      Slab(sensor.y_m, direction.y_m, box.min_y_m, box.max_y_m, in_m, out_m);
      Slab(sensor.z_m, slope, box.min_z_m, box.max_z_m, in_m, out_m);
      if (in_m >= out_m || in_m <= 0.0f || in_m >= nearest_m) continue;
      nearest_m = in_m + 0.001f;
      what = box.what;
    }
    return nearest_m <= max_range_m ? nearest_m : 0.0f;
  }

  static void Slab(float from, float rate, float low, float high, float& in_m, float& out_m) {
    if (rate == 0.0f) {
      if (from < low || from > high) out_m = -1.0f;
      return;
    }
    const float a = (low - from) / rate;
    const float b = (high - from) / rate;
    in_m = Max(in_m, Min(a, b));
    out_m = Min(out_m, Max(a, b));
  }
};

}  // namespace hardpack
