// SPDX-License-Identifier: Apache-2.0
#include "test/core/autonomy/random_outlines.h"

namespace hardpack {
namespace {

// SR-GEO04: no usable plan's swept outline touches a hard cell; the first of the 1,000 vehicles of
// outlines_slow.cpp.
TEST(Outlines, OfRandomVehiclesTouchNothing) {
  OutlineCounts counts;
  JudgeOutlines(1, 60, counts);
  EXPECT_GE(counts.plans, 24);
}

// A wall across the map at x = 12 m with a gap about y = 0.
Scene WallWithGap(int32_t gap_cells, float start_rad) {
  Scene scene = SceneTo({24.1f, 0.1f}, {0.1f, -6.0f, start_rad});
  scene.Add(60, -256, 61, -gap_cells / 2 - 1);
  scene.Add(60, gap_cells - gap_cells / 2, 61, 255);
  return scene;
}

// SR-GEO05: length and width alone make another vehicle of it. A gap of 3 m is driven through by
// one of 2.4 m with at least the margin beside it, one of 2.4 m is not.
TEST(Outlines, OfALongVehicleGoThroughAGapThatItFits) {
  for (const float start_rad : {0.0f, 0.8f, -0.8f}) {
    Scene scene = WallWithGap(15, start_rad);
    scene.params.vehicle.length_m = 6.0f;
    scene.params.vehicle.width_m = 2.4f;
    const Plan& plan = PlanIn(scene);
    ASSERT_TRUE(IsUsable(plan.status)) << start_rad << ' ' << StatusName(plan.status);
    EXPECT_GT(plan.path.back().x_m, 20.0f);
    const double clearance_m = SweptOutline(scene, plan).Clearance_m();
    EXPECT_GE(clearance_m, double{scene.params.path.margin_m} - SweptOutline::kStep_m);
    EXPECT_LE(clearance_m, 0.3);
    EXPECT_LE(double{plan.check.smallest_clearance_m}, 0.3);
  }
  Scene closed = WallWithGap(12, 0.0f);
  closed.params.vehicle.length_m = 6.0f;
  closed.params.vehicle.width_m = 2.4f;
  EXPECT_FALSE(IsUsable(PlanIn(closed).status));
}

//    #       a goal that is where the vehicle stands
//   [o] x
// SR-GEO06
TEST(Stay, IsWhatAGoalAtTheVehicleAsksFor) {
  for (const float away_m : {0.0f, 0.02f, 0.2f, -0.2f}) {
    const Scene scene = SceneTo({0.1f + away_m, 0.1f});
    const Plan& plan = PlanIn(scene);
    EXPECT_EQ(plan.status, Status::kOk) << away_m;
    EXPECT_TRUE(plan.stays);
    EXPECT_FALSE(plan.pivots_last);
    ASSERT_EQ(plan.path.size(), 2);
    EXPECT_EQ(LengthOf(plan.path), 0.0f);
    EXPECT_EQ(plan.speed.back(), 0.0f);
  }
}

// SR-GEO06: the turn on the spot that a goal heading asks for, by the shorter way, and only where
// what it sweeps is free.
TEST(Stay, TurnsToTheGoalsHeading) {
  Scene scene = SceneTo({0.1f, 0.1f});
  scene.request.has_goal_heading = true;
  scene.request.goal_heading_rad = 1.57f;
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kOk);
  EXPECT_TRUE(plan.stays && plan.pivots_last);
  ASSERT_EQ(plan.actuator.steps.size(), 1);
  EXPECT_EQ(plan.actuator.steps[0].dr_m, 0.0f);
  EXPECT_NEAR(plan.actuator.steps[0].phi_rad, 1.57f, 1e-5f);
  // A post that the front corner would come too near to.
  scene.Add(3, 5, 3, 5);
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
  scene.request.goal_heading_rad = -0.5f;
  EXPECT_TRUE(IsUsable(PlanIn(scene).status));
}

// A goal of a vehicle that stands in something is arrival, and that it stands in it is told.
// SR-GEO07
TEST(Stay, SaysWhatItStandsIn) {
  Scene scene = SceneTo({0.1f, 0.1f});
  scene.Add(3, 0, 3, 0);
  const Plan& plan = PlanIn(scene);
  EXPECT_TRUE(IsUsable(plan.status));
  EXPECT_EQ(plan.check_status, Status::kStartInObstacle);
  EXPECT_TRUE(plan.stays && plan.starts_in_obstacle);
}

// SR-GEO07: a start in an obstacle is told whatever else the status says.
TEST(Outlines, ThatStartInAnObstacleAreToldWithAGraverStatus) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(-4, 0, -4, 0);
  EXPECT_TRUE(PlanIn(scene).starts_in_obstacle);
  scene.request.start.curvature_per_m = 1e6f;
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kLimitExceeded);
  EXPECT_TRUE(plan.starts_in_obstacle);
  EXPECT_FALSE(PlanIn(SceneTo({15.1f, 0.1f})).starts_in_obstacle);
}

}  // namespace
}  // namespace hardpack
