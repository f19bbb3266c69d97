// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/steered_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::sim {
namespace {

constexpr double kSteeredStep_s = 0.001;

SteeredModelParams Ideal() {
  SteeredModelParams params;
  params.understeer_s2pm2 = 0.0;
  return params;
}

void Drive(SteeredModel& model, const SteeredSetpoints& setpoints, double seconds) {
  const int steps = static_cast<int>(std::lround(seconds / kSteeredStep_s));
  for (int i = 0; i < steps; ++i) model.Step(setpoints);
}

TEST(SteeredModel, DefaultsAreInRange) {
  EXPECT_TRUE(CheckVehicleModel(SteeredModelParams()).ok());
  SteeredModelParams bad;
  bad.wheelbase_m = 0.0;
  EXPECT_EQ(CheckVehicleModel(bad).status, Status::kParameterOutOfRange);
  bad.wheelbase_m = std::nan("");
  EXPECT_EQ(CheckVehicleModel(bad).status, Status::kNotFinite);
}

// R = L / tan(delta), about the rear axle.
TEST(SteeredModel, DrivesTheCircleOfItsSteeringAngle) {
  const SteeredModelParams params = Ideal();
  for (const double steering_rad : {0.2, -0.4}) {
    SteeredModel model(params, {}, kSteeredStep_s);
    Drive(model, {true, 1.0, steering_rad}, 5.0);
    const double radius_m = params.wheelbase_m / std::tan(steering_rad);
    const Pose& pose = model.pose();
    const double middle_x_m = pose.x_m - radius_m * std::sin(pose.theta_rad);
    const double middle_y_m = pose.y_m + radius_m * std::cos(pose.theta_rad);
    for (int i = 0; i < 20; ++i) {
      Drive(model, {true, 1.0, steering_rad}, 0.3);
      const double distance_m =
          std::hypot(model.pose().x_m - middle_x_m, model.pose().y_m - middle_y_m);
      EXPECT_NEAR(distance_m, std::abs(radius_m), 0.002);
    }
    EXPECT_NEAR(model.yaw_rate_radps() * radius_m, model.speed_mps(), 1.0e-3);
  }
}

TEST(SteeredModel, DoesNotTurnOnTheSpot) {
  SteeredModel model(Ideal(), {1.0, 2.0, 0.5}, kSteeredStep_s);
  Drive(model, {true, 0.0, 0.4}, 3.0);
  EXPECT_NEAR(model.steering_rad(), 0.4, 1.0e-3) << "its wheels do";
  EXPECT_EQ(model.pose().theta_rad, 0.5);
  EXPECT_EQ(model.pose().x_m, 1.0);
  EXPECT_EQ(model.driven_m(), 0.0);
}

TEST(SteeredModel, StaysWithinItsLimits) {
  const SteeredModelParams params = Ideal();
  SteeredModel model(params, {}, kSteeredStep_s);
  double speed_mps = 0.0;
  double steering_rad = 0.0;
  for (int i = 0; i < 12000; ++i) {
    const bool forward = i < 6000;
    model.Step({true, forward ? 50.0 : -50.0, forward ? 3.0 : -3.0});
    const double change_mps2 = (model.speed_mps() - speed_mps) / kSteeredStep_s;
    const bool brakes = change_mps2 * speed_mps < 0.0;
    ASSERT_LE(std::abs(change_mps2),
              1.0e-9 + (brakes ? params.max_deceleration_mps2 : params.max_acceleration_mps2));
    ASSERT_LE(std::abs(model.steering_rad() - steering_rad) / kSteeredStep_s,
              params.steering_rate_radps + 1.0e-9);
    ASSERT_LE(std::abs(model.steering_rad()), params.max_steering_rad + 1.0e-9);
    ASSERT_LE(std::abs(model.speed_mps()), params.max_speed_mps + 1.0e-9);
    speed_mps = model.speed_mps();
    steering_rad = model.steering_rad();
  }
  EXPECT_NEAR(speed_mps, -params.max_speed_mps, 0.01);
  EXPECT_NEAR(steering_rad, -params.max_steering_rad, 0.001);
}

TEST(SteeredModel, StopsAlongItsWayWhereNothingDrivesIt) {
  SteeredModel model(Ideal(), {}, kSteeredStep_s);
  Drive(model, {true, 3.0, 0.3}, 4.0);
  const double before_rad = model.steering_rad();
  Drive(model, {}, 2.0);
  EXPECT_EQ(model.speed_mps(), 0.0);
  EXPECT_NEAR(model.steering_rad(), before_rad, 1.0e-3);
}

TEST(SteeredModel, TurnsLessAtSpeedThanItsWheelsPoint) {
  SteeredModelParams params;
  params.understeer_s2pm2 = 0.01;
  SteeredModel model(params, {}, kSteeredStep_s);
  Drive(model, {true, 4.0, 0.2}, 6.0);
  const double curvature_per_m = model.yaw_rate_radps() / model.speed_mps();
  EXPECT_NEAR(curvature_per_m, std::tan(0.2) / params.wheelbase_m / (1.0 + 0.01 * 16.0), 1.0e-4);
}

TEST(SteeredModel, MirroredSetpointsGiveMirroredMotion) {
  SteeredModel left(SteeredModelParams(), {}, kSteeredStep_s);
  SteeredModel right(SteeredModelParams(), {}, kSteeredStep_s);
  Drive(left, {true, 3.0, 0.3}, 3.0);
  Drive(right, {true, 3.0, -0.3}, 3.0);
  EXPECT_EQ(left.pose().x_m, right.pose().x_m);
  EXPECT_EQ(left.pose().y_m, -right.pose().y_m);
}

TEST(SteeredModelFile, OfTheProjectIsRead) {
  UncertainBody body;
  const ReadOutcome outcome = ReadBody(HARDPACK_VEHICLES "/ackermann.toml", body);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  const auto* steered = std::get_if<UncertainSteered>(&body);
  ASSERT_NE(steered, nullptr);
  EXPECT_TRUE(CheckVehicleModel(steered->typical).ok());
  EXPECT_EQ(steered->typical.wheelbase_m, 1.23);
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const SteeredModelParams drawn = Draw(*steered, seed);
    EXPECT_TRUE(CheckVehicleModel(drawn).ok()) << seed;
    EXPECT_EQ(drawn.wheelbase_m, 1.23) << "exact";
    EXPECT_GE(drawn.max_steering_rad, 0.469) << "what its configuration reckons with";
  }
}

TEST(SteeredModelFile, IsWrittenAsItIsRead) {
  UncertainSteered vehicle;
  vehicle.typical.wheelbase_m = 1.0 / 3.0;
  vehicle.deviation.steering_rate_radps = 0.05;
  const std::string text = VehicleToToml(UncertainBody(vehicle), "written");
  UncertainBody read;
  const ReadOutcome outcome = ParseBody(text, "t", read);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(VehicleToToml(read, "written"), text);
}

TEST(SteeredModelFile, AMistakeLeavesWhatWasThere) {
  UncertainBody body = UncertainVehicle();
  const ReadOutcome outcome = ParseBody("[steered_model]\nwheelbas_m = 1.0\n", "t", body);
  EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  EXPECT_NE(outcome.message.find("did you mean wheelbase_m?"), std::string::npos)
      << outcome.message;
  EXPECT_TRUE(std::holds_alternative<UncertainVehicle>(body));
}

}  // namespace
}  // namespace hardpack::sim
