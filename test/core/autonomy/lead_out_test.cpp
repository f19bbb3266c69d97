// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/lead_out.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "test/core/autonomy/random_outlines.h"

namespace hardpack {
namespace {

//   ##########
//   [ > ] - - - - (o)       a wall 0.2 m beside the left flank from x = -1 to 5 m
//              x            the goal behind it to the right
Scene WallBeside() {
  Scene scene = SceneTo({6.1f, -12.1f}, {0.1f, 0.1f, 0.0f});
  scene.Add(-5, 5, 25, 7);
  return scene;
}

// SR-STA01 no room to turn: out along the heading, then on
TEST(LeadOut, AStartBesideAWallWithoutRoomToTurnIsLeftAlongTheHeading) {
  const Scene scene = WallBeside();
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GT(plan.lead_points, 2);
  for (int k = 0; k < plan.lead_points; ++k) {
    EXPECT_LT(std::abs(plan.path[k].theta_rad), 0.35f) << "it does not turn beside the wall";
    EXPECT_LE(plan.speed[k], scene.params.speed.obstacle_start_speed_mps + 1e-4f);
  }
  const Pose2& out = plan.path[plan.lead_points];
  EXPECT_TRUE(PivotIsFree(ThePlanner().costmap(), scene.params.vehicle, scene.params.path,
                          {out.x_m, out.y_m}));
  EXPECT_NEAR(plan.path.back().x_m, 6.1f, 0.3f);
  EXPECT_NEAR(plan.path.back().y_m, -12.1f, 0.3f);
  EXPECT_EQ(plan.speed.size(), plan.path.size());
  EXPECT_EQ(plan.actuator.steps.size(), plan.path.size() - 1);
}

// What the check says is of the way out too, which is the nearest of it all.
// SR-GEO04
TEST(LeadOut, IsPartOfWhatTheCheckSays) {
  Scene scene = WallBeside();
  scene.request.start.pose.y_m = 0.2f;
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GT(plan.lead_points, 2);
  const double clearance_m = SweptOutline(scene, plan).Clearance_m();
  EXPECT_NEAR(clearance_m, 0.8 - 0.5 * double{scene.params.vehicle.width_m}, 0.005);
  EXPECT_NEAR(double{plan.check.smallest_clearance_m}, clearance_m, SweptOutline::kStep_m);
  EXPECT_LE(plan.check.smallest_clearance_point, plan.lead_points);
}

//   ##########
//         #               a cell of the wall that juts out by 0.2 m: straight on it would be
//   [ > ]                 touched by 9 cm, though not in its middle
// SR-GEO04
TEST(LeadOut, TouchesNoPartOfACellWhereItCanBend) {
  Scene scene = WallBeside();
  scene.Add(15, 4, 15, 4);
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_GT(plan.lead_points, 2);
  EXPECT_GT(SweptOutline(scene, plan).Clearance_m(), 0.0);
}

// A path's headings are those of its chords, from the start's own on, also on an arc.
// SR-STA01
TEST(LeadOut, DrivesABendAlongTheHeadingsThatItSays) {
  Scene scene = WallBeside();
  scene.Add(15, 4, 15, 4);
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GT(plan.lead_points, 2);
  ASSERT_GT(std::abs(plan.path[plan.lead_points - 1].theta_rad), 0.02f) << "not bent";
  EXPECT_EQ(plan.path[0].theta_rad, scene.request.start.pose.theta_rad);
  for (int k = 0; k < plan.lead_points; ++k) {
    const Pose2& from = plan.path[k];
    const Pose2& to = plan.path[k + 1];
    EXPECT_NEAR(std::atan2(to.y_m - from.y_m, to.x_m - from.x_m), from.theta_rad, 1e-3f) << k;
  }
}

// The same between two walls: where in its cell something stands the sweep of the motion knows, and
// the plan says how it is. What juts out further is in the way.
// SR-STA01
TEST(LeadOut, CellsLieAcrossAFlankWhereNoOtherWayIsLeft) {
  Scene scene = WallBeside();
  scene.Add(15, 4, 15, 4);
  scene.Add(-5, -5, 25, -5);
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kNarrowGap);
  EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), -double{PathCheck::kAcross_m});
  EXPECT_LT(plan.check.smallest_clearance_m, scene.params.path.margin_m);
  for (int k = 0; k < plan.lead_points; ++k) {
    EXPECT_LE(plan.speed[k], scene.params.speed.obstacle_start_speed_mps + 1e-4f);
  }
  scene.Add(15, 3, 15, 3);
  scene.params.path.reverse_out_m = 0.0f;
  EXPECT_FALSE(IsUsable(PlanIn(scene).status));
}

// Walls on both sides, nearer than the search keeps from them: from the middle no way falls.
// SR-STA01
TEST(LeadOut, AStartBetweenTwoWallsIsLeftStraightOn) {
  Scene scene = SceneTo({15.1f, 8.1f});
  scene.Add(-5, 4, 15, 6);
  scene.Add(-5, -5, 15, -4);
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_GT(plan.lead_points, 2);
  for (int k = 0; k < plan.lead_points; ++k) EXPECT_NEAR(plan.path[k].y_m, 0.1f, 0.05f);
}

TEST(LeadOut, StaysWhereTheWayAheadIsClosedToo) {
  Scene scene = WallBeside();
  scene.Add(9, -20, 10, 4);  // 1 m ahead of the nose
  scene.Add(-5, -5, 8, -4);
  scene.params.path.reverse_out_m = 0.0f;
  EXPECT_FALSE(IsUsable(PlanIn(scene).status));
}

TEST(LeadOut, AMovingVehicleIsLedOutOfNothing) {
  Scene scene = WallBeside();
  scene.request.start.speed_mps = 1.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
}

// SR-STA02 what nobody has seen beside the place of the start is not swept
TEST(LeadOut, WhereTheMapBeganItIsLeftStraightBeforeItTurns) {
  Scene scene = SceneTo({0.1f, 15.1f});  // to the left
  EXPECT_EQ(PlanIn(scene).lead_points, 0);
  EXPECT_TRUE(PlanIn(scene).pivots_first);
  scene.request.has_unseen_start = true;
  scene.request.unseen_start = scene.request.start.pose;
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GT(plan.lead_points, 2);
  EXPECT_NEAR(plan.path[plan.lead_points].x_m, 0.1f + scene.params.path.unseen_start_m, 0.11f);
  EXPECT_NEAR(plan.path[plan.lead_points].y_m, 0.1f, 1e-3f);
}

TEST(LeadOut, AGoalStraightAheadNeedsNone) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.request.has_unseen_start = true;
  scene.request.unseen_start = scene.request.start.pose;
  EXPECT_EQ(PlanIn(scene).lead_points, 0);
}

// Nothing can be led out of: the way ahead is closed, but there is room to turn.
TEST(LeadOut, WithoutAWayAheadItTurnsWhereItIs) {
  Scene scene = SceneTo({0.1f, 15.1f});
  scene.Add(9, -10, 10, 10);
  scene.request.has_unseen_start = true;
  scene.request.unseen_start = scene.request.start.pose;
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_EQ(plan.lead_points, 0);
}

// A plan from here has just begun with what would have touched: along the heading, free or not.
TEST(LeadOut, WhereTheLastPlanWouldHaveTouchedItLeadsOutFirst) {
  Scene scene = SceneTo({10.1f, 10.1f});
  EXPECT_EQ(PlanIn(scene).lead_points, 0);
  scene.request.lead_out = 1;
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GT(plan.lead_points, 0);
  EXPECT_NEAR(plan.path[plan.lead_points].x_m, 0.1f + Planner::kLeastLead_m, 0.11f);
  scene.request.lead_out = 6;  // the bend of 0.4 / m to the left
  EXPECT_GT(PlanIn(scene).path[2].y_m, 0.1f);
  scene.request.lead_out = 1;
  scene.Add(5, -10, 6, 10);  // right ahead
  EXPECT_EQ(PlanIn(scene).lead_points, 0) << "there is none";
}

// The same for the ways that are tried in turn: with a cell across its flank the vehicle stood for
// good, as each of them failed.
TEST(LeadOut, OneThatIsTriedGoesPastACellAcrossItsFlankToo) {
  Scene scene = WallBeside();
  scene.Add(15, 4, 15, 4);
  scene.Add(-5, -5, 25, -5);
  scene.params.path.reverse_out_m = 0.0f;
  scene.request.lead_out = 1;
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kNarrowGap) << StatusName(plan.status);
  EXPECT_GT(plan.lead_points, 2);
  EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), -double{PathCheck::kAcross_m});
}

// The same for any split of the units.
TEST(LeadOut, UnitsDoNotMatter) {
  const Scene scene = WallBeside();
  const uint64_t hash = HashOf(PlanIn(scene));
  for (const int units : {1, 7, 64}) EXPECT_EQ(HashOf(PlanIn(scene, units)), hash) << units;
}

}  // namespace
}  // namespace hardpack
