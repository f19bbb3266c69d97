// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// A list of waypoints, driven; paused, resumed and skipped.

namespace hardpack {
namespace {

using control::Kind;
using testing::ClosedLoop;

control::OperatorCommand Mission(std::initializer_list<Vec2> places) {
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  for (const Vec2& place : places) command.waypoint[command.waypoints++].position_m = place;
  return command;
}

// Brought up, and on its way faster than 1.5 m/s.
void SetOut(ClosedLoop& drive, const control::OperatorCommand& mission) {
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Say(mission), Status::kOk);
  ASSERT_TRUE(drive.Until(15.0, [&] { return drive.Speed_mps() > 1.5; }));
}

bool IsArmed(ClosedLoop& drive) {
  return drive.mode() == Mode::kArmed;
}

bool Stands(ClosedLoop& drive) {
  return drive.loop().drives().standstill();
}

// SR-MIS05
TEST(Mission, WaypointsArePassedWithoutSlowingDown) {
  ClosedLoop drive;
  SetOut(drive, Mission({{8.0f, 0.5f}, {14.0f, 0.0f}, {20.0f, -0.5f}, {28.0f, 0.0f}}));
  double slowest_mps = 1e9;
  int passed = 0;
  ASSERT_TRUE(drive.Until(40.0, [&] {
    if (drive.Pose().x_m < 23.0) slowest_mps = std::min(slowest_mps, drive.Speed_mps());
    if (drive.loop().goals() > 0) passed = std::max(passed, drive.loop().goal_index());
    return IsArmed(drive);
  }));
  EXPECT_EQ(passed, 3);
  EXPECT_GT(slowest_mps, 1.4);
  EXPECT_NEAR(drive.Pose().x_m, 28.0, 0.7);
  EXPECT_FALSE(drive.loop().may_resume()) << "it is done";
}

TEST(Mission, AWaypointToStopAtIsStoodAtForItsTime) {
  ClosedLoop drive;
  control::OperatorCommand mission = Mission({{6.0f, 0.0f}, {9.0f, 0.0f}, {14.0f, 0.0f}});
  mission.waypoint[0].stops = true;
  mission.waypoint[0].hold_s = 3;
  mission.waypoint[1].stops = true;
  SetOut(drive, mission);
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().at_waypoint(); }));
  EXPECT_TRUE(Stands(drive));
  EXPECT_NEAR(drive.Pose().x_m, 6.0, 0.6);
  const double x_m = drive.Pose().x_m;
  for (int tick = 0; tick < 298; ++tick) {
    ASSERT_EQ(drive.Tick(), Status::kOk);
    ASSERT_EQ(drive.reason(), StopReason::kAtWaypoint) << tick;
    ASSERT_EQ(drive.loop().goal_index(), 0);
  }
  EXPECT_NEAR(drive.Pose().x_m, x_m, 0.02);
  drive.Ticks(5);
  EXPECT_EQ(drive.loop().goal_index(), 1);
  EXPECT_FALSE(drive.loop().at_waypoint());
  // The second one without a time: a stop all the same.
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().goal_index() == 2; }));
  EXPECT_TRUE(Stands(drive));
  EXPECT_NEAR(drive.Pose().x_m, 9.0, 0.6);
  ASSERT_TRUE(drive.Until(20.0, [&] { return IsArmed(drive); }));
  EXPECT_NEAR(drive.Pose().x_m, 14.0, 0.6);
}

// SR-MIS04
TEST(Mission, TheLimitOfALegIsKept) {
  ClosedLoop drive;
  control::OperatorCommand mission = Mission({{8.0f, 0.0f}, {20.0f, 0.0f}});
  mission.waypoint[0].speed_dmps = 8;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Say(mission), Status::kOk);
  double fastest_mps = 0.0;
  double fastest_reference_mps = 0.0;
  ASSERT_TRUE(drive.Until(40.0, [&] {
    // The tracker makes up for a lag that these drives do not have: they overshoot at first.
    const double x_m = drive.Pose().x_m;
    if (x_m > 3.0 && x_m < 7.9) fastest_mps = std::max(fastest_mps, drive.Speed_mps());
    if (x_m < 7.5) {
      fastest_reference_mps =
          std::max(fastest_reference_mps, double{drive.loop().tracking().speed_mps});
    }
    return drive.loop().goal_index() == 1;
  }));
  EXPECT_LE(fastest_reference_mps, 0.8001);
  EXPECT_LE(fastest_mps, 0.81);
  EXPECT_GT(fastest_mps, 0.75);
  EXPECT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 1.5; }));
}

// SR-MIS02
TEST(Mission, APauseStopsAlongThePathAndAResumeDrivesOn) {
  ClosedLoop drive;
  SetOut(drive, Mission({{12.0f, 0.0f}, {24.0f, 0.0f}}));
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk);
  EXPECT_TRUE(drive.loop().paused());
  ASSERT_EQ(drive.loop().permission().motion, Motion::kStopAlong);
  EXPECT_EQ(drive.reason(), StopReason::kPaused);
  ASSERT_TRUE(drive.Until(6.0, [&] { return Stands(drive); }));
  EXPECT_EQ(drive.mode(), Mode::kDriving);
  EXPECT_EQ(drive.loop().goals(), 2);
  drive.Ticks(100);
  const double x_m = drive.Pose().x_m;
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk) << "twice is once";
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_EQ(drive.Tick(), Status::kOk);
    ASSERT_EQ(drive.reason(), StopReason::kPaused) << tick;
  }
  EXPECT_NEAR(drive.Pose().x_m, x_m, 0.02);
  ASSERT_EQ(drive.Say(Kind::kResume), Status::kOk);
  EXPECT_FALSE(drive.loop().paused());
  ASSERT_EQ(drive.Say(Kind::kResume), Status::kOk) << "twice is once";
  ASSERT_TRUE(drive.Until(40.0, [&] { return IsArmed(drive); }));
  EXPECT_NEAR(drive.Pose().x_m, 24.0, 0.7);
  EXPECT_FALSE(drive.vehicle().collided());
}

// SR-MIS02
TEST(Mission, APausedGoalThatWaitsForItsPlanIsNotSetOutFor) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(15.0f, 0.0f), Status::kOk);
  ASSERT_EQ(drive.mode(), Mode::kArmed);
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk);
  for (int tick = 0; tick < 500; ++tick) {
    ASSERT_EQ(drive.Tick(), Status::kOk);
    ASSERT_EQ(drive.mode(), Mode::kArmed) << tick;
  }
  EXPECT_EQ(drive.reason(), StopReason::kPaused);
  EXPECT_NEAR(drive.Pose().x_m, 0.0, 0.01);
  ASSERT_EQ(drive.Say(Kind::kResume), Status::kOk);
  EXPECT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
}

TEST(Mission, ANewGoalEndsAPause) {
  ClosedLoop drive;
  SetOut(drive, Mission({{24.0f, 0.0f}}));
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk);
  ASSERT_TRUE(drive.Until(6.0, [&] { return Stands(drive); }));
  ASSERT_EQ(drive.Goal(12.0f, 0.0f), Status::kOk);
  EXPECT_FALSE(drive.loop().paused());
  EXPECT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 0.5; }));
}

// SR-MIS03
TEST(Mission, IsResumedAfterAStopThatHasEnded) {
  ClosedLoop drive;
  SetOut(drive, Mission({{5.0f, 0.0f}, {12.0f, 0.0f}, {20.0f, 0.0f}}));
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().goal_index() == 1; }));
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  EXPECT_EQ(drive.Say(Kind::kResume), Status::kNotPermitted) << "it has not come to rest";
  EXPECT_EQ(drive.output().reason, StopReason::kOperator);
  ASSERT_TRUE(drive.Until(6.0, [&] { return IsArmed(drive); }));
  drive.Ticks(200);
  EXPECT_EQ(drive.loop().goals(), 0) << "nothing is driven to";
  EXPECT_EQ(drive.mode(), Mode::kArmed);
  EXPECT_TRUE(drive.loop().may_resume());
  EXPECT_EQ(drive.Say(Kind::kPause), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kNoMission);
  EXPECT_EQ(drive.Say(Kind::kSkip), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kNoMission);
  ASSERT_EQ(drive.Say(Kind::kResume), Status::kOk);
  EXPECT_EQ(drive.loop().goals(), 3);
  EXPECT_EQ(drive.loop().goal_index(), 1) << "with the waypoint that it was on its way to";
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  ASSERT_TRUE(drive.Until(40.0, [&] { return IsArmed(drive); }));
  EXPECT_NEAR(drive.Pose().x_m, 20.0, 0.7);
  EXPECT_EQ(drive.Say(Kind::kResume), Status::kNotPermitted) << "it is done";
  EXPECT_EQ(drive.output().reason, StopReason::kNoMission);
}

// SR-MIS03
TEST(Mission, IsResumedAfterAStopForOldInput) {
  ClosedLoop drive;
  SetOut(drive, Mission({{12.0f, 0.0f}, {24.0f, 0.0f}}));
  drive.Act("at 0 lidar off");
  ASSERT_TRUE(drive.Until(3.0, [&] { return drive.mode() == Mode::kSafeStop; }));
  ASSERT_TRUE(drive.Until(8.0, [&] { return IsArmed(drive); }));
  drive.Act("at 0 lidar on");
  drive.Ticks(300);
  EXPECT_EQ(drive.mode(), Mode::kArmed) << "not by itself";
  ASSERT_EQ(drive.Say(Kind::kResume), Status::kOk);
  EXPECT_TRUE(drive.Until(8.0, [&] { return drive.Speed_mps() > 1.0; }));
}

// SR-MIS03
TEST(Mission, EndsWhereSomebodyDisarmsOrStopsAtOnce) {
  for (const Kind end : {Kind::kDisarm, Kind::kEmergencyStop}) {
    SCOPED_TRACE(static_cast<int>(end));
    ClosedLoop drive;
    SetOut(drive, Mission({{24.0f, 0.0f}}));
    ASSERT_EQ(drive.Say(end), Status::kOk);
    EXPECT_EQ(drive.Say(Kind::kResume), Status::kNotPermitted);
    ASSERT_TRUE(drive.Until(8.0, [&] { return Stands(drive); }));
    drive.Ticks(200);
    ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
    ASSERT_EQ(drive.mode(), Mode::kStandby);
    EXPECT_EQ(drive.Say(Kind::kPause), Status::kNotPermitted);
    ASSERT_TRUE(drive.Until(3.0, [&] { return drive.Say(Kind::kArm) == Status::kOk; }));
    EXPECT_EQ(drive.Say(Kind::kResume), Status::kNotPermitted);
    EXPECT_EQ(drive.output().reason, StopReason::kNoMission);
    EXPECT_FALSE(drive.loop().may_resume());
  }
}

TEST(Mission, ASkippedWaypointIsLeftOutAndTheLastOneCannotBe) {
  ClosedLoop drive;
  SetOut(drive, Mission({{14.0f, 4.0f}, {20.0f, 0.0f}}));
  ASSERT_EQ(drive.Say(Kind::kSkip), Status::kOk);
  EXPECT_EQ(drive.loop().goal_index(), 1);
  EXPECT_EQ(drive.Say(Kind::kSkip), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kLastWaypoint);
  EXPECT_EQ(drive.loop().goal_index(), 1);
  double farthest_m = 0.0;
  ASSERT_TRUE(drive.Until(40.0, [&] {
    farthest_m = std::max(farthest_m, drive.Pose().y_m);
    return IsArmed(drive);
  }));
  EXPECT_LT(farthest_m, 2.0);
  EXPECT_NEAR(drive.Pose().x_m, 20.0, 0.7);
}

TEST(Mission, ASkipEndsAHold) {
  ClosedLoop drive;
  control::OperatorCommand mission = Mission({{6.0f, 0.0f}, {14.0f, 0.0f}});
  mission.waypoint[0].stops = true;
  mission.waypoint[0].hold_s = 255;
  SetOut(drive, mission);
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().at_waypoint(); }));
  ASSERT_EQ(drive.Say(Kind::kSkip), Status::kOk);
  EXPECT_FALSE(drive.loop().at_waypoint());
  EXPECT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 0.5; }));
}

TEST(Mission, IsRefusedBeforeTheVehicleIsArmed) {
  ClosedLoop drive;
  for (const Kind kind : {Kind::kPause, Kind::kResume, Kind::kSkip}) {
    EXPECT_EQ(drive.Say(kind), Status::kNotPermitted);
    EXPECT_NE(drive.output().reason, StopReason::kNone);
  }
  drive.BringUpAndArm();
  for (const Kind kind : {Kind::kPause, Kind::kResume, Kind::kSkip}) {
    EXPECT_EQ(drive.Say(kind), Status::kNotPermitted);
    EXPECT_EQ(drive.output().reason, StopReason::kNoMission);
  }
}

//   out and back: the corner cannot be passed, so the vehicle comes to rest there
TEST(Mission, ASharpCornerIsTurnedAtOnTheSpot) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Say(Mission({{8.0f, 0.0f}, {2.0f, 0.0f}})), Status::kOk);
  ASSERT_TRUE(drive.Until(30.0, [&] { return drive.loop().goal_index() == 1; }));
  EXPECT_NEAR(drive.Pose().x_m, 8.0, 0.7);
  ASSERT_TRUE(drive.Until(60.0, [&] { return IsArmed(drive); }));
  EXPECT_NEAR(drive.Pose().x_m, 2.0, 0.7);
}

}  // namespace
}  // namespace hardpack
