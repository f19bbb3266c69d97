// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "test/core/autonomy/scene.h"
#include "test/core/base/rounds.h"

// The search takes places for a way that the check refuses: it is told, and looks again.

namespace hardpack {
namespace {

// 200 boxes of 0.4 to 1.2 m in a field of 28 x 40 m between walls, and the goal behind it.
Scene Clutter(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> across(-100, 100);
  std::uniform_int_distribution<int> along(10, 150);
  std::uniform_int_distribution<int> side(1, 5);
  Scene scene = SceneTo({35.1f, 0.1f});
  scene.Add(8, 104, 152, 250);
  scene.Add(8, -250, 152, -104);
  for (int i = 0; i < 200; ++i) {
    const int x = along(random);
    const int y = across(random);
    const int width = side(random);
    const int height = side(random);
    scene.Add(x, y, x + width, y + height);
  }
  return scene;
}

// Of 300 such fields 299 have a plan, 67 of them only after a refusal.
// SR-PLN07
TEST(Refusal, AnotherWayIsFoundWhereTheFirstIsNone) {
  int found = 0;
  int usable = 0;
  for (uint32_t seed = 1; seed <= Rounds(60u, 12u); ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = Clutter(seed);
    const Plan& plan = PlanIn(scene);
    EXPECT_LE(plan.refusals, Planner::kMaxRefusals);
    if (!IsUsable(plan.status)) continue;
    ++usable;
    if (plan.refusals == 0) continue;
    ++found;
    ExpectSound(scene, plan);
  }
  EXPECT_EQ(usable, Rounds(60, 12));
  EXPECT_GE(found, Rounds(10, 1));
}

// The place of a refusal is closed for one plan.
// SR-PLN03, SR-PLN07
TEST(Refusal, ThePlanIsTheSameAgainAndForAnyPortions) {
  int seed = 1;
  while (PlanIn(Clutter(static_cast<uint32_t>(seed))).refusals == 0) ++seed;
  const Scene scene = Clutter(static_cast<uint32_t>(seed));
  const uint64_t hash = HashOf(PlanIn(scene));
  EXPECT_EQ(HashOf(PlanIn(scene)), hash);
  EXPECT_EQ(HashOf(PlanIn(scene, 3)), hash);
  const Scene open = SceneTo({35.1f, 0.1f});
  EXPECT_EQ(PlanIn(open).refusals, 0);
}

// The second plan of a round is made on the map of the first.
// SR-PLN03, SR-PLN07
TEST(Refusal, EachPlanOnAMapMayRefuseAgain) {
  int plans = 0;
  for (uint32_t seed = 1; plans < 3; ++seed) {
    const Scene scene = Clutter(seed);
    const Plan& plan = PlanIn(scene);
    if (plan.refusals < 2) continue;
    ++plans;
    const uint64_t hash = HashOf(plan);
    for (int again = 0; again < 2; ++again) {
      ASSERT_EQ(ThePlanner().BeginOnMap(scene.request), Status::kOk);
      while (ThePlanner().StepCells(64) == Progress::kBusy) {
      }
      EXPECT_EQ(HashOf(ThePlanner().result()), hash) << seed;
    }
  }
}

// However many that are, together they are not more than may be closed at once.
// SR-PLN07
TEST(Refusal, PlansOnOneMapRefuseMoreThanMayBeClosedAtOnce) {
  int refusals = 0;
  for (uint32_t seed = 1; seed <= 60 && refusals <= Planner::kMaxRefusals; ++seed) {
    Scene scene = Clutter(seed);
    refusals = PlanIn(scene).refusals;
    for (const float goal_y_m : {-16.1f, -8.1f, 8.1f, 16.1f}) {
      scene.request.goal_odom.y_m = goal_y_m;
      ASSERT_EQ(ThePlanner().BeginOnMap(scene.request), Status::kOk);
      while (ThePlanner().StepCells(64) == Progress::kBusy) {
      }
      refusals += ThePlanner().result().refusals;
    }
  }
  EXPECT_GT(refusals, Planner::kMaxRefusals);
}

//   [ > ]  #### x      the goal is moved to before the wall, and what touches it there ends short
TEST(Refusal, NothingIsClosedWhereThePathBeginsOrEnds) {
  Scene scene = SceneTo({12.1f, 0.1f});
  scene.Add(58, -20, 64, 20);
  scene.Add(50, -9, 58, -5);
  scene.Add(50, 5, 58, 9);
  EXPECT_EQ(PlanIn(scene).refusals, 0);
  Scene around = SceneTo({12.1f, 0.1f});
  around.Add(5, -3, 6, 3);
  around.Add(-6, 5, 6, 6);
  around.Add(-6, -6, 6, -5);
  EXPECT_EQ(PlanIn(around).refusals, 0);
}

TEST(Refusal, ClosesADiscOfCellsAndNothingElse) {
  const auto builder = std::make_unique<CostmapBuilder>();
  ASSERT_EQ(builder->BeginCells(kWindow, {}), Status::kOk);
  builder->SetCell(kWindow.Index({40, 40}), Costmap::kHard);
  ASSERT_EQ(builder->StepCells(CostmapBuilder::kUnits), Progress::kDone);
  const auto before = std::make_unique<Costmap>(builder->result());
  const Cell middle = {-3, 7};
  builder->Refuse(middle, 3);
  builder->Refuse({-256, 255}, CostmapBuilder::kMaxRefused_cells);  // the map's corner
  const Costmap& map = builder->result();
  int closed = 0;
  for (int index = 0; index < kMapCells; ++index) {
    EXPECT_EQ(map.cost_q8[index], before->cost_q8[index]);
    EXPECT_EQ(map.flags[index] & ~Costmap::kLethal, before->flags[index] & ~Costmap::kLethal);
    const Cell cell = kWindow.FromIndex(index);
    const int dx = cell.x - middle.x;
    const int dy = cell.y - middle.y;
    if (cell.x < -240 && cell.y > 240) continue;
    const bool is_closed = map.Lethal(index) && !before->Lethal(index);
    EXPECT_EQ(is_closed, dx * dx + dy * dy <= 9) << cell.x << ", " << cell.y;
    closed += is_closed ? 1 : 0;
  }
  EXPECT_EQ(closed, 29);
}

}  // namespace
}  // namespace hardpack
