// SPDX-License-Identifier: Apache-2.0
#include "core/kinematics/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hardpack {
namespace {

VehicleParams Ackermann(float wheelbase_m, float max_steering_rad) {
  VehicleParams vehicle;
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.wheelbase_m = wheelbase_m;
  vehicle.max_steering_rad = max_steering_rad;
  return vehicle;
}

TEST(Kinematics, TheDefaultVehicleTurnsOnTheSpotAndAsItLikes) {
  const VehicleParams vehicle;
  EXPECT_TRUE(CanPivot(vehicle));
  EXPECT_EQ(MostCurvature(vehicle), kAnyCurvature_per_m);
  EXPECT_EQ(PossibleYawRate(vehicle, 0.0f, 1.5f), 1.5f);
  EXPECT_EQ(CurvatureOfSteering(vehicle, 0.3f), 0.0f);
  EXPECT_EQ(SteeringOfCurvature(vehicle, 0.3f), 0.0f);
}

// R = L / tan(delta): 2 m and 45 degrees give 2 m.
TEST(Kinematics, TheLeastTurningRadiusIsTheWheelbaseOverTheTangent) {
  EXPECT_NEAR(double{MostCurvature(Ackermann(2.0f, 0.78539816f))}, 0.5, 1e-6);
  EXPECT_NEAR(double{MostCurvature(Ackermann(1.8f, 0.45f))}, std::tan(0.45) / 1.8, 1e-6);
  EXPECT_FALSE(CanPivot(Ackermann(2.0f, 0.5f)));
}

TEST(Kinematics, SteeringAndCurvatureUndoEachOtherUpToTheLimit) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(-1.0f, 1.0f);
  std::uniform_real_distribution<float> wheelbase(0.3f, 5.0f);
  std::uniform_real_distribution<float> most(0.05f, 1.2f);
  for (int i = 0; i < 1000; ++i) {
    const VehicleParams vehicle = Ackermann(wheelbase(random), most(random));
    const float steering_rad = share(random) * vehicle.max_steering_rad;
    const float curvature_per_m = CurvatureOfSteering(vehicle, steering_rad);
    EXPECT_NEAR(double{SteeringOfCurvature(vehicle, curvature_per_m)}, double{steering_rad}, 1e-5);
    EXPECT_LE(std::abs(curvature_per_m), MostCurvature(vehicle));
  }
}

TEST(Kinematics, WhatIsBeyondTheLimitIsClampedToIt) {
  const VehicleParams vehicle = Ackermann(2.0f, 0.5f);
  EXPECT_EQ(CurvatureOfSteering(vehicle, 3.0f), MostCurvature(vehicle));
  EXPECT_EQ(CurvatureOfSteering(vehicle, -3.0f), -MostCurvature(vehicle));
  EXPECT_EQ(SteeringOfCurvature(vehicle, 1.0e6f), 0.5f);
  EXPECT_EQ(SteeringOfCurvature(vehicle, -1.0e6f), -0.5f);
}

TEST(Kinematics, AYawRateNeedsASpeed) {
  const VehicleParams vehicle = Ackermann(2.0f, 0.78539816f);
  EXPECT_EQ(PossibleYawRate(vehicle, 0.0f, 2.0f), 0.0f);
  EXPECT_NEAR(double{PossibleYawRate(vehicle, 2.0f, 2.0f)}, 1.0, 1e-5);
  EXPECT_NEAR(double{PossibleYawRate(vehicle, -2.0f, -2.0f)}, -1.0, 1e-5);
  EXPECT_EQ(PossibleYawRate(vehicle, 2.0f, 0.3f), 0.3f);
}

}  // namespace
}  // namespace hardpack
