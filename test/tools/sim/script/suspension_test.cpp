// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/suspension.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hardpack::sim {
namespace {

constexpr double kStep_s = 0.001;
constexpr double kPi = 3.14159265358979;

// Level until x = 3 m, then up by 0.2 per metre.
world::World WithRamp(double friction) {
  const world::Bounds bounds;
  world::World world(bounds, world::Terrain(bounds, [](double x_m, double) {
                       return x_m > 3.0 ? 0.2 * (x_m - 3.0) : 0.0;
                     }));
  if (friction > 0.0) world.SetFriction(friction);
  return world;
}

VehicleSettings At(double x_m, double yaw_rad) {
  VehicleSettings settings = DefaultVehicle();
  settings.model = VehicleModelParams();
  settings.start = {x_m, 0.0, yaw_rad};
  return settings;
}

TEST(Suspension, WithoutFrictionTheBodyIsFixedToItsWheels) {
  const world::World world = WithRamp(0.0);
  const SimVehicle vehicle(At(10.0, 0.0), 0);
  Suspension suspension(0.0, kStep_s);
  const BodyMotion motion = suspension.Step(vehicle, world);
  EXPECT_EQ(motion.pose.pitch_rad, MotionOf(vehicle, world).pose.pitch_rad);
  EXPECT_EQ(motion.specific_force_mps2.x_m, MotionOf(vehicle, world).specific_force_mps2.x_m);
}

// From level ground onto a ramp, as if it were put there: 1 - 1 / e after one lag, and the gyro's
// rates add up to the pitch.
TEST(Suspension, FollowsTheGroundWithALag) {
  const world::World world = WithRamp(0.6);
  const double ramp_rad = std::atan(0.2);
  Suspension suspension(0.0, kStep_s);
  const SimVehicle level(At(0.0, 0.0), 0);
  EXPECT_EQ(suspension.Step(level, world).pose.pitch_rad, 0.0);
  const SimVehicle on_ramp(At(10.0, 0.0), 0);
  double turned_rad = 0.0;
  double risen_m = 0.0;
  BodyMotion motion;
  for (int i = 0; i < 120; ++i) {
    motion = suspension.Step(on_ramp, world);
    turned_rad += motion.rate_radps.y_m * kStep_s;
    risen_m += suspension.rise_mps() * kStep_s;
  }
  EXPECT_NEAR(motion.pose.pitch_rad, -ramp_rad * (1.0 - std::exp(-1.0)), 2.0e-3);
  EXPECT_NEAR(turned_rad, motion.pose.pitch_rad, 1.0e-9);
  EXPECT_NEAR(risen_m, motion.pose.position.z_m, 1.0e-9);
  for (int i = 0; i < 2000; ++i) motion = suspension.Step(on_ramp, world);
  EXPECT_NEAR(motion.pose.pitch_rad, -ramp_rad, 1.0e-6);
  EXPECT_NEAR(motion.pose.position.z_m, 1.4, 1.0e-5);
  EXPECT_NEAR(motion.rate_radps.y_m, 0.0, 1.0e-6);
}

// Across the ramp it is roll.
TEST(Suspension, LeansOnASideSlope) {
  const world::World world = WithRamp(0.6);
  const SimVehicle vehicle(At(10.0, kPi / 2.0), 0);
  Suspension suspension(0.0, kStep_s);
  const BodyMotion motion = suspension.Step(vehicle, world);
  EXPECT_NEAR(motion.pose.roll_rad, -std::atan(0.2), 1.0e-3);  // uphill is to its right
  EXPECT_NEAR(motion.pose.pitch_rad, 0.0, 1.0e-3);
}

}  // namespace
}  // namespace hardpack::sim
