// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/body_on_ground.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tools/sim/vehicle/steered_model.h"
#include "tools/sim/vehicle/vehicle_model.h"

namespace hardpack::sim {
namespace {

constexpr double kBodyStep_s = 0.001;
constexpr double kDegree_rad = 3.14159265358979 / 180.0;

// Chassis without creep, so that a hand can compute.
ChassisParams Stiff() {
  ChassisParams chassis;
  chassis.tyre_slip = 0.0;
  chassis.side_slip_rad = 0.0;
  chassis.tyre_arm_m = 0.0;
  chassis.drive_mps2 = 100.0;
  return chassis;
}

// Ground that rises by `ahead_deg` ahead.
GroundUnder Uphill(double ahead_deg, double friction) {
  return {.friction = friction,
          .up_forward = std::sin(ahead_deg * kDegree_rad),
          .press = std::cos(ahead_deg * kDegree_rad)};
}

GroundUnder LeftUp(double left_deg, double friction) {
  return {.friction = friction,
          .up_left = std::sin(left_deg * kDegree_rad),
          .press = std::cos(left_deg * kDegree_rad)};
}

// Seconds of wheels that turn at wheels_mps; the way it went.
double Roll(BodyOnGround& body, double& speed_mps, double wheels_mps, double seconds) {
  double way_m = 0.0;
  for (int i = 0; i < static_cast<int>(std::lround(seconds / kBodyStep_s)); ++i) {
    speed_mps = body.Along(speed_mps, wheels_mps, 0.0);
    way_m += speed_mps * kBodyStep_s;
  }
  return way_m;
}

TEST(BodyOnGround, WithoutFrictionItIsAsFastAsItsWheels) {
  BodyOnGround body(Stiff(), kBodyStep_s);
  EXPECT_EQ(body.Along(1.0, 5.0, 0.3), 5.0);
  EXPECT_EQ(body.Crept(5.0), 5.0);
  EXPECT_EQ(body.slip_left_mps(), 0.0);
  EXPECT_EQ(body.tipping(), 0.0);
}

// v^2 / (2 g (mu cos a - sin a)) from 5 m/s with wheels that stand.
TEST(BodyOnGround, StopsDownhillAsFrictionAndGradeAllow) {
  for (const double down_deg : {0.0, 9.0, 16.0}) {
    for (const double friction : {0.4, 0.6}) {
      BodyOnGround body(Stiff(), kBodyStep_s);
      body.SetGround(Uphill(-down_deg, friction));
      double speed_mps = 5.0;
      const double way_m = Roll(body, speed_mps, 0.0, 20.0);
      const double brakes_mps2 = kGravity_mps2 * (friction * std::cos(down_deg * kDegree_rad) -
                                                  std::sin(down_deg * kDegree_rad));
      EXPECT_NEAR(way_m, 25.0 / (2.0 * brakes_mps2), 0.02) << down_deg << " " << friction;
      EXPECT_NEAR(speed_mps, 0.0, 1.0e-12);
    }
  }
}

// At mu = 0.3 nothing is left from -16.7 degrees on.
TEST(BodyOnGround, DoesNotStopWhereTheGradeIsMoreThanTheFriction) {
  BodyOnGround body(Stiff(), kBodyStep_s);
  body.SetGround(Uphill(-17.0, 0.3));
  double speed_mps = 1.0;
  Roll(body, speed_mps, 0.0, 5.0);
  EXPECT_GT(speed_mps, 1.0);
  EXPECT_TRUE(body.slides());
}

TEST(BodyOnGround, StandsOnASlopeWithItsWheelsHeld) {
  BodyOnGround body(Stiff(), kBodyStep_s);
  body.SetGround(Uphill(20.0, 0.5));
  double speed_mps = 0.0;
  EXPECT_EQ(Roll(body, speed_mps, 0.0, 10.0), 0.0);
  EXPECT_NEAR(body.tyre_x_mps2(), kGravity_mps2 * std::sin(20.0 * kDegree_rad), 1.0e-9);
  EXPECT_FALSE(body.slides());
}

// Uphill its wheels spin where mu cos a < sin a; where they hold, the drives have to be strong
// enough.
TEST(BodyOnGround, ClimbsWhatItsTyresAndItsDrivesCan) {
  BodyOnGround slippery(Stiff(), kBodyStep_s);
  slippery.SetGround(Uphill(20.0, 0.3));
  double speed_mps = 0.0;
  Roll(slippery, speed_mps, 2.0, 1.0);
  EXPECT_LT(speed_mps, 0.0);
  ChassisParams weak = Stiff();
  weak.drive_mps2 = 2.0;
  BodyOnGround heavy(weak, kBodyStep_s);
  heavy.SetGround(Uphill(20.0, 0.8));
  speed_mps = 0.0;
  Roll(heavy, speed_mps, 2.0, 1.0);
  EXPECT_LT(speed_mps, 0.0);
  BodyOnGround climbs(Stiff(), kBodyStep_s);
  climbs.SetGround(Uphill(20.0, 0.8));
  speed_mps = 0.0;
  Roll(climbs, speed_mps, 2.0, 2.0);
  EXPECT_NEAR(speed_mps, 2.0, 1.0e-9);
}

// g sin b > mu g cos b: it slides with the difference, and stops where the ground holds again.
TEST(BodyOnGround, SlidesSidewaysOffASteepSideSlope) {
  BodyOnGround body(Stiff(), kBodyStep_s);
  body.SetGround(LeftUp(30.0, 0.4));
  double speed_mps = 0.0;
  Roll(body, speed_mps, 0.0, 1.0);
  const double slides_mps2 =
      kGravity_mps2 * (std::sin(30.0 * kDegree_rad) - 0.4 * std::cos(30.0 * kDegree_rad));
  EXPECT_NEAR(body.slip_left_mps(), -slides_mps2, 1.0e-6);
  EXPECT_TRUE(body.slides());
  body.SetGround(LeftUp(10.0, 0.4));
  Roll(body, speed_mps, 0.0, 1.0);
  EXPECT_EQ(body.slip_left_mps(), 0.0);
}

// v w against mu g: what is lacking drives it out of the turn.
TEST(BodyOnGround, SlidesOutOfATurnThatIsTooFast) {
  BodyOnGround body(Stiff(), kBodyStep_s);
  body.SetGround({.friction = 0.3});
  double speed_mps = 4.0;
  for (int i = 0; i < 500; ++i) speed_mps = body.Along(speed_mps, speed_mps, 1.0);
  EXPECT_NEAR(body.slip_left_mps(), -0.5 * (4.0 - 0.3 * kGravity_mps2), 0.01);
}

// What holds it across is missing along.
TEST(BodyOnGround, BrakesLessOnASideSlope) {
  BodyOnGround body(Stiff(), kBodyStep_s);
  body.SetGround(LeftUp(20.0, 0.5));
  double speed_mps = 5.0;
  Roll(body, speed_mps, 0.0, 0.001);
  const double most = 0.5 * std::cos(20.0 * kDegree_rad);
  const double across = std::sin(20.0 * kDegree_rad);
  EXPECT_NEAR(-body.tyre_x_mps2(), kGravity_mps2 * std::sqrt(most * most - across * across),
              1.0e-9);
}

// tan b = B / (2 h): 51.2 degrees for 1.12 m and 0.45 m.
TEST(BodyOnGround, TipsWhereTheLoadLeavesTheWheelsAbove) {
  const double tips_deg = std::atan(1.12 / 0.9) / kDegree_rad;
  for (const double off_deg : {-0.5, 0.5}) {
    BodyOnGround body(Stiff(), kBodyStep_s);
    body.SetGround(LeftUp(tips_deg + off_deg, 5.0));
    double speed_mps = 0.0;
    Roll(body, speed_mps, 0.0, 0.01);
    EXPECT_EQ(body.tipping() >= 1.0, off_deg > 0.0) << body.tipping();
  }
  BodyOnGround body(Stiff(), kBodyStep_s);
  body.SetGround({.friction = 5.0});
  static_cast<void>(body.Along(4.0, 4.0, 3.2));  // 12.8 m/s^2 > g B / (2 h) = 12.2
  EXPECT_GE(body.tipping(), 1.0);
}

TEST(BodyOnGround, CreepsUnderLoad) {
  ChassisParams chassis = Stiff();
  chassis.tyre_slip = 0.06;
  chassis.side_slip_rad = 0.1;
  chassis.tyre_arm_m = 0.36;
  BodyOnGround body(chassis, kBodyStep_s);
  body.SetGround(Uphill(15.0, 0.6));
  double speed_mps = 2.0;
  for (int i = 0; i < 3000; ++i) speed_mps = body.Along(speed_mps, body.Crept(2.0), 0.0);
  EXPECT_NEAR(speed_mps, 2.0 * (1.0 - 0.06 * std::tan(15.0 * kDegree_rad) / 0.6), 1.0e-3);
  body.SetGround(LeftUp(15.0, 0.6));
  speed_mps = body.Along(2.0, 2.0, 0.0);
  EXPECT_NEAR(body.slip_left_mps(), -0.1 * 2.0 * std::tan(15.0 * kDegree_rad) / 0.6, 1.0e-3);
  speed_mps = body.Along(0.0, 0.0, 0.5);
  EXPECT_NEAR(body.slip_left_mps(), -0.36 * 0.5 * std::tan(15.0 * kDegree_rad) / 0.6, 1.0e-3);
}

TEST(BodyOnGround, IsMirroredExactly) {
  BodyOnGround left(ChassisParams{}, kBodyStep_s);
  BodyOnGround right(ChassisParams{}, kBodyStep_s);
  left.SetGround(LeftUp(14.0, 0.45));
  right.SetGround(LeftUp(-14.0, 0.45));
  double left_mps = 1.0;
  double right_mps = 1.0;
  for (int i = 0; i < 500; ++i) {
    left_mps = left.Along(left_mps, 3.0, 0.8);
    right_mps = right.Along(right_mps, 3.0, -0.8);
    ASSERT_EQ(left_mps, right_mps);
    ASSERT_EQ(left.slip_left_mps(), -right.slip_left_mps());
  }
}

// The models on it: a skid-steered vehicle's wheels go on turning while it slides.
TEST(BodyOnGround, WheelsSpinWhereFrictionEnds) {
  VehicleModel model(VehicleModelParams{});
  model.SetGround(Uphill(20.0, 0.3));
  for (int i = 0; i < 2000; ++i) model.Step({.speeds = {6.0, 6.0}});
  EXPECT_GT(model.wheels().common_radps(), 5.5);
  EXPECT_LT(model.speed_mps(), 0.0);
  EXPECT_TRUE(model.body().slides());
}

TEST(BodyOnGround, ASteeredVehicleBrakesNoHarderThanItsTyresHold) {
  SteeredModelParams params;
  SteeredModel model(params, {}, VehicleModel::kStep_s);
  model.SetGround({.friction = 0.9});
  for (int i = 0; i < 8000; ++i) model.Step({true, 3.0, 0.0});
  EXPECT_NEAR(model.speed_mps(), 3.0, 0.05);
  model.SetGround({.friction = 0.1});
  const double before_mps = model.speed_mps();
  for (int i = 0; i < 500; ++i) model.Step({false, 0.0, 0.0});  // its brake holds
  EXPECT_NEAR(model.speed_mps(), before_mps - 0.5 * 0.1 * kGravity_mps2, 1.0e-3);
  EXPECT_NEAR(model.measured_speed_mps(), 3.0 - 0.5 * params.max_deceleration_mps2, 1.0e-3);
}

}  // namespace
}  // namespace hardpack::sim
