// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "core/areas/area_set.h"
#include "core/autonomy/planner.h"
#include "core/autonomy/replanner.h"
#include "test/core/areas/polygon.h"
#include "test/core/autonomy/scene.h"

// Plans among areas: what is closed is closed for the search, the optimizer and the check alike.

namespace hardpack {
namespace {

using testing::AreaOf;
using testing::Box;

std::unique_ptr<AreaSet> SetOf(const std::vector<Area>& areas) {
  auto set = std::make_unique<AreaSet>();
  for (size_t i = 0; i < areas.size(); ++i) {
    EXPECT_EQ(set->Take(static_cast<int>(i), static_cast<int>(areas.size()), areas[i]),
              Status::kOk);
  }
  return set;
}

const Plan& PlanAmong(const Scene& scene, const AreaSet& areas, int units = 1 << 20,
                      int* steps = nullptr) {
  Planner& planner = ThePlanner();
  EXPECT_EQ(planner.BeginCells(kWindow, scene.params, scene.request), Status::kOk);
  for (const Block& block : scene.blocks) SetCells(block, planner.costmap_builder());
  int taken = 1;
  while (planner.StepCells(units, &areas) == Progress::kBusy) ++taken;
  if (steps != nullptr) *steps = taken;
  return planner.result();
}

// Nowhere on the plan, cut every 3 cm, does the outline breach an area.
void ExpectWithin(const AreaSet& areas, const Scene& scene, const Plan& plan) {
  const Footprint footprint = FootprintOf(scene.params.vehicle);
  for (int k = 0; k + 1 < plan.path.size(); ++k) {
    const Pose2& a = plan.path[k];
    const Pose2& b = plan.path[k + 1];
    const float length_m = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
    const float turn_rad = WrapAngle(b.theta_rad - a.theta_rad);
    const int pieces =
        1 + static_cast<int>(length_m / 0.03f) + static_cast<int>(std::abs(turn_rad) / 0.02f);
    for (int j = 0; j <= pieces; ++j) {
      const float share = static_cast<float>(j) / static_cast<float>(pieces);
      // Along a chord the heading is the first one's; at its end it turns.
      const Pose2 along = {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m),
                           a.theta_rad};
      const Pose2 turned = {b.x_m, b.y_m, a.theta_rad + share * turn_rad};
      ASSERT_EQ(areas.BreachedBy(footprint, along), -1) << k;
      ASSERT_EQ(areas.BreachedBy(footprint, turned), -1) << k;
    }
  }
}

//        ___
//   o   |   |   x       a keep-out area across the straight way
//       |___|
// SR-ARE02
TEST(PlannerAreas, DrivesAroundAKeepOutArea) {
  const Scene scene = SceneTo({20.1f, 0.1f});
  const auto areas = SetOf({AreaOf(AreaKind::kKeepOut, Box(8, -4, 12, 6))});
  const Plan& plan = PlanAmong(scene, *areas);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ExpectWithin(*areas, scene, plan);
  float aside_m = 0.0f;
  for (const Pose2& pose : plan.path) aside_m = std::min(aside_m, pose.y_m);
  EXPECT_LT(aside_m, -4.0f) << "by the nearer side";
  EXPECT_NEAR(plan.path.back().x_m, 20.1f, 0.2f);
}

// SR-ARE02
TEST(PlannerAreas, StaysInsideAFence) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -20, 51, 20);  // a wall of 8 m: the way around below is shorter, but outside
  const auto fence = SetOf({AreaOf(AreaKind::kFence, Box(-5, -4.5, 30, 15))});
  const Plan& plan = PlanAmong(scene, *fence);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ExpectWithin(*fence, scene, plan);
  float aside_m = 0.0f;
  for (const Pose2& pose : plan.path) aside_m = std::max(aside_m, pose.y_m);
  EXPECT_GT(aside_m, 4.0f);
  // With a fence on both sides there is no way.
  const auto narrow = SetOf({AreaOf(AreaKind::kFence, Box(-5, -4.5, 30, 4.5))});
  EXPECT_EQ(PlanAmong(scene, *narrow).status, Status::kNoPath);
}

// The search takes the nearest free cell instead of the goal. None behind the fence is free.
// SR-ARE06
TEST(PlannerAreas, AGoalIsNotMovedAcrossTheFence) {
  const auto areas = SetOf({AreaOf(AreaKind::kFence, Box(-5, -10, 10, 10))});
  const Scene scene = SceneTo({10.4f, 0.1f});
  const Plan& plan = PlanAmong(scene, *areas);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_TRUE(plan.search.goal_moved);
  ExpectWithin(*areas, scene, plan);
  Scene strict = scene;
  strict.params.astar.move_goal_out_of_obstacle = 0;
  EXPECT_EQ(PlanAmong(strict, *areas).status, Status::kGoalInObstacle);
}

// Beside the vehicle an area closes cells that the outline overlaps, though it breaches nothing: it
// can leave.
TEST(PlannerAreas, AVehicleInACellThatIsClosedDrivesOutOfIt) {
  const Footprint footprint = FootprintOf(VehicleParams{});
  const Scene scene = SceneTo({15.1f, 0.1f});
  const double flank = 0.1 - double{footprint.half_width_m};
  const auto areas = SetOf({AreaOf(AreaKind::kKeepOut, Box(-1, flank - 1, 0.5, flank - 0.01))});
  ASSERT_EQ(areas->BreachedBy(footprint, scene.request.start.pose), -1);
  const Plan& plan = PlanAmong(scene, *areas);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_TRUE(plan.starts_in_obstacle);
}

TEST(PlannerAreas, NoAreasChangeNeitherThePlanNorTheUnits) {
  Scene scene = SceneTo({20.1f, 3.1f});
  scene.Add(40, -30, 42, 10);
  const auto none = std::make_unique<AreaSet>();
  // The first search of a planner takes more units than those behind it.
  static_cast<void>(PlanAmong(scene, *none, 7));
  Planner& planner = ThePlanner();
  ASSERT_EQ(planner.BeginCells(kWindow, scene.params, scene.request), Status::kOk);
  for (const Block& block : scene.blocks) SetCells(block, planner.costmap_builder());
  int alone = 1;
  while (planner.StepCells(7) == Progress::kBusy) ++alone;
  const uint64_t hash = HashOf(planner.result());
  int among = 0;
  EXPECT_EQ(HashOf(PlanAmong(scene, *none, 7, &among)), hash);
  EXPECT_EQ(among, alone);
}

TEST(PlannerAreas, AnySplitOfTheUnitsGivesTheSamePlan) {
  const Scene scene = SceneTo({20.1f, 0.1f});
  const auto areas = SetOf({AreaOf(AreaKind::kKeepOut, Box(8, -4, 12, 6)),
                            AreaOf(AreaKind::kSpeedZone, Box(2, -9, 6, 9), 1.0f),
                            AreaOf(AreaKind::kFence, Box(-5, -30, 60, 30)),
                            AreaOf(AreaKind::kKeepOut, Box(300, 300, 310, 310))});
  const uint64_t hash = HashOf(PlanAmong(scene, *areas));
  for (const int units : {1, 2, 13, 64}) {
    int steps = 0;
    EXPECT_EQ(HashOf(PlanAmong(scene, *areas, units, &steps)), hash) << units;
    EXPECT_LE(steps, Planner::kMaxUnits);
  }
}

// The unit is a row of an area: those of the fence are all, those off the map none.
TEST(PlannerAreas, ClosesOneRowPerUnit) {
  const Scene scene = SceneTo({20.1f, 0.1f});
  const auto none = std::make_unique<AreaSet>();
  int before = 0;
  PlanAmong(scene, *none, 1, &before);
  Planner& planner = ThePlanner();
  const auto areas = SetOf({AreaOf(AreaKind::kFence, Box(-45, -45, 45, 45)),
                            AreaOf(AreaKind::kKeepOut, Box(-40.05, 30.05, 40, 31.95)),
                            AreaOf(AreaKind::kKeepOut, Box(300, 300, 310, 310))});
  ASSERT_EQ(planner.BeginCells(kWindow, scene.params, scene.request), Status::kOk);
  int units = 0;
  while (planner.stage() == PlanStage::kCostmap) {
    static_cast<void>(planner.StepCells(1, areas.get()));
    ++units;
  }
  EXPECT_EQ(units, CostmapBuilder::kCellUnits + kMapSize_cells + 10);
}

// SR-ARE05
TEST(PlannerAreas, IsAsSlowAsAZoneSaysBeforeItsFrontIsIn) {
  const Scene scene = SceneTo({40.1f, 0.1f});
  const auto areas = SetOf({AreaOf(AreaKind::kSpeedZone, Box(15, -5, 25, 5), 1.2f)});
  const Plan& plan = PlanAmong(scene, *areas);
  ASSERT_TRUE(IsUsable(plan.status));
  const Footprint footprint = FootprintOf(scene.params.vehicle);
  float fastest_mps = 0.0f;
  int in_zone = 0;
  for (int k = 0; k < plan.path.size(); ++k) {
    const bool is_in = areas->IsInZone(0, footprint, plan.path[k], 0.0f, 0.0f);
    if (is_in) {
      ++in_zone;
      EXPECT_LE(plan.speed[k], 1.2f) << k;
    }
    fastest_mps = std::max(fastest_mps, plan.speed[k]);
  }
  EXPECT_GT(in_zone, 20);
  EXPECT_GT(fastest_mps, 2.0f) << "before and behind it";
}

// Random maps: rocks, keep-out stars and a fence. Either there is no plan, or it keeps to them.
// SR-ARE02
TEST(PlannerAreas, RandomPlansKeepToTheirAreas) {
  const uint32_t seed = 75;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-35.0, 35.0);
  std::uniform_real_distribution<double> size(1.0, 9.0);
  std::uniform_int_distribution<int> cell(-200, 200);
  const Footprint footprint = FootprintOf(VehicleParams{});
  int planned = 0;
  for (int run = 0; run < 60; ++run) {
    // Braces are evaluated in order, arguments in any.
    const Vec2 goal = {static_cast<float>(at(random)), static_cast<float>(at(random))};
    const Pose2 start = {static_cast<float>(at(random)), static_cast<float>(at(random)),
                         static_cast<float>(at(random))};
    Scene scene = SceneTo(goal, start);
    std::vector<Area> list;
    for (int i = 0; i < 12; ++i) {
      const testing::Place middle = {at(random), at(random)};
      const Area star = testing::RandomStar(random, AreaKind::kKeepOut, middle, size(random));
      if (CheckArea(star) == Status::kOk) list.push_back(star);
    }
    const Area fence = testing::RandomStar(random, AreaKind::kFence, {0, 0}, 150.0);
    if (CheckArea(fence) == Status::kOk) list.push_back(fence);
    for (int i = 0; i < 20; ++i) {
      const int x = cell(random);
      const int y = cell(random);
      scene.Add(x, y, x + 4, y + 4);
    }
    const auto areas = SetOf(list);
    if (areas->BreachedBy(footprint, scene.request.start.pose) >= 0) continue;
    const Plan& plan = PlanAmong(scene, *areas);
    if (!IsUsable(plan.status) || plan.starts_in_obstacle) continue;
    ++planned;
    ExpectWithin(*areas, scene, plan);
  }
  EXPECT_GT(planned, 8);
}

}  // namespace
}  // namespace hardpack
