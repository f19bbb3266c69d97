// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "test/core/areas/polygon.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// Areas from the operator's message to the wheels.

namespace hardpack {
namespace {

using control::Kind;
using testing::AreaOf;
using testing::Box;
using testing::ClosedLoop;

// The status of the last one that was sent.
Status Send(ClosedLoop& drive, const std::vector<Area>& areas) {
  control::OperatorCommand command;
  command.kind = Kind::kArea;
  command.area_count = static_cast<int32_t>(areas.size());
  Status status = Status::kOk;
  for (size_t i = 0; i < areas.size() && IsUsable(status); ++i) {
    command.area_index = static_cast<int32_t>(i);
    command.area = areas[i];
    status = drive.Say(command);
  }
  return status;
}

control::OperatorCommand MissionAlong(std::initializer_list<Vec2> places) {
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  for (const Vec2& place : places) command.waypoint[command.waypoints++].position_m = place;
  return command;
}

// The outline as it is in the world, where odom begins too.
bool IsBreachedNow(ClosedLoop& drive, const Area& area) {
  const Footprint footprint = FootprintOf(drive.config().planner.vehicle);
  const sim::Pose pose = drive.Pose();
  return IsBreached(area, footprint,
                    {static_cast<float>(pose.x_m), static_cast<float>(pose.y_m),
                     static_cast<float>(pose.theta_rad)});
}

// SR-ARE02
TEST(VehicleLoopAreas, DrivesAroundAKeepOutAreaInsideAFence) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  const Area keep_out = AreaOf(AreaKind::kKeepOut, Box(8, -1, 11, 7));
  const Area fence = AreaOf(AreaKind::kFence, Box(-4, -8, 24, 8));
  ASSERT_EQ(Send(drive, {keep_out, fence}), Status::kOk);
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(19.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  double aside_m = 0.0;
  ASSERT_TRUE(drive.Until(60.0, [&] {
    EXPECT_FALSE(IsBreachedNow(drive, keep_out) || IsBreachedNow(drive, fence));
    aside_m = std::min(aside_m, drive.Pose().y_m);
    return drive.mode() == Mode::kArmed;
  })) << static_cast<int>(drive.reason());
  EXPECT_NEAR(drive.Pose().x_m, 19.0, 0.7);
  EXPECT_LT(aside_m, -1.5);
}

// SR-ARE05
TEST(VehicleLoopAreas, IsSlowWhileItsOutlineIsInAZone) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  const Area zone = AreaOf(AreaKind::kSpeedZone, Box(12, -5, 18, 5), 1.0f);
  ASSERT_EQ(Send(drive, {zone}), Status::kOk);
  drive.DriveTo(35.0f, 0.0f);
  const Footprint footprint = FootprintOf(drive.config().planner.vehicle);
  double before_mps = 0.0;
  double within_mps = 0.0;
  ASSERT_TRUE(drive.Until(60.0, [&] {
    const sim::Pose pose = drive.Pose();
    const bool is_in = IsTouched(zone, footprint,
                                 {static_cast<float>(pose.x_m), static_cast<float>(pose.y_m),
                                  static_cast<float>(pose.theta_rad)},
                                 0.0f, 0.0f);
    double& fastest_mps = is_in ? within_mps : before_mps;
    fastest_mps = std::max(fastest_mps, drive.Speed_mps());
    return drive.mode() == Mode::kArmed;
  }));
  EXPECT_GT(before_mps, 1.8);
  EXPECT_GT(within_mps, 0.8);
  EXPECT_LT(within_mps, 1.08) << "what the speed control overshoots by";
}

// SR-ARE04
TEST(VehicleLoopAreas, DoesNotArmBeforeAllAreasAreThere) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  drive.Ticks(30);
  control::OperatorCommand command;
  command.kind = Kind::kArea;
  command.area_count = 2;
  command.area = AreaOf(AreaKind::kKeepOut, Box(8, -1, 11, 7));
  ASSERT_EQ(drive.Say(command), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kAreaUnknown);
  command.area_index = 1;
  command.area = AreaOf(AreaKind::kKeepOut, {{0, 0}, {4, 4}, {4, 0}, {0, 4}});
  EXPECT_EQ(drive.Say(command), Status::kAreaNotSimple);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  command.area = AreaOf(AreaKind::kKeepOut, Box(14, -1, 15, 7));
  EXPECT_EQ(drive.Say(command), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kOk);
}

// SR-ARE03
TEST(VehicleLoopAreas, AVehicleWhereItMustNotBeIsNotArmedUntilTheAreasAreCleared) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  drive.Ticks(30);
  ASSERT_EQ(Send(drive, {AreaOf(AreaKind::kKeepOut, Box(-3, -3, 3, 3))}), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kAreaBreached);
  EXPECT_EQ(drive.loop().breached_area(), 0);
  ASSERT_EQ(Send(drive, {AreaOf(AreaKind::kFence, Box(5, 5, 30, 30))}), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kAreaBreached);
  ASSERT_EQ(drive.Say(Kind::kClearAreas), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kOk);
}

// The same polygon on earth, by where the vehicle believes that odom lies.
Area OnEarth(const MapFromOdom& map, Area area) {
  area.frame = AreaFrame::kEarth;
  const Pose2& odom = map.map_from_odom();
  const float c = std::cos(odom.theta_rad);
  const float s = std::sin(odom.theta_rad);
  for (int i = 0; i < area.corners; ++i) {
    AreaCorner& corner = area.corner[i];
    const float x_m = static_cast<float>(corner.x_mm) / 1000.0f;
    const float y_m = static_cast<float>(corner.y_mm) / 1000.0f;
    const Vec2 place = {odom.x_m + c * x_m - s * y_m, odom.y_m + s * x_m + c * y_m};
    EXPECT_EQ(map.plane().ToGeodetic(place, corner.latitude_ndeg, corner.longitude_ndeg),
              Status::kOk);
  }
  return area;
}

// An area on earth comes nearer, as its place is corrected, until it touches the vehicle. On the
// way it is dodged, and then waited for; once it is there, the goal is given up.
// SR-ARE03
TEST(VehicleLoopAreas, AVehicleThatFindsItselfWhereItMustNotBeStopsAtOnce) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] {
    return drive.loop().drives().ready() &&
           drive.loop().map_from_odom().status() == MapStatus::kTracking;
  }));
  drive.Ticks(100);
  const MapFromOdom& map = drive.loop().map_from_odom();
  const double side_m = double{FootprintOf(drive.config().planner.vehicle).half_width_m} + 1.0;
  const Area left = OnEarth(map, AreaOf(AreaKind::kKeepOut, Box(-9, side_m, 60, 30)));
  const Area right = OnEarth(map, AreaOf(AreaKind::kKeepOut, Box(-9, -30, 60, -side_m)));
  ASSERT_EQ(Send(drive, {left, right}), Status::kOk);
  drive.Ticks(10);
  EXPECT_TRUE(drive.loop().areas().is_known());
  drive.DriveTo(50.0f, 0.0f);
  // Nothing is taken while it drives.
  EXPECT_EQ(drive.Say(Kind::kClearAreas), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kMoving);
  EXPECT_EQ(drive.loop().areas().size(), 2);
  // Towards odom's +y, by 0.3 m each second.
  const float turn_rad = map.map_from_odom().theta_rad;
  drive.Act("at 0 ins-drift " + std::to_string(0.3 * std::cos(turn_rad)) + " " +
            std::to_string(-0.3 * std::sin(turn_rad)));
  ASSERT_TRUE(drive.Until(90.0, [&] { return drive.reason() == StopReason::kAreaBreached; }))
      << static_cast<int>(drive.reason());
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  EXPECT_EQ(drive.loop().permission().motion, Motion::kZero);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_EQ(drive.loop().goals(), 0);
  ASSERT_EQ(drive.Goal(70.0f, -1.0f), Status::kOk);
  drive.Ticks(300);
  EXPECT_EQ(drive.mode(), Mode::kArmed);
  EXPECT_EQ(drive.reason(), StopReason::kAreaBreached);
  ASSERT_EQ(drive.Say(Kind::kClearAreas), Status::kOk);
  drive.Ticks(300);
  EXPECT_EQ(drive.mode(), Mode::kArmed) << "the goal was dropped with the areas";
  EXPECT_EQ(drive.reason(), StopReason::kNone);
}

TEST(VehicleLoopAreas, ConfiguredAreasAreThereFromTheStartAndStay) {
  ClosedLoop drive("", world::World{});
  VehicleConfig config = drive.config();
  ASSERT_EQ(config.areas.PushBack(AreaOf(AreaKind::kKeepOut, Box(8, 2.2, 30, 9))), Status::kOk);
  ASSERT_EQ(drive.loop().Configure(config), Status::kOk);
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  drive.Ticks(30);
  ASSERT_EQ(Send(drive, {AreaOf(AreaKind::kKeepOut, Box(8, -9, 11, -2))}), Status::kOk);
  EXPECT_EQ(drive.loop().areas().size(), 2);
  ASSERT_EQ(drive.Say(Kind::kClearAreas), Status::kOk);
  EXPECT_EQ(drive.loop().areas().size(), 1);
  config.areas[0].corners = 2;
  EXPECT_EQ(drive.loop().Configure(config), Status::kInvalidArgument);
}

// SR-ARE06
TEST(VehicleLoopAreas, AGoalWhereItMustNotBeIsRefused) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  ASSERT_EQ(Send(drive, {AreaOf(AreaKind::kKeepOut, Box(8, -1, 11, 7)),
                         AreaOf(AreaKind::kFence, Box(-4, -8, 24, 8))}),
            Status::kOk);
  drive.BringUpAndArm();
  EXPECT_EQ(drive.Goal(9.0f, 0.0f), Status::kGoalForbidden);
  EXPECT_EQ(drive.Goal(30.0f, 0.0f), Status::kGoalForbidden);
  EXPECT_EQ(drive.loop().goals(), 0);
  EXPECT_EQ(drive.Goal(19.0f, 0.0f), Status::kOk);
  // New areas drop a goal that waits.
  EXPECT_EQ(drive.loop().goals(), 1);
  ASSERT_EQ(drive.mode(), Mode::kArmed);
  EXPECT_EQ(Send(drive, {AreaOf(AreaKind::kKeepOut, Box(8, -1, 11, 7))}), Status::kOk);
  EXPECT_EQ(drive.loop().goals(), 0);
}

// SR-ARE06
TEST(VehicleLoopAreas, AMissionWithOneWaypointWhereItMustNotBeIsRefused) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  ASSERT_EQ(Send(drive, {AreaOf(AreaKind::kKeepOut, Box(8, -1, 11, 7))}), Status::kOk);
  drive.BringUpAndArm();
  EXPECT_EQ(drive.Say(MissionAlong({{5.0f, 0.0f}, {9.0f, 0.0f}, {19.0f, 0.0f}})),
            Status::kGoalForbidden);
  EXPECT_EQ(drive.Say(MissionAlong({{5.0f, 0.0f}, {19.0f, 0.0f}, {9.0f, 3.0f}})),
            Status::kGoalForbidden);
  EXPECT_EQ(drive.loop().goals(), 0);
  EXPECT_FALSE(drive.loop().may_resume());
  EXPECT_EQ(drive.Say(MissionAlong({{5.0f, 0.0f}, {9.0f, -4.0f}, {19.0f, 0.0f}})), Status::kOk);
}

// SR-ARE02, SR-ARE05, SR-MIS04, SR-MIS05
TEST(VehicleLoopAreas, AMissionPassesItsWaypointsBesideAreasAndThroughAZone) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  const Area keep_out = AreaOf(AreaKind::kKeepOut, Box(10, -1, 12, 7));
  const Area zone = AreaOf(AreaKind::kSpeedZone, Box(20, -9, 24, 9), 1.0f);
  ASSERT_EQ(Send(drive, {keep_out, zone}), Status::kOk);
  drive.BringUpAndArm();
  control::OperatorCommand mission = MissionAlong({{6.0f, 0.0f}, {17.0f, -1.0f}, {34.0f, 0.0f}});
  mission.waypoint[2].speed_dmps = 15;
  ASSERT_EQ(drive.Say(mission), Status::kOk);
  const Footprint footprint = FootprintOf(drive.config().planner.vehicle);
  double within_mps = 0.0;
  double behind_mps = 0.0;
  ASSERT_TRUE(drive.Until(60.0, [&] {
    EXPECT_FALSE(IsBreachedNow(drive, keep_out));
    const sim::Pose pose = drive.Pose();
    const bool is_in = IsTouched(zone, footprint,
                                 {static_cast<float>(pose.x_m), static_cast<float>(pose.y_m),
                                  static_cast<float>(pose.theta_rad)},
                                 0.0f, 0.0f);
    if (is_in) within_mps = std::max(within_mps, drive.Speed_mps());
    if (pose.x_m > 27.0) behind_mps = std::max(behind_mps, drive.Speed_mps());
    return drive.mode() == Mode::kArmed && pose.x_m > 1.0;
  })) << static_cast<int>(drive.reason());
  EXPECT_NEAR(drive.Pose().x_m, 34.0, 0.7);
  EXPECT_GT(within_mps, 0.8);
  EXPECT_LT(within_mps, 1.08);
  EXPECT_GT(behind_mps, 1.3);
  EXPECT_LT(behind_mps, 1.62) << "the limit of the leg";
}

// On its way with a mission, and then stopped by the operator: at rest, and armed.
void StopOnTheWay(ClosedLoop& drive) {
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Say(MissionAlong({{12.0f, 0.0f}, {24.0f, 0.0f}})), Status::kOk);
  ASSERT_TRUE(drive.Until(15.0, [&] { return drive.Speed_mps() > 1.0; }));
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  ASSERT_TRUE(drive.Until(6.0, [&] { return drive.mode() == Mode::kArmed; }));
  drive.Ticks(100);
  ASSERT_TRUE(drive.loop().may_resume());
}

// SR-MIS03
TEST(VehicleLoopAreas, NoMissionIsResumedIntoAreasThatHaveChanged) {
  for (const bool clears : {false, true}) {
    SCOPED_TRACE(clears);
    ClosedLoop drive("", world::World{});
    StopOnTheWay(drive);
    const Area beside = AreaOf(AreaKind::kKeepOut, Box(8, 6, 11, 9));
    const Status changed = clears ? drive.Say(Kind::kClearAreas) : Send(drive, {beside});
    ASSERT_EQ(changed, Status::kOk);
    EXPECT_FALSE(drive.loop().may_resume());
    EXPECT_EQ(drive.Say(Kind::kResume), Status::kNotPermitted);
    EXPECT_EQ(drive.output().reason, StopReason::kNoMission);
    drive.Ticks(200);
    EXPECT_EQ(drive.mode(), Mode::kArmed);
    EXPECT_EQ(drive.loop().goals(), 0);
    EXPECT_EQ(drive.Goal(24.0f, 0.0f), Status::kOk) << "a new one is taken";
    EXPECT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  }
}

// A paused mission that drives keeps its areas, as any that drives.
TEST(VehicleLoopAreas, APauseDoesNotLetAreasChangeButDropsOneThatWaits) {
  ClosedLoop drive("", world::World{});
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(24.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(15.0, [&] { return drive.Speed_mps() > 1.0; }));
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk);
  ASSERT_TRUE(drive.Until(6.0, [&] { return drive.loop().drives().standstill(); }));
  EXPECT_EQ(drive.Say(Kind::kClearAreas), Status::kNotPermitted);
  EXPECT_EQ(drive.output().reason, StopReason::kMoving);
  EXPECT_TRUE(drive.loop().paused());
  EXPECT_EQ(drive.loop().goals(), 1);
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  ASSERT_TRUE(drive.Until(6.0, [&] { return drive.mode() == Mode::kArmed; }));
  ASSERT_EQ(drive.Say(Kind::kResume), Status::kOk);
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk);
  ASSERT_EQ(drive.mode(), Mode::kArmed);
  ASSERT_EQ(drive.Say(Kind::kClearAreas), Status::kOk);
  EXPECT_FALSE(drive.loop().paused());
  EXPECT_FALSE(drive.loop().may_resume());
  EXPECT_EQ(drive.loop().goals(), 0);
}

// An area on earth comes over the goal while the vehicle is on its way there.
// SR-ARE06, SR-MIS03
TEST(VehicleLoopAreas, AMissionIsNotResumedToWhereAnAreaForbidsItByThen) {
  ClosedLoop drive("", world::World{});
  ASSERT_TRUE(drive.Until(20.0, [&] {
    return drive.loop().drives().ready() &&
           drive.loop().map_from_odom().status() == MapStatus::kTracking;
  }));
  drive.Ticks(100);
  const MapFromOdom& map = drive.loop().map_from_odom();
  const Area left = OnEarth(map, AreaOf(AreaKind::kKeepOut, Box(55, 2, 80, 30)));
  const Area right = OnEarth(map, AreaOf(AreaKind::kKeepOut, Box(55, -30, 80, -2)));
  ASSERT_EQ(Send(drive, {left, right}), Status::kOk);
  drive.BringUpAndArm();
  control::OperatorCommand mission = MissionAlong({{70.0f, 0.0f}});
  mission.waypoint[0].speed_dmps = 10;
  ASSERT_EQ(drive.Say(mission), Status::kOk);
  ASSERT_TRUE(drive.Until(15.0, [&] { return drive.Speed_mps() > 0.8; }));
  const float turn_rad = map.map_from_odom().theta_rad;
  drive.Act("at 0 ins-drift " + std::to_string(0.3 * std::cos(turn_rad)) + " " +
            std::to_string(-0.3 * std::sin(turn_rad)));
  ASSERT_TRUE(drive.Until(50.0, [&] { return !drive.loop().areas().Permits({70.0f, 0.0f}); }));
  ASSERT_EQ(drive.Say(Kind::kPause), Status::kOk);
  EXPECT_EQ(drive.Say(Kind::kResume), Status::kGoalForbidden);
  EXPECT_TRUE(drive.loop().paused()) << "what is refused changes nothing";
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  ASSERT_TRUE(drive.Until(8.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_EQ(drive.Say(Kind::kResume), Status::kGoalForbidden);
  EXPECT_EQ(drive.loop().goals(), 0);
  EXPECT_TRUE(drive.loop().may_resume());
  drive.Ticks(200);
  EXPECT_EQ(drive.mode(), Mode::kArmed);
}

}  // namespace
}  // namespace hardpack
