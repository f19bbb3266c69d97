// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/vehicle_model.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace hardpack::sim {
namespace {

// Numbers with which a hand can compute: no dead time, no resistance, no slip.
VehicleModelParams Plain() {
  VehicleModelParams params;
  params.dead_time_common_s = 0.0;
  params.dead_time_differential_s = 0.0;
  params.time_constant_common_s = 0.5;
  params.time_constant_differential_s = 0.25;
  params.slew_common_radps2 = 1000.0;
  params.slew_differential_radps2 = 1000.0;
  params.common_turn_loss = 0.0;
  params.scrub_radps = 0.0;
  params.differential_limit_radps = 100.0;
  params.differential_limit_slope = 0.0;
  params.wheel_limit_radps = 20.0;
  params.brake_radps2 = 30.0;
  params.wheel_radius_m = 0.3;
  params.ground_per_wheel = 1.0;
  params.turn_slip = 0.0;
  params.skid_baseline_m = 1.5;
  params.speed_time_constant_s = 0.0;
  params.yaw_time_constant_s = 0.0;
  params.turning_point_m = 0.0;
  return params;
}

WheelSetpoints Setpoints(double left_radps, double right_radps) {
  return {.speeds = {left_radps, right_radps}};
}

void Drive(VehicleModel& model, const WheelSetpoints& setpoints, double seconds) {
  const auto steps = static_cast<int>(std::lround(seconds / VehicleModel::kStep_s));
  for (int i = 0; i < steps; ++i) model.Step(setpoints);
}

TEST(VehicleModel, DefaultsAreInRange) {
  EXPECT_TRUE(CheckVehicleModel(VehicleModelParams()).ok());
}

TEST(VehicleModel, FollowsAStepOfBothSidesAsAFirstOrderLag) {
  VehicleModel model(Plain());
  Drive(model, Setpoints(10.0, 10.0), 0.5);
  // 10 (1 - (1 - 0.001 / 0.5)^500), a step's length from 10 (1 - 1 / e)
  EXPECT_NEAR(model.wheels().left_radps, 6.3248875, 1.0e-6);
  EXPECT_EQ(model.wheels().left_radps, model.wheels().right_radps);
}

TEST(VehicleModel, FollowsATurnWithItsOwnTimeConstant) {
  VehicleModel model(Plain());
  Drive(model, Setpoints(-10.0, 10.0), 0.25);
  // 10 (1 - (1 - 0.001 / 0.25)^250)
  EXPECT_NEAR(model.wheels().right_radps, 10.0 * (1.0 - 0.367142), 1.0e-5);
  EXPECT_EQ(model.wheels().left_radps, -model.wheels().right_radps);
}

TEST(VehicleModel, WaitsForTheDeadTimeOfEachPart) {
  VehicleModelParams params = Plain();
  params.dead_time_common_s = 0.15;
  params.dead_time_differential_s = 0.05;
  VehicleModel straight(params);
  Drive(straight, Setpoints(10.0, 10.0), 0.150);
  EXPECT_EQ(straight.wheels().left_radps, 0.0);
  straight.Step(Setpoints(10.0, 10.0));
  EXPECT_NEAR(straight.wheels().left_radps, 10.0 * 0.001 / 0.5, 1.0e-12);
  VehicleModel turning(params);
  Drive(turning, Setpoints(-10.0, 10.0), 0.050);
  EXPECT_EQ(turning.wheels().right_radps, 0.0);
  turning.Step(Setpoints(-10.0, 10.0));
  // less 1.25e-9 of it, by the limit of 100 rad/s
  EXPECT_NEAR(turning.wheels().right_radps, 10.0 * 0.001 / 0.25, 1.0e-10);
}

TEST(VehicleModel, DeadTimeBetweenStepsIsAMixtureOfBoth) {
  VehicleModelParams params = Plain();
  params.dead_time_common_s = 0.00225;
  VehicleModel model(params);
  Drive(model, Setpoints(10.0, 10.0), 0.002);
  EXPECT_EQ(model.wheels().left_radps, 0.0);
  model.Step(Setpoints(10.0, 10.0));  // the setpoint of 2 steps ago, and a quarter of that of 3
  EXPECT_NEAR(model.wheels().left_radps, 0.75 * 10.0 * 0.001 / 0.5, 1.0e-9);
}

TEST(VehicleModel, AccelerationIsLimited) {
  VehicleModelParams params = Plain();
  params.slew_common_radps2 = 14.0;
  params.slew_differential_radps2 = 6.0;
  VehicleModel straight(params);
  Drive(straight, Setpoints(13.0, 13.0), 0.1);
  EXPECT_NEAR(straight.wheels().left_radps, 1.4, 1.0e-9);
  VehicleModel turning(params);
  Drive(turning, Setpoints(-13.0, 13.0), 0.1);
  EXPECT_NEAR(turning.wheels().right_radps, 0.6, 1.0e-9);
}

TEST(VehicleModel, LargeTurningSetpointsAreNotReached) {
  VehicleModelParams params = Plain();
  params.differential_limit_radps = 7.0;
  VehicleModel at_limit(params);
  Drive(at_limit, Setpoints(-7.0, 7.0), 5.0);
  EXPECT_NEAR(at_limit.wheels().right_radps, 7.0 * 0.9170040, 1.0e-5);  // / 2^(1/8)
  VehicleModel beyond(params);
  Drive(beyond, Setpoints(-14.0, 14.0), 5.0);
  EXPECT_NEAR(beyond.wheels().right_radps, 7.0 * 0.9995131, 1.0e-5);  // 2 / 257^(1/8)
  params.differential_limit_slope = 0.5;
  VehicleModel driving(params);
  Drive(driving, Setpoints(4.0 - 14.0, 4.0 + 14.0), 10.0);
  EXPECT_NEAR(driving.wheels().differential_radps(), 5.0, 0.01);
  EXPECT_NEAR(driving.wheels().common_radps(), 4.0, 1.0e-6);
}

TEST(VehicleModel, NoWheelExceedsItsLimit) {
  VehicleModelParams params = Plain();
  params.wheel_limit_radps = 13.4;
  VehicleModel model(params);
  Drive(model, Setpoints(16.5, 17.0), 5.0);
  EXPECT_EQ(model.wheels().left_radps, 13.4);
  EXPECT_EQ(model.wheels().right_radps, 13.4);
  Drive(model, Setpoints(-16.5, -6.0), 10.0);
  EXPECT_EQ(model.wheels().left_radps, -13.4);
}

TEST(VehicleModel, ScrubbingTakesFromATurnAndTheIntegralGivesItBack) {
  VehicleModelParams params = Plain();
  params.scrub_radps = 1.5;
  params.scrub_width_radps = 0.1;
  params.integral_time_s = 5.0;
  VehicleModel model(params);
  Drive(model, Setpoints(-4.0, 4.0), 1.0);
  EXPECT_NEAR(model.wheels().right_radps, 2.7, 0.25);  // 4 - 1.5, and a little of the integral
  Drive(model, Setpoints(-4.0, 4.0), 2.0);
  EXPECT_NEAR(model.wheels().right_radps, 3.25, 0.25);
  Drive(model, Setpoints(-4.0, 4.0), 60.0);
  EXPECT_NEAR(model.wheels().right_radps, 4.0, 1.0e-3);
}

TEST(VehicleModel, SteadyStraightDrivingHasTheGroundsShareOfTheRimSpeed) {
  VehicleModelParams params = Plain();
  params.ground_per_wheel = 0.962;
  params.speed_time_constant_s = 0.3;
  VehicleModel model(params);
  Drive(model, Setpoints(10.0, 10.0), 20.0);
  EXPECT_NEAR(model.speed_mps(), 0.962 * 0.3 * 10.0, 1.0e-9);
  EXPECT_EQ(model.yaw_rate_radps(), 0.0);
  EXPECT_EQ(model.pose().y_m, 0.0);
  EXPECT_NEAR(model.acceleration_x_mps2(), 0.0, 1.0e-9);
  EXPECT_NEAR(model.driven_m(), model.pose().x_m, 1.0e-9);
}

// c = 6, d = 3: w = 2 * 0.3 * 3 / 1.5 = 1.2 rad/s, v = 0.3 * 6 (1 - 0.5 * 9 / 45) = 1.62 m/s
TEST(VehicleModel, SteadyTurnIsACircle) {
  VehicleModelParams params = Plain();
  params.turn_slip = 0.5;
  params.turning_point_m = 0.5;
  params.turning_point_speed_mps = 1.62;  // so that the point lies 0.5 / sqrt 2 ahead
  VehicleModel model(params);
  Drive(model, Setpoints(3.0, 9.0), 20.0);
  EXPECT_NEAR(model.yaw_rate_radps(), 1.2, 1.0e-9);
  EXPECT_NEAR(model.speed_mps(), 1.62, 1.0e-9);
  EXPECT_NEAR(model.lateral_speed_mps(), -1.2 * 0.5 / std::sqrt(2.0), 1.0e-9);
  EXPECT_NEAR(model.acceleration_y_mps2(), 1.2 * 1.62, 1.0e-9);  // to the middle of the circle
  EXPECT_NEAR(model.acceleration_x_mps2(), 1.2 * 1.2 * 0.5 / std::sqrt(2.0), 1.0e-9);
  const Pose before = model.pose();
  Drive(model, Setpoints(3.0, 9.0), 5.236);  // a turn, 2 pi / 1.2 s
  EXPECT_NEAR(model.pose().theta_rad, before.theta_rad + 2.0 * 3.14159265, 1.0e-3);
  EXPECT_NEAR(model.pose().x_m, before.x_m, 1.0e-3);
  EXPECT_NEAR(model.pose().y_m, before.y_m, 1.0e-3);
}

TEST(VehicleModel, AccelerationIsTheChangeOfSpeed) {
  VehicleModelParams params = Plain();
  params.slew_common_radps2 = 10.0;
  VehicleModel model(params);
  Drive(model, Setpoints(15.0, 15.0), 0.2);
  EXPECT_NEAR(model.acceleration_x_mps2(), 0.3 * 10.0, 1.0e-6);
  EXPECT_EQ(model.acceleration_y_mps2(), 0.0);
}

TEST(VehicleModel, SettleGoesOnAsBefore) {
  VehicleModelParams params;
  VehicleModel model(params);
  Drive(model, Setpoints(2.0, 8.0), 60.0);
  VehicleModel other(params, model.pose());
  other.Settle(model.wheels(), {2.0, 8.0});
  Drive(model, Setpoints(2.0, 8.0), 1.0);
  Drive(other, Setpoints(2.0, 8.0), 1.0);
  EXPECT_NEAR(other.wheels().left_radps, model.wheels().left_radps, 1.0e-3);
  EXPECT_NEAR(other.wheels().right_radps, model.wheels().right_radps, 1.0e-3);
  EXPECT_NEAR(other.speed_mps(), model.speed_mps(), 1.0e-3);
}

TEST(VehicleModel, ComesToRestOutOfATurn) {
  VehicleModel model({});
  Drive(model, Setpoints(2.0, 8.0), 20.0);
  Drive(model, Setpoints(0.0, 0.0), 4.0);
  EXPECT_NEAR(model.wheels().left_radps, 0.0, 0.01);
  EXPECT_NEAR(model.wheels().right_radps, 0.0, 0.01);
  EXPECT_NEAR(model.yaw_rate_radps(), 0.0, 0.01);
}

TEST(VehicleModel, BrakesHoldWhatIsNotDriven) {
  VehicleModel model(Plain());
  Drive(model, Setpoints(9.0, 9.0), 10.0);
  const WheelSetpoints off = {.speeds = {9.0, 9.0}, .left_driven = false, .right_driven = false};
  Drive(model, off, 0.1);
  EXPECT_NEAR(model.wheels().left_radps, 9.0 - 3.0, 1.0e-6);
  Drive(model, off, 1.0);
  EXPECT_EQ(model.wheels().left_radps, 0.0);
  EXPECT_EQ(model.speed_mps(), 0.0);
}

TEST(VehicleModel, BrakedSideStandsWhileTheOtherIsDriven) {
  VehicleModel model({});
  const WheelSetpoints one = {.speeds = {5.0, 5.0}, .left_driven = false, .right_driven = true};
  Drive(model, one, 5.0);
  EXPECT_EQ(model.wheels().left_radps, 0.0);
  EXPECT_GT(model.wheels().right_radps, 1.0);
  EXPECT_GT(model.yaw_rate_radps(), 0.1);  // it turns about the braked side
}

TEST(VehicleModel, WhatWasCommandedBeforeTheBrakesIsForgotten) {
  VehicleModelParams params = Plain();
  params.dead_time_common_s = 0.2;
  VehicleModel model(params);
  Drive(model, Setpoints(9.0, 9.0), 0.15);
  Drive(model, {.speeds = {}, .left_driven = false, .right_driven = false}, 0.01);
  Drive(model, Setpoints(0.0, 0.0), 1.0);
  EXPECT_EQ(model.driven_m(), 0.0);
}

// A course that uses every part: seeded setpoints, each held for a while.
std::vector<WheelSetpoints> Course(uint64_t seed, int pieces) {
  std::mt19937_64 random(seed);
  std::vector<WheelSetpoints> course;
  const auto speed = [&random] { return static_cast<double>(random() % 34001) / 1000.0 - 17.0; };
  for (int i = 0; i < pieces; ++i) {
    WheelSetpoints setpoints = Setpoints(speed(), 0.0);
    setpoints.speeds.right_radps = speed();
    setpoints.left_driven = random() % 16 != 0;
    setpoints.right_driven = random() % 16 != 0;
    course.insert(course.end(), 200 + random() % 2000, setpoints);
  }
  return course;
}

TEST(VehicleModel, MirroredSetpointsGiveTheMirroredCourseExactly) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    VehicleModel model({});
    VehicleModel mirrored({});
    for (WheelSetpoints setpoints : Course(seed, 20)) {
      model.Step(setpoints);
      std::swap(setpoints.speeds.left_radps, setpoints.speeds.right_radps);
      std::swap(setpoints.left_driven, setpoints.right_driven);
      mirrored.Step(setpoints);
      ASSERT_EQ(model.wheels().left_radps, mirrored.wheels().right_radps) << "seed " << seed;
      ASSERT_EQ(model.wheels().right_radps, mirrored.wheels().left_radps);
      ASSERT_EQ(model.pose().x_m, mirrored.pose().x_m);
      ASSERT_EQ(model.pose().y_m, -mirrored.pose().y_m);
      ASSERT_EQ(model.pose().theta_rad, -mirrored.pose().theta_rad);
      ASSERT_EQ(model.acceleration_y_mps2(), -mirrored.acceleration_y_mps2());
    }
  }
}

TEST(VehicleModel, StaysFiniteForEveryDrawnVehicle) {
  UncertainVehicle vehicle;
  for (const VehicleParameter& parameter : VehicleParameters()) {
    vehicle.deviation.*parameter.value = 0.5 * (vehicle.typical.*parameter.value);
  }
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const VehicleModelParams params = Draw(vehicle, seed);
    ASSERT_TRUE(CheckVehicleModel(params).ok());
    VehicleModel model(params);
    for (const WheelSetpoints& setpoints : Course(seed, 5)) {
      model.Step(setpoints);
      ASSERT_LE(std::abs(model.wheels().left_radps), params.wheel_limit_radps) << "seed " << seed;
      ASSERT_LE(std::abs(model.speed_mps()), 2.0 * 20.0) << "seed " << seed;
    }
    EXPECT_TRUE(std::isfinite(model.pose().x_m) && std::isfinite(model.pose().theta_rad));
  }
}

uint64_t HashOfCourse() {
  uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a over the bits
  VehicleModel model({});
  for (const WheelSetpoints& setpoints : Course(7, 30)) {
    model.Step(setpoints);
    for (const double value : {model.pose().x_m, model.pose().y_m, model.pose().theta_rad,
                               model.acceleration_x_mps2(), model.wheels().left_radps}) {
      hash = (hash ^ std::bit_cast<uint64_t>(value)) * 0x100000001b3u;
    }
  }
  return hash;
}

// Of the default numbers; to be changed with them or with the equations, by nothing else.
TEST(VehicleModel, SameBitsOnEveryMachine) {
  EXPECT_EQ(HashOfCourse(), 8865577174718982555u);
}

TEST(VehicleModel, UnusableNumbersAreRefusedByName) {
  VehicleModelParams params;
  params.skid_baseline_m = std::numeric_limits<double>::quiet_NaN();
  ReadOutcome outcome = CheckVehicleModel(params);
  EXPECT_EQ(outcome.status, Status::kNotFinite);
  EXPECT_NE(outcome.message.find("skid_baseline_m"), std::string::npos);
  params = {};
  params.time_constant_common_s = 0.0;
  outcome = CheckVehicleModel(params);
  EXPECT_EQ(outcome.status, Status::kParameterOutOfRange);
  EXPECT_NE(outcome.message.find("time_constant_common_s"), std::string::npos);
}

TEST(DrawnVehicle, IsTheTypicalOneWithoutDeviations) {
  const UncertainVehicle vehicle;
  const VehicleModelParams drawn = Draw(vehicle, 5);
  for (const VehicleParameter& parameter : VehicleParameters()) {
    EXPECT_EQ(drawn.*parameter.value, vehicle.typical.*parameter.value) << parameter.name;
  }
}

TEST(DrawnVehicle, HasItsSeedsNumbers) {
  UncertainVehicle vehicle;
  vehicle.deviation.skid_baseline_m = 0.1;
  vehicle.deviation.scrub_radps = 0.3;
  const VehicleModelParams drawn = Draw(vehicle, 5);
  EXPECT_EQ(drawn.skid_baseline_m, Draw(vehicle, 5).skid_baseline_m);
  EXPECT_NE(drawn.skid_baseline_m, Draw(vehicle, 6).skid_baseline_m);
  vehicle.deviation.scrub_radps = 0.0;  // another number's deviation changes nothing
  EXPECT_EQ(drawn.skid_baseline_m, Draw(vehicle, 5).skid_baseline_m);
}

TEST(DrawnVehicle, KeepsToTwoDeviationsAndToTheRange) {
  UncertainVehicle vehicle;
  vehicle.deviation.skid_baseline_m = 0.1;
  vehicle.typical.turn_slip = 0.05;
  vehicle.deviation.turn_slip = 0.2;
  constexpr int kVehicles = 4000;
  double sum = 0.0;
  double squares = 0.0;
  for (uint64_t seed = 0; seed < kVehicles; ++seed) {
    const VehicleModelParams drawn = Draw(vehicle, seed);
    const double off_m = drawn.skid_baseline_m - vehicle.typical.skid_baseline_m;
    ASSERT_LE(std::abs(off_m), 0.2 + 1.0e-12);
    ASSERT_GE(drawn.turn_slip, 0.0);
    sum += off_m;
    squares += off_m * off_m;
  }
  EXPECT_NEAR(sum / kVehicles, 0.0, 0.006);
  EXPECT_NEAR(std::sqrt(squares / kVehicles), 0.1 * 0.88, 0.005);  // of a normal one cut off at 2
}

}  // namespace
}  // namespace hardpack::sim
