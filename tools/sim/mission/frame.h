// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/pose.h"
#include "core/measurements/measurements.h"
#include "tools/sim/vehicle/sim_vehicle.h"
#include "tools/sim/world/world.h"

// Converts between the simulated world and the vehicle's own odometry frame. The odometry drifts,
// so a planned path is placed in the world by the odometry at the time of planning.

namespace hardpack::mission {

// A rigid motion of the plane: world = turn(odom) + offset.
class WorldFromOdom {
 public:
  WorldFromOdom() = default;
  // The motion that maps the vehicle's odometry pose to its pose in the world.
  WorldFromOdom(const sim::Pose& world, const StampedPose& odom)
      : turn_(world::TurnOf(world.theta_rad - static_cast<double>(odom.yaw_rad))),
        x_m_(world.x_m),
        y_m_(world.y_m) {
    const world::Point2 turned = Turned(odom.position.x_m, odom.position.y_m);
    x_m_ -= turned.x_m;
    y_m_ -= turned.y_m;
  }

  world::Point2 ToWorld(Vec2 odom) const {
    const world::Point2 turned = Turned(odom.x_m, odom.y_m);
    return {turned.x_m + x_m_, turned.y_m + y_m_};
  }
  Vec2 ToOdom(world::Point2 world) const {
    const double x = world.x_m - x_m_;
    const double y = world.y_m - y_m_;
    return {static_cast<float>(turn_.cos * x + turn_.sin * y),
            static_cast<float>(turn_.cos * y - turn_.sin * x)};
  }

 private:
  world::Point2 Turned(double x, double y) const {
    return {turn_.cos * x - turn_.sin * y, turn_.sin * x + turn_.cos * y};
  }

  world::Turn turn_;
  double x_m_ = 0.0;
  double y_m_ = 0.0;
};

}  // namespace hardpack::mission
