// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/pose.h"
#include "core/measurements/measurements.h"
#include "tools/sim/vehicle/sim_vehicle.h"
#include "tools/sim/world/world.h"

// Between the simulated world and what the vehicle takes to be where: its odometry drifts, so a
// path that it planned lies in the world where the odometry was when it was planned.

namespace hardpack::mission {

// A rigid motion of the plane: world = turn(odom) + offset.
class WorldFromOdom {
 public:
  WorldFromOdom() = default;
  // The one by which the vehicle is at both places at once.
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
