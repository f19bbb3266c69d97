// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "core/autonomy/planner.h"
#include "test/core/autonomy/scene.h"

// Whole plans in scenes.

namespace hardpack {
namespace {

TEST(Planner, DrivesStraightOverAnOpenField) {
  const Scene scene = SceneTo({20.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.status, Status::kOk);
  EXPECT_FALSE(plan.pivots_first || plan.pivots_last || plan.narrow || plan.is_seed);
  for (const Pose2& pose : plan.path) EXPECT_NEAR(pose.y_m, 0.1f, 1e-3f);
  EXPECT_GT(*std::max_element(plan.speed.begin(), plan.speed.end()), 3.0f);
  EXPECT_EQ(ThePlanner().stage(), PlanStage::kDone);
}

//            #
//            #
//   o  ------ ------>  x        a wall with a gap of 4 m, off the straight line
//            #
TEST(Planner, PassesAGapInAWall) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -256, 51, 9);
  scene.Add(50, 30, 51, 255);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_FALSE(plan.narrow);
  bool in_gap = false;
  for (const Pose2& pose : plan.path) {
    in_gap = in_gap || (std::abs(pose.x_m - 10.2f) < 0.3f && pose.y_m > 2.8f && pose.y_m < 5.2f);
  }
  EXPECT_TRUE(in_gap);
}

// The gap is 2 m: enough for the footprint (1.58 m), but with little room beside it. The way around
// is 25 m longer, and nothing is in its way.
// SR-SPD05
TEST(Planner, PassesAGapWithLittleRoomSlowly) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -90, 51, -5);
  scene.Add(50, 6, 51, 90);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.narrow);
  EXPECT_GE(plan.status, Status::kNarrowGap);
  float fastest_mps = 0.0f;
  for (int k = 0; k < plan.path.size(); ++k) {
    const bool in_gap = std::abs(plan.path[k].x_m - 10.1f) < 0.5f;
    if (in_gap) {
      EXPECT_LE(plan.speed[k], scene.params.speed.min_speed_mps) << k;
    }
    fastest_mps = std::max(fastest_mps, plan.speed[k]);
  }
  EXPECT_GT(fastest_mps, scene.params.speed.min_speed_mps + 0.5f) << "where there is room";
}

// SR-PLN01
TEST(Planner, RefusesAGapNarrowerThanTheFootprint) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -256, 51, -4);
  scene.Add(50, 4, 51, 255);
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kNoPath);
  EXPECT_TRUE(plan.path.empty());
  EXPECT_TRUE(plan.speed.empty());
}

//   #########
//   #   o   #    x
//   #########
TEST(Planner, FindsNoPathOutOfAClosedRing) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(-30, -30, 30, -29);
  scene.Add(-30, 29, 30, 30);
  scene.Add(-30, -30, -29, 30);
  scene.Add(29, -30, 30, 30);
  EXPECT_EQ(PlanIn(scene).status, Status::kNoPath);
}

//  # o ------->        within the planning radius, not within the footprint
// SR-SPD05
TEST(Planner, LeavesAnObstacleAtItsStartSlowly) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.params.costmap.planning_radius_m = 1.8f;
  scene.Add(-9, -2, -7, 2);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.search.start_in_obstacle);
  EXPECT_EQ(plan.check.overlap_points, 0);
  EXPECT_GE(plan.status, Status::kStartInObstacle);
  for (int k = 1; k < plan.path.size(); ++k) {
    const float slow_mps = scene.params.speed.obstacle_start_speed_mps;
    const float x_m = plan.path[k].x_m;
    if (x_m < 0.3f) {
      EXPECT_LE(plan.speed[k], slow_mps);
    } else if (x_m > 4.0f && x_m < 8.0f) {
      EXPECT_GT(plan.speed[k], slow_mps);
    }
  }
}

// A cell within the footprint itself, behind the middle.
TEST(Planner, DrivesSlowlyOutOfWhatItStandsIn) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(-4, 0, -4, 0);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.check_status, Status::kStartInObstacle);
  EXPECT_GT(plan.check.overlap_points, 0);
  for (int k = 1; k < plan.check.overlap_points; ++k) {
    EXPECT_LE(plan.speed[k], scene.params.speed.obstacle_start_speed_mps) << k;
  }
}

TEST(Planner, MovesAGoalOutOfAnObstacleOrRefusesIt) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(72, -3, 78, 3);
  const Plan& moved = PlanIn(scene);
  ExpectSound(scene, moved);
  EXPECT_TRUE(moved.search.goal_moved);
  EXPECT_GE(moved.status, Status::kGoalMoved);
  scene.params.astar.move_goal_out_of_obstacle = 0;
  EXPECT_EQ(PlanIn(scene).status, Status::kGoalInObstacle);
}

TEST(Planner, GoesToTheEdgeForAGoalOffTheMap) {
  const Scene scene = SceneTo({200.0f, 10.0f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.search.goal_outside_map);
  EXPECT_GE(plan.status, Status::kGoalOutsideMap);
  EXPECT_GT(plan.path.back().x_m, 50.0f);
}

//   x <-- (o     the vehicle looks the other way
TEST(Planner, TurnsOnTheSpotTowardsAGoalBehind) {
  const Scene scene = SceneTo({-15.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.pivots_first);
  EXPECT_EQ(plan.path[0].x_m, plan.path[1].x_m);
  EXPECT_EQ(plan.path[0].y_m, plan.path[1].y_m);
  EXPECT_EQ(plan.actuator.steps[0].dr_m, 0.0f);
  EXPECT_NEAR(std::abs(plan.actuator.steps[0].phi_rad), kPi, 0.05f);
  EXPECT_EQ(plan.speed[0], 0.0f);
  EXPECT_EQ(plan.speed[1], 0.0f);
  EXPECT_GT(plan.speed[3], 0.0f);
}

// SR-PLN01
TEST(Planner, SaysWhenTheTurnOnTheSpotHasNoRoom) {
  Scene scene = SceneTo({-15.1f, 0.1f});
  scene.Add(-5, 5, 5, 5);    // 0.9 m to the left
  scene.Add(8, -10, 9, 10);  // and no way ahead
  scene.params.path.reverse_out_m = 0.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
}

TEST(Planner, JoinsUpToSixtyDegreesWithoutATurnOnTheSpot) {
  for (const float heading_rad : {-0.9f, -0.5f, 0.5f, 0.9f}) {
    const Scene scene = SceneTo({20.1f, 0.1f}, {0.1f, 0.1f, heading_rad});
    const Plan& plan = PlanIn(scene);
    ExpectSound(scene, plan);
    EXPECT_FALSE(plan.pivots_first) << heading_rad;
  }
}

//   ##################
//   o/   ------> x          a corridor of 2.4 m: one step along the heading of 46 degrees touches
//   ##################
TEST(Planner, TurnsOnTheSpotWhereJoiningWouldTouch) {
  Scene scene = SceneTo({12.1f, 0.0f}, {0.1f, 0.0f, 0.8f});
  scene.Add(-20, 6, 100, 8);
  scene.Add(-20, -9, 100, -7);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.pivots_first);
  // A moving vehicle cannot.
  scene.request.start.speed_mps = 1.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kCollision);
  EXPECT_TRUE(ThePlanner().result().speed.empty());
}

TEST(Planner, ArrivesAtTheGoalHeading) {
  for (const float heading_rad : {0.6f, -0.6f, 2.5f}) {
    Scene scene = SceneTo({20.1f, 0.1f});
    scene.request.has_goal_heading = true;
    scene.request.goal_heading_rad = heading_rad;
    const Plan& plan = PlanIn(scene);
    ExpectSound(scene, plan);
    EXPECT_NEAR(plan.path.back().theta_rad, heading_rad, 0.05f);
    EXPECT_EQ(plan.pivots_last, heading_rad == 2.5f) << heading_rad;
    if (!plan.pivots_last) continue;
    EXPECT_EQ(plan.actuator.steps.back().dr_m, 0.0f);
    EXPECT_EQ(plan.speed[plan.speed.size() - 2], 0.0f);
  }
}

TEST(Planner, ReachesAGoalTwoCellsAhead) {
  const Scene near = SceneTo({0.42f, 0.1f});
  const Plan& plan = PlanIn(near);
  ExpectSound(near, plan);
  Scene moving = SceneTo({0.12f, 0.1f});
  moving.request.start.speed_mps = 0.5f;
  EXPECT_EQ(PlanIn(moving).status, Status::kPathTooShort);
}

TEST(Planner, CutsALongPathAtItsCapacity) {
  Scene scene = SceneTo({45.0f, 45.0f}, {-45.0f, -45.0f, kPi});
  scene.params.path.step_m = 0.25f;
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_GE(plan.status, Status::kPathCut);
  EXPECT_TRUE(plan.pivots_first);
}

//      p        a person 3 m beside the way, halfway
//   o ----------> x
TEST(Planner, SlowsForAPersonBesideTheWay) {
  Scene scene = SceneTo({30.1f, 0.1f});
  const Plan alone = PlanIn(scene);
  scene.Add(75, 15, 76, 16, Costmap::kPerson);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  const auto slowest_near = [](const Plan& p, float x_m) {
    float slowest = 1e9f;
    for (int k = 0; k < p.path.size(); ++k) {
      if (std::abs(p.path[k].x_m - x_m) < 3.0f) slowest = std::min(slowest, p.speed[k]);
    }
    return slowest;
  };
  EXPECT_LT(slowest_near(plan, 12.0f), 0.8f * slowest_near(alone, 12.0f));
  // Far behind the person nothing is left of it.
  EXPECT_NEAR(slowest_near(plan, 25.0f), slowest_near(alone, 25.0f), 0.3f);
}

TEST(Planner, IgnoresAPersonFarFromTheWay) {
  Scene scene = SceneTo({30.1f, 0.1f});
  const Plan alone = PlanIn(scene);
  scene.Add(75, 150, 76, 151, Costmap::kPerson);
  const Plan& plan = PlanIn(scene);
  ASSERT_EQ(plan.speed.size(), alone.speed.size());
  for (int k = 0; k < plan.speed.size(); ++k) EXPECT_EQ(plan.speed[k], alone.speed[k]);
}

// SR-SPD01
TEST(Planner, CanStopWithinTheRestOfThePath) {
  const Scene scene = SceneTo({40.1f, 10.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  double rest_m = 0.0;
  for (int k = plan.path.size() - 2; k > 0; --k) {
    rest_m += std::abs(double{plan.actuator.steps[k].dr_m});
    EXPECT_LE(StoppingDistance(scene.params.speed, plan.speed[k]), rest_m + 1e-3) << k;
  }
}

TEST(Planner, BeginsAtTheSpeedItHas) {
  Scene scene = SceneTo({40.1f, 0.1f});
  scene.request.start.speed_mps = 3.0f;
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.speed[0], 3.0f);
  EXPECT_GT(plan.speed[1], 3.0f);
}

TEST(Planner, PlansOnHeights) {
  const auto heights = std::make_unique<HeightGrid>();
  ASSERT_EQ(heights->Reset({0.0f, 0.0f}), Status::kOk);
  for (int y = -100; y < 100; ++y) {
    for (int x = -20; x < 120; ++x) {
      const Vec2 p = CellCenter({x, y});
      ASSERT_EQ(heights->Insert({p.x_m, p.y_m, 0.0f}, ReturnClass::kGround), Status::kOk);
      if (x > 40 && x < 50 && y > -20 && y < 10) {
        ASSERT_EQ(heights->Insert({p.x_m, p.y_m, 1.2f}, ReturnClass::kHard), Status::kOk);
      }
    }
  }
  const Scene scene = SceneTo({20.1f, 0.1f});
  Planner& planner = ThePlanner();
  ASSERT_EQ(planner.Begin(*heights, scene.params, scene.request), Status::kOk);
  while (planner.Step(*heights, 100) == Progress::kBusy) {
  }
  Scene box = scene;
  box.Add(41, -19, 49, 9);
  ExpectSound(box, planner.result());
  EXPECT_GT(LengthOf(planner.result().path), 20.5f);
}

//   o ------> x###     a wall just beyond the goal: its cell is free, but the vehicle is longer
TEST(Planner, StopsShortOfAGoalInFrontOfAWall) {
  Scene scene = SceneTo({10.1f, 0.1f});
  scene.params.vehicle.length_m = 2.6f;
  scene.Add(56, -20, 58, 20);  // from 11.2 m on
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.ends_short);
  EXPECT_FALSE(plan.search.goal_moved);
  EXPECT_GE(plan.status, Status::kGoalMoved);
  EXPECT_GT(plan.path.back().x_m, 9.5f);
}

//   x <------ o->     the goal is behind, and the vehicle drives away from it
TEST(Planner, GivesAMovingVehicleNoTurnOnTheSpot) {
  Scene scene = SceneTo({-10.1f, 0.1f});
  scene.request.start.speed_mps = 5.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
  scene.request.start.speed_mps = 0.0f;
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kOk);
  EXPECT_TRUE(plan.pivots_first);
}

//   x---------------.      out and back past one person, who stands nearer to the way back: the
//           P       |      way out is slow beside them too
//   =============   |
//   o---------------'
TEST(Planner, SlowsForAPersonOnEachPassage) {
  Scene scene = SceneTo({0.1f, 7.1f});
  // Its way out passes close enough to be slow; the other solver's swings out further.
  scene.params.optimizer.method = OptimizerParams::kPaperDescent;
  scene.Add(-80, 12, 60, 12);
  scene.Add(35, 20, 36, 21, Costmap::kPerson | Costmap::kHard);
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  int points = 0;
  float slowest_mps = 10.0f;
  for (int k = 0; k < plan.path.size(); ++k) {
    const Pose2& pose = plan.path[k];
    if (pose.y_m > 2.0f || pose.x_m < 4.0f || pose.x_m > 7.0f) continue;
    slowest_mps = std::min(slowest_mps, plan.speed[k]);
    ++points;
  }
  EXPECT_GT(points, 5);
  EXPECT_LT(slowest_mps, 1.5f);
}

TEST(Planner, RefusesAnglesAndPlacesThatItsArithmeticCannotTellApart) {
  Scene scene = SceneTo({10.1f, 0.1f});
  scene.request.start.pose.theta_rad = 10000.0f;
  Planner& planner = ThePlanner();
  EXPECT_EQ(planner.BeginCells(kWindow, scene.params, scene.request), Status::kInvalidArgument);
  scene.request.start.pose.theta_rad = 0.0f;
  scene.request.start.pose.x_m = 1.0e7f;
  EXPECT_EQ(planner.BeginCells(kWindow, scene.params, scene.request), Status::kInvalidArgument);
}

//        #       #
//        #       #
//   o            #   x     two walls, each with a gap of 1.8 m, that of the second one aside
//        #
//        #       #
Scene TwoGaps(uint32_t seed) {
  std::mt19937 random(seed);
  const int apart = 18 + static_cast<int>(random() % 20u);
  const int aside = 4 + static_cast<int>(random() % 14u);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  Scene scene = SceneTo({20.1f, 0.1f + static_cast<float>(aside) * kCellSize_m},
                        {2.0f + unit(random), unit(random), 0.5f * unit(random)});
  scene.request.start.curvature_per_m = 0.3f * unit(random);
  scene.request.start.speed_mps = 1.0f;
  scene.Add(30, -200, 31, -5);
  scene.Add(30, 5, 31, 200);
  scene.Add(30 + apart, -200, 31 + apart, aside - 5);
  scene.Add(30 + apart, aside + 5, 31 + apart, 200);
  return scene;
}

// The preferred limit of the curvature's change never costs a path that there is without it; some
// paths are bent less with it, and some are given up for that without.
TEST(Planner, OptimizesForThePreferredRateWhereThatIsFree) {
  int gentler = 0;
  int given_up = 0;
  for (uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Scene scene = TwoGaps(seed);
    // The gaps are apart by what a path at this rate needs.
    scene.params.optimizer.preferred_curvature_rate_per_m2 = 0.175f;
    scene.params.optimizer.preferred_curvature_rate_beta = 6.0f;
    Scene without = scene;
    OptimizerParams& optimizer = without.params.optimizer;
    optimizer.preferred_curvature_rate_per_m2 = optimizer.max_curvature_rate_per_m2;
    const Plan plain = PlanIn(without);
    const Plan& plan = PlanIn(scene);
    EXPECT_TRUE(IsUsable(plan.status) || !IsUsable(plain.status));
    if (!IsUsable(plan.status)) continue;
    ExpectSound(scene, plan);
    const bool is_same =
        std::equal(plan.path.begin(), plan.path.end(), plain.path.begin(), plain.path.end(),
                   [](const Pose2& a, const Pose2& b) { return a.x_m == b.x_m && a.y_m == b.y_m; });
    const bool is_gentler =
        plan.check.largest_curvature_rate_per_m2 < plain.check.largest_curvature_rate_per_m2;
    given_up += is_same ? 1 : 0;
    gentler += !is_same && is_gentler ? 1 : 0;
  }
  EXPECT_GT(gentler, 10);
  EXPECT_GT(given_up, 5);
}

// Trunks and bushes strewn at random, the start anywhere in it and looking anywhere.
Scene RandomForest(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  Scene scene = SceneTo({20.0f * unit(random), 20.0f * unit(random)},
                        {0.5f * unit(random), 0.5f * unit(random), kPi * unit(random)});
  const int trunks = 20 + static_cast<int>(seed % 5u) * 20;
  for (int i = 0; i < trunks; ++i) {
    const int x = static_cast<int>(120.0f * unit(random));
    const int y = static_cast<int>(120.0f * unit(random));
    const int size = static_cast<int>(random() % 4u);
    scene.Add(x, y, x + size, y + size, i % 4 == 0 ? Costmap::kSoft : Costmap::kHard);
  }
  // Bushes first, so that none takes a trunk's place.
  std::stable_partition(scene.blocks.begin(), scene.blocks.end(),
                        [](const Block& block) { return block.flags == Costmap::kSoft; });
  scene.request.start.curvature_per_m = 0.3f * unit(random);
  scene.request.start.speed_mps = seed % 2u == 0 ? 0.0f : 1.0f + unit(random);
  // A vehicle that moves cannot turn on the spot, so it moves towards its goal.
  if (scene.request.start.speed_mps > 0.0f) {
    PathStart& start = scene.request.start;
    start.pose.theta_rad = Atan2(scene.request.goal_odom.y_m - start.pose.y_m,
                                 scene.request.goal_odom.x_m - start.pose.x_m);
  }
  return scene;
}

// In parts, because an unoptimised build takes a quarter of a second for a costmap.
class PlannerInForests : public ::testing::TestWithParam<uint32_t> {};

// SR-PLN01
TEST_P(PlannerInForests, KeepsClearOfEveryTrunk) {
  constexpr uint32_t kForests = 30;
  uint32_t usable = 0;
  for (uint32_t seed = GetParam(); seed < GetParam() + kForests; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Scene scene = RandomForest(seed);
    const Plan& plan = PlanIn(scene);
    if (!IsUsable(plan.status)) continue;
    ++usable;
    ExpectSound(scene, plan);
    if (HasFailure()) return;
  }
  EXPECT_GT(usable, kForests / 2);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlannerInForests, ::testing::Values(0u, 30u, 60u, 90u));

}  // namespace
}  // namespace hardpack
