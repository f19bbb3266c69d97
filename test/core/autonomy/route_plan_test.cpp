// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "core/autonomy/planner.h"
#include "test/core/autonomy/scene.h"

// Plans by waypoints that are passed.

namespace hardpack {
namespace {

Scene SceneBy(std::initializer_list<Vec2> vias, Vec2 goal, Pose2 start = {0.1f, 0.1f, 0.0f}) {
  Scene scene = SceneTo(goal, start);
  for (const Vec2& via : vias) {
    EXPECT_EQ(scene.request.route.vias.PushBack({via, 0.0f}), Status::kOk);
  }
  return scene;
}

float NearestTo(const Plan& plan, Vec2 place) {
  float least_m = 1e9f;
  for (const Pose2& pose : plan.path) {
    least_m = std::min(least_m, std::hypot(pose.x_m - place.x_m, pose.y_m - place.y_m));
  }
  return least_m;
}

float SpeedAt(const Plan& plan, float x_m) {
  int nearest = 0;
  for (int k = 0; k < plan.path.size(); ++k) {
    if (std::abs(plan.path[k].x_m - x_m) < std::abs(plan.path[nearest].x_m - x_m)) nearest = k;
  }
  return plan.speed[nearest];
}

bool EndsAt(const Plan& plan, Vec2 place) {
  const Pose2& end = plan.path.back();
  return std::hypot(end.x_m - place.x_m, end.y_m - place.y_m) < 0.01f;
}

// As if there were nothing on the way.
TEST(RoutePlan, AViaOnTheLineCostsNothing) {
  const Scene direct = SceneTo({30.1f, 0.1f});
  const float alone_mps = SpeedAt(PlanIn(direct), 12.0f);
  const Scene scene = SceneBy({{6.1f, 0.1f}, {12.1f, 0.1f}, {18.1f, 0.1f}}, {30.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.status, Status::kOk);
  EXPECT_EQ(plan.target, 3);
  EXPECT_TRUE(EndsAt(plan, {30.1f, 0.1f}));
  EXPECT_NEAR(SpeedAt(plan, 12.0f), alone_mps, 0.02f);
  EXPECT_NEAR(LengthOf(plan.path), 30.0f, 0.05f);
  EXPECT_GT(plan.search.cost, 0);
}

//          v1          v3
//    o  v0       v2         x      corners of 90 degrees
// SR-MIS05
TEST(RoutePlan, AZigzagIsPassedWithinTheRadiusWithoutATurnOnTheSpot) {
  const Scene scene =
      SceneBy({{8.1f, 0.1f}, {14.1f, 6.1f}, {20.1f, 0.1f}, {26.1f, 6.1f}}, {32.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.target, 4);
  EXPECT_FALSE(plan.pivots_first || plan.pivots_last || plan.is_seed);
  for (const Via& via : scene.request.route.vias) {
    EXPECT_LE(NearestTo(plan, via.position_odom), scene.params.replan.pass_radius_m);
  }
  for (int k = 0; k + 1 < plan.path.size(); ++k) {
    EXPECT_FALSE(k > 0 && plan.speed[k] < 0.5f && plan.path[k].x_m < 28.0f) << k;
  }
  EXPECT_LE(plan.check.curvature_excess_per_m, 0.01f);
}

TEST(RoutePlan, ANarrowerRadiusIsKeptToo) {
  Scene scene = SceneBy({{10.1f, 0.1f}}, {14.1f, 7.1f});
  for (const float radius_m : {0.5f, 1.0f, 3.0f}) {
    SCOPED_TRACE(radius_m);
    scene.params.replan.pass_radius_m = radius_m;
    const Plan& plan = PlanIn(scene);
    ExpectSound(scene, plan);
    EXPECT_LE(NearestTo(plan, {10.1f, 0.1f}), radius_m);
  }
}

// A hairpin: no arc that the vehicle can drive stays near it.
// SR-MIS05
TEST(RoutePlan, EndsAtAViaWithASharpCorner) {
  const Scene scene = SceneBy({{15.1f, 0.1f}}, {3.1f, 2.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.target, 0);
  EXPECT_TRUE(EndsAt(plan, {15.1f, 0.1f}));
  EXPECT_EQ(plan.speed.back(), 0.0f);
}

//   o ---- via     [ring around the goal]
TEST(RoutePlan, EndsAtAViaBehindWhichThereIsNoWay) {
  Scene scene = SceneBy({{12.1f, 0.1f}}, {30.1f, 0.1f});
  scene.Add(130, -20, 170, -19);
  scene.Add(130, 19, 170, 20);
  scene.Add(130, -20, 131, 20);
  scene.Add(169, -20, 170, 20);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.status, Status::kOk);
  EXPECT_EQ(plan.target, 0);
  EXPECT_TRUE(EndsAt(plan, {12.1f, 0.1f}));
}

TEST(RoutePlan, AViaInAnObstacleIsMovedOrRefusedAsAGoalIs) {
  Scene scene = SceneBy({{15.1f, 0.1f}}, {30.1f, 0.1f});
  scene.Add(68, -8, 83, 8);
  const Plan& moved = PlanIn(scene);
  ExpectSound(scene, moved);
  EXPECT_GE(moved.status, Status::kGoalMoved);
  EXPECT_EQ(moved.target, 0) << "it is farther away from it than the radius";
  scene.params.astar.move_goal_out_of_obstacle = 0;
  EXPECT_EQ(PlanIn(scene).status, Status::kGoalInObstacle);
}

TEST(RoutePlan, AViaWithoutAWayIsTold) {
  Scene scene = SceneBy({{15.1f, 0.1f}}, {-15.1f, 0.1f});
  scene.Add(50, -256, 51, 255);
  EXPECT_EQ(PlanIn(scene).status, Status::kNoPath);
}

TEST(RoutePlan, GoesToTheEdgeForAViaOffTheMap) {
  const Scene scene = SceneBy({{200.1f, 0.1f}}, {220.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.target, 0);
  EXPECT_TRUE(plan.search.goal_outside_map);
  EXPECT_TRUE(IsUsable(plan.status));
}

TEST(RoutePlan, AGoalOffTheMapIsDrivenTowardsByItsVia) {
  const Scene scene = SceneBy({{20.1f, 0.1f}}, {220.1f, 30.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.target, 1);
  EXPECT_GT(plan.path.back().x_m, 40.0f);
}

TEST(RoutePlan, AViaWhereTheVehicleIsCountsAsPassed) {
  const Vec2 goal = {20.1f, 0.1f};
  const Plan& plan = PlanIn(SceneBy({{0.2f, 0.1f}}, goal));
  EXPECT_EQ(plan.target, 1);
  EXPECT_TRUE(EndsAt(plan, goal));
  const Plan& twice = PlanIn(SceneBy({{10.1f, 0.1f}, {10.1f, 0.1f}, {10.2f, 0.1f}}, goal));
  EXPECT_EQ(twice.target, 3) << "and two at one place as one";
  EXPECT_TRUE(EndsAt(twice, goal));
  const Plan& at_goal = PlanIn(SceneBy({{10.1f, 0.1f}, {20.1f, 0.1f}}, goal));
  EXPECT_EQ(at_goal.target, 2);
  EXPECT_TRUE(EndsAt(at_goal, goal));
}

// Via and goal where it stands: there is nothing to drive.
TEST(RoutePlan, StaysWhereEverythingIsHere) {
  const Plan& plan = PlanIn(SceneBy({{0.2f, 0.1f}}, {0.1f, 0.2f}));
  EXPECT_TRUE(plan.stays);
  EXPECT_EQ(plan.target, 1);
  const Plan& away = PlanIn(SceneBy({{8.1f, 0.1f}}, {0.1f, 0.2f}));
  EXPECT_FALSE(away.stays) << "the via is not here";
  EXPECT_EQ(away.target, 0);
}

TEST(RoutePlan, TheGoalsHeadingIsForThePathThatReachesIt) {
  Scene scene = SceneBy({{15.1f, 0.1f}}, {3.1f, 2.1f});
  scene.request.has_goal_heading = true;
  scene.request.goal_heading_rad = 1.0f;
  const Plan& ends_at_via = PlanIn(scene);
  EXPECT_EQ(ends_at_via.target, 0);
  EXPECT_FALSE(ends_at_via.pivots_last);
  EXPECT_NEAR(ends_at_via.path.back().theta_rad, 0.0f, 0.05f);
  scene.request.goal_odom = {25.1f, 4.1f};
  const Plan& whole = PlanIn(scene);
  EXPECT_EQ(whole.target, 1);
  EXPECT_NEAR(whole.path.back().theta_rad, 1.0f, 0.06f);
}

TEST(RoutePlan, IsCutAtTheCapacityOfAPath) {
  Scene scene = SceneBy({{35.1f, 0.1f}}, {35.1f, 45.1f}, {-25.1f, 0.1f, 0.0f});
  const Plan& plan = PlanIn(scene);
  EXPECT_GE(plan.status, Status::kPathCut);
  EXPECT_TRUE(IsUsable(plan.status));
  EXPECT_GT(plan.path.size(), kMaxPathPoints - 16);
  EXPECT_LT(plan.path.back().y_m, 40.0f);
  EXPECT_EQ(plan.speed.back(), 0.0f);
}

// SR-MIS04
TEST(RoutePlan, EachLegKeepsItsLimitOfSpeed) {
  Scene scene = SceneBy({{10.1f, 0.1f}, {20.1f, 0.1f}}, {40.1f, 0.1f});
  scene.request.route.vias[0].speed_mps = 1.0f;
  scene.request.route.goal_speed_mps = 2.5f;
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  float fastest_mps[3] = {};
  for (int k = 0; k < plan.path.size(); ++k) {
    const float x_m = plan.path[k].x_m;
    float& fastest = fastest_mps[x_m < 10.0f ? 0 : (x_m < 20.0f ? 1 : 2)];
    fastest = std::max(fastest, plan.speed[k]);
  }
  EXPECT_LE(fastest_mps[0], 1.0f);
  EXPECT_GT(fastest_mps[1], 2.9f) << "no limit of its own";
  EXPECT_LE(fastest_mps[2], 2.51f);
  EXPECT_GT(fastest_mps[2], 2.4f);
}

// SR-MIS06
TEST(RoutePlan, IsTheSameForAnySplitOfItsUnits) {
  Scene scene = SceneBy({{8.1f, 0.1f}, {14.1f, 6.1f}, {20.1f, 0.1f}}, {26.1f, 6.1f});
  scene.Add(30, 8, 40, 14);
  scene.Add(85, -6, 88, 2);
  const uint64_t whole = HashOf(PlanIn(scene));
  EXPECT_EQ(ThePlanner().result().target, 3);
  for (const int units : {1, 7, 64}) EXPECT_EQ(HashOf(PlanIn(scene, units)), whole) << units;
}

// SR-MIS06
TEST(RoutePlan, RefusesWhatIsNoNumber) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Scene scene = SceneBy({{8.1f, kNan}}, {20.1f, 0.1f});
  EXPECT_EQ(ThePlanner().BeginCells(kWindow, scene.params, scene.request), Status::kNotFinite);
  scene = SceneBy({{8.1f, 0.1f}}, {20.1f, 0.1f});
  scene.request.route.vias[0].speed_mps = kNan;
  EXPECT_EQ(ThePlanner().BeginCells(kWindow, scene.params, scene.request), Status::kNotFinite);
  scene.request.route.vias[0].speed_mps = -1.0f;
  EXPECT_EQ(ThePlanner().BeginCells(kWindow, scene.params, scene.request),
            Status::kInvalidArgument);
}

// The paper's method knows no vias: its path passes them, or ends at one.
TEST(RoutePlan, TheOtherOptimizerPassesThemOrStops) {
  Scene scene = SceneBy({{8.1f, 0.1f}, {14.1f, 6.1f}}, {20.1f, 0.1f});
  scene.params.optimizer.method = OptimizerParams::kPaperDescent;
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  const Vec2 vias[] = {{8.1f, 0.1f}, {14.1f, 6.1f}};
  for (int i = 0; i < plan.target; ++i) {
    EXPECT_LE(NearestTo(plan, vias[i]), scene.params.replan.pass_radius_m);
  }
}

}  // namespace
}  // namespace hardpack
