// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// What an operator may do at any time, in any order.

namespace hardpack {
namespace {

using control::GoalFrame;
using control::Kind;
using testing::ClosedLoop;

constexpr double kHalfTurn_rad = 3.14159265358979;

double YawRate(ClosedLoop& drive) {
  return std::fabs(drive.vehicle().vehicle().yaw_rate_radps());
}

// SR-SUP04
TEST(VehicleLoopOperator, AStopDropsAGoalThatStillWaitsForItsPlan) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(20.0f, 0.0f), Status::kOk);
  ASSERT_EQ(drive.mode(), Mode::kArmed);
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  EXPECT_EQ(drive.loop().goals(), 0);
  for (int tick = 0; tick < 300; ++tick) {
    ASSERT_EQ(drive.Tick(), Status::kOk);
    ASSERT_EQ(drive.mode(), Mode::kArmed);
  }
  EXPECT_NEAR(drive.Pose().x_m, 0.0, 0.01);
}

// The path to the first goal is followed until there is one to the second: no brake, no jump.
TEST(VehicleLoopOperator, ANewGoalWhileDrivingIsDrivenToWithoutAStop) {
  ClosedLoop drive;
  drive.DriveTo(40.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 1.5; }));
  float before_mps = drive.loop().tracking().speed_mps;
  ASSERT_EQ(drive.Goal(25.0f, 1.5f), Status::kOk);
  for (int tick = 0; tick < 150; ++tick) {
    ASSERT_EQ(drive.loop().permission().motion, Motion::kFollow) << "tick " << tick;
    ASSERT_LT(std::fabs(drive.loop().tracking().speed_mps - before_mps), 0.1f) << "tick " << tick;
    before_mps = drive.loop().tracking().speed_mps;
    ASSERT_EQ(drive.Tick(), Status::kOk);
  }
  ASSERT_TRUE(drive.Until(40.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 25.0, 0.7);
  EXPECT_NEAR(drive.Pose().y_m, 1.5, 0.7);
}

// Given when the vehicle is as good as at the first one.
TEST(VehicleLoopOperator, ANewGoalIsNotReachedAtTheEndOfTheOldPath) {
  ClosedLoop drive;
  drive.DriveTo(8.0f, 0.0f);
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.Pose().x_m > 7.6; }));
  ASSERT_EQ(drive.mode(), Mode::kDriving);
  ASSERT_EQ(drive.Goal(14.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(40.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 14.0, 0.7);
}

TEST(VehicleLoopOperator, AGoalWithAHeadingIsReached) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 1;
  command.waypoint[0].position_m = {6.0f, 0.0f};
  command.has_heading = true;
  command.heading_rad = 1.5f;
  ASSERT_EQ(drive.Say(command), Status::kOk);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  EXPECT_TRUE(drive.Until(60.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 6.0, 0.7);
  EXPECT_NEAR(drive.Pose().theta_rad, 1.5, 0.25);
}

// SR-SUP08
TEST(VehicleLoopOperator, AStopEndsATurnOnTheSpot) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(-6.0f, 0.0f, GoalFrame::kBody), Status::kOk);
  ASSERT_TRUE(drive.Until(10.0, [&] { return YawRate(drive) > 0.4; }));
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  EXPECT_EQ(drive.loop().drives().commanded().left_radps, 0.0f);
  EXPECT_EQ(drive.loop().drives().commanded().right_radps, 0.0f);
  EXPECT_TRUE(drive.Until(4.0, [&] { return drive.mode() == Mode::kArmed; }));
  drive.Ticks(200);
  EXPECT_LT(YawRate(drive), 0.02);
  EXPECT_LT(std::fabs(drive.Pose().theta_rad), kHalfTurn_rad - 0.5);
}

TEST(VehicleLoopOperator, AGoalBehindIsDrivenTo) {
  ClosedLoop drive;
  drive.DriveTo(12.0f, 0.0f);
  ASSERT_TRUE(drive.Until(30.0, [&] { return drive.mode() == Mode::kArmed; }));
  ASSERT_EQ(drive.Goal(-8.0f, 0.0f, GoalFrame::kBody), Status::kOk);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  ASSERT_TRUE(drive.Until(60.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 4.0, 1.0);
  EXPECT_FALSE(drive.vehicle().collided());
}

// Not for ever on the way to where it stands.
TEST(VehicleLoopOperator, AGoalAtTheVehiclesOwnPlaceIsReached) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(0.05f, 0.0f, GoalFrame::kBody), Status::kOk);
  EXPECT_TRUE(drive.Until(10.0, [&] { return drive.loop().goals() == 0; }));
  EXPECT_EQ(drive.mode(), Mode::kArmed);
  EXPECT_NEAR(drive.Pose().x_m, 0.0, 0.6);
}

//   start ------ [box, 1st waypoint in it]     2nd
TEST(VehicleLoopOperator, AWaypointThatCannotBeReachedIsPassed) {
  // Of a larger one the middle is taken for free until it has been seen from all sides
  // (docs/safety.md, what it does not see).
  ClosedLoop drive("at 0 box 9 0 1.6 1.6");
  drive.BringUpAndArm();
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 2;
  command.waypoint[0].position_m = {9.0f, 0.0f};
  command.waypoint[1].position_m = {18.0f, 0.0f};
  ASSERT_EQ(drive.Say(command), Status::kOk);
  EXPECT_TRUE(drive.Until(60.0, [&] { return drive.loop().goal_index() == 1; }));
  EXPECT_FALSE(drive.vehicle().collided());
}

// SR-SUP02
TEST(VehicleLoopOperator, IsNotArmedBeforeItStandsAndForgetsThePathOfBefore) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  ASSERT_EQ(drive.Say(Kind::kEmergencyStop), Status::kOk);
  ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  ASSERT_GT(drive.Speed_mps(), 1.0);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kMoving);
  EXPECT_EQ(drive.loop().goals(), 0);
  ASSERT_TRUE(drive.Until(6.0, [&] { return drive.loop().drives().standstill(); }));
  drive.Ticks(100);
  ASSERT_EQ(drive.Say(Kind::kArm), Status::kOk);
  const double x_m = drive.Pose().x_m;
  drive.Ticks(300);
  EXPECT_NEAR(drive.Pose().x_m, x_m, 0.02);
  EXPECT_EQ(drive.mode(), Mode::kArmed);
}

// SR-SUP08
TEST(VehicleLoopOperator, DisarmingWhileDrivingEndsInStandbyWithTheDrivesOff) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  EXPECT_EQ(drive.Goal(60.0f, 0.0f), Status::kNotPermitted);
  ASSERT_TRUE(drive.Until(8.0, [&] { return drive.mode() == Mode::kStandby; }));
  drive.Ticks(200);
  EXPECT_FALSE(drive.loop().drives().enabled());
  EXPECT_LT(std::fabs(drive.Speed_mps()), 0.02);
}

// Whatever it is told, in any order: the speed that is commanded while a path is followed changes
// by no more than the ramps, and nothing turns or drives in a mode that does not allow it.
// SR-CMD02
TEST(VehicleLoopOperator, TheCommandNeverJumpsWhateverIsSaid) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  const SpeedParams& limits = drive.config().planner.speed;
  const float most_mps =
      1.01f * 0.01f * std::max(limits.max_acceleration_mps2, limits.max_deceleration_mps2);
  float before_mps = 0.0f;
  int moved = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    switch (tick) {
      case 10:
      case 1000:
        ASSERT_EQ(drive.Goal(25.0f, 1.0f), Status::kOk) << "tick " << tick;
        break;
      case 200:
        ASSERT_EQ(drive.Goal(22.0f, -1.0f), Status::kOk) << "tick " << tick;
        break;
      case 230:
        ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk) << "tick " << tick;
        break;
      case 1250:
        ASSERT_EQ(drive.Goal(0.0f, 0.0f), Status::kOk) << "tick " << tick;
        break;
      case 2000:
        ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk) << "tick " << tick;
        break;
      default:
        ASSERT_EQ(drive.Tick(), Status::kOk);
    }
    const float speed_mps = drive.loop().tracking().speed_mps;
    const Motion motion = drive.loop().permission().motion;
    if (motion == Motion::kFollow || motion == Motion::kStopAlong) {
      ASSERT_LE(std::fabs(speed_mps - before_mps), most_mps) << "tick " << tick;
      moved += speed_mps > 0.5f ? 1 : 0;
    } else {
      ASSERT_EQ(speed_mps, 0.0f) << "tick " << tick;
      ASSERT_EQ(drive.loop().drives().commanded().left_radps, 0.0f) << "tick " << tick;
    }
    before_mps = speed_mps;
  }
  EXPECT_GT(moved, 300);
  EXPECT_EQ(drive.mode(), Mode::kStandby);
}

// SR-STP06: whoever gives a goal and leaves is missed: without a press for 3 s the vehicle stops.
// A program that was left over says the same press for ever, or none, which proves nothing.
TEST(VehicleLoopOperator, AProgramThatIsLeftOverIsNobody) {
  for (const uint32_t left_over : {0u, 77u}) {
    SCOPED_TRACE(left_over);
    ClosedLoop drive;
    VehicleConfig config = drive.config();
    config.onboard.safety.operator_timeout_s = SafetyParams{}.operator_timeout_s;
    ASSERT_EQ(config.onboard.safety.operator_timeout_s, 3.0f);
    ASSERT_EQ(drive.loop().Configure(config), Status::kOk);
    drive.BringUpAndArm();
    ASSERT_EQ(drive.Goal(60.0f, 0.0f), Status::kOk);
    control::OperatorCommand alive;
    alive.kind = Kind::kAlive;
    alive.press = 70;
    for (int tick = 0; tick < 800; ++tick) {
      if (tick % 100 == 0) {
        ++alive.press;
        ASSERT_EQ(drive.Say(alive), Status::kOk);
      } else {
        ASSERT_EQ(drive.Tick(), Status::kOk);
      }
    }
    ASSERT_EQ(drive.mode(), Mode::kDriving);
    ASSERT_GT(drive.Speed_mps(), 2.0);
    alive.press = 77;
    ASSERT_EQ(drive.Say(alive), Status::kOk);
    alive.press = left_over;
    int ticks = 0;
    for (; ticks < 400 && drive.mode() == Mode::kDriving; ++ticks) {
      ASSERT_EQ(drive.Say(alive), Status::kOk);
    }
    EXPECT_NEAR(ticks, 300, 3);
    EXPECT_EQ(drive.mode(), Mode::kSafeStop);
    EXPECT_EQ(drive.reason(), StopReason::kOperatorSilent);
  }
}

}  // namespace
}  // namespace hardpack
