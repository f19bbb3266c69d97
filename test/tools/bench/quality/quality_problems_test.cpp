// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_problems.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "core/autonomy/planner.h"
#include "tools/bench/quality/quality_terrain.h"

namespace hardpack::command {
namespace {

constexpr uint32_t kSeed = 1;
constexpr int kAllUnits = 1'000'000;

bool IsHard(const Terrain& terrain, int index) {
  return (terrain.flags()[static_cast<size_t>(index)] & Costmap::kHard) != 0;
}

// The place of a cell's centre in the way's frame, in double precision.
std::pair<double, double> InWay(const Way& way, int index) {
  const Vec2 cell = CellCenter(GridWindow::CenteredAt({}).FromIndex(index));
  const double dx_m = double{cell.x_m} - double{way.start_odom.x_m};
  const double dy_m = double{cell.y_m} - double{way.start_odom.y_m};
  const double cosine = std::cos(double{way.direction_rad});
  const double sine = std::sin(double{way.direction_rad});
  return {cosine * dx_m + sine * dy_m, cosine * dy_m - sine * dx_m};
}

constexpr Way kWay = {{-3.0f, 7.0f}, 0.7f, 20.0f};
constexpr double kRounding_m = 1.0e-4;

//   start ---> x         __________
//     |                 (__________)   hard within 1.5 m of the piece from (2, -3) to (9, -3)
//     y to the left
TEST(Terrain, StrokeCoversItsRadiusInTheFrameOfTheWay) {
  Terrain terrain(kWay);
  terrain.Stroke({2.0f, -3.0f}, {9.0f, -3.0f}, 1.5f, Costmap::kHard);
  int hard = 0;
  for (int i = 0; i < kMapCells; ++i) {
    const auto [x_m, y_m] = InWay(kWay, i);
    const double off_m = std::hypot(x_m - std::clamp(x_m, 2.0, 9.0), y_m + 3.0);
    if (std::abs(off_m - 1.5) < kRounding_m) continue;
    ASSERT_EQ(IsHard(terrain, i), off_m < 1.5) << x_m << " " << y_m;
    hard += IsHard(terrain, i) ? 1 : 0;
  }
  EXPECT_GT(hard, 600);
}

TEST(Terrain, ThinnestStrokeStillMarksTheCellItStandsIn) {
  Terrain terrain(kWay);
  terrain.Disc({5.0f, 0.0f}, 0.0f, Costmap::kHard);
  const Cell cell = CellAt(kWay.ToOdom({5.0f, 0.0f}));
  EXPECT_TRUE(IsHard(terrain, GridWindow::CenteredAt({}).Index(cell)));
}

TEST(Terrain, BoxIsTurnedAgainstTheWay) {
  Terrain terrain(kWay);
  terrain.Box({6.0f, 1.0f}, 2.0f, 0.6f, 0.5f, Costmap::kHard);
  for (int i = 0; i < kMapCells; ++i) {
    const auto [x_m, y_m] = InWay(kWay, i);
    const double u_m = std::abs(std::cos(0.5) * (x_m - 6.0) + std::sin(0.5) * (y_m - 1.0));
    const double v_m = std::abs(std::cos(0.5) * (y_m - 1.0) - std::sin(0.5) * (x_m - 6.0));
    if (std::abs(u_m - 2.0) < kRounding_m || std::abs(v_m - 0.6) < kRounding_m) continue;
    ASSERT_EQ(IsHard(terrain, i), u_m < 2.0 && v_m < 0.6) << x_m << " " << y_m;
  }
}

TEST(Terrain, UnobservedGroundSparesObstacles) {
  Terrain terrain(kWay);
  terrain.Disc({5.0f, 0.0f}, 0.5f, Costmap::kHard);
  terrain.Unobserved({5.0f, 0.0f}, 2.0f);
  int unobserved = 0;
  for (int i = 0; i < kMapCells; ++i) {
    const bool observed = (terrain.flags()[static_cast<size_t>(i)] & Costmap::kObserved) != 0;
    ASSERT_TRUE(observed || !IsHard(terrain, i));
    unobserved += observed ? 0 : 1;
  }
  EXPECT_GT(unobserved, 200);
}

bool SamePath(const WorldPath& a, const WorldPath& b) {
  if (a.size() != b.size()) return false;
  for (int k = 0; k < a.size(); ++k) {
    if (std::memcmp(&a[k], &b[k], sizeof(Pose2)) != 0) return false;
  }
  return true;
}

TEST(QualityProblems, AreTheSameAgain) {
  SeedMaker first(PlannerParams{});
  SeedMaker second(PlannerParams{});
  for (const int number : {1, 15, 36}) {
    // Another problem in between leaves no trace.
    ASSERT_TRUE(MakeQualityProblem(kSeed, number + 1, second));
    const auto a = MakeQualityProblem(kSeed, number, first);
    const auto b = MakeQualityProblem(kSeed, number, second);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->flags, b->flags);
    EXPECT_TRUE(SamePath(first.result().base, second.result().base));
    EXPECT_TRUE(SamePath(first.result().seed, second.result().seed));
  }
}

TEST(QualityProblems, DependOnTheSeed) {
  SeedMaker maker(PlannerParams{});
  const auto a = MakeQualityProblem(kSeed, 1, maker);
  const auto b = MakeQualityProblem(kSeed + 1, 1, maker);
  ASSERT_TRUE(a && b);
  EXPECT_NE(a->flags, b->flags);
}

TEST(QualityProblems, TakeTurnsAmongKindsAndLengths) {
  SeedMaker maker(PlannerParams{});
  std::set<std::string> kinds;
  for (const int number : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}) {
    const auto problem = MakeQualityProblem(kSeed, number, maker);
    ASSERT_TRUE(problem) << number;
    EXPECT_EQ(problem->number, number);
    EXPECT_NEAR(maker.result().seed.size(), 200, 30);
    kinds.insert(problem->kind);
  }
  EXPECT_EQ(kinds.size(), 10u);
  ASSERT_TRUE(MakeQualityProblem(kSeed, 31, maker));
  EXPECT_NEAR(maker.result().seed.size(), 100, 25);
}

// An optimizer that is given no sweeps leaves the seed: so the planner shows what it began with.
TEST(QualityProblems, SeedsAreThePlannersOwn) {
  PlannerParams params;
  params.optimizer.method = OptimizerParams::kPaperDescent;
  params.optimizer.max_sweeps = 0;
  SeedMaker maker(params);
  const auto planner = std::make_unique<Planner>();
  int compared = 0;
  int with_goal_heading = 0;
  for (int number = 1; number <= 40; number += 2) {
    const auto problem = MakeQualityProblem(kSeed, number, maker);
    ASSERT_TRUE(problem);
    PlanRequest request;
    request.start = problem->start;
    request.goal_odom = problem->goal_odom;
    request.has_goal_heading = problem->has_goal_heading;
    request.goal_heading_rad = problem->goal_heading_rad;
    ASSERT_EQ(planner->BeginCells(GridWindow::CenteredAt({}), params, request), Status::kOk);
    for (int i = 0; i < kMapCells; ++i) {
      planner->costmap_builder().SetCell(i, problem->flags[static_cast<size_t>(i)]);
    }
    while (planner->StepCells(kAllUnits) == Progress::kBusy) {
    }
    const Plan& plan = planner->result();
    // Where a seed touches something the planner goes on to try others.
    if (plan.is_seed || plan.ends_short || plan.pivots_first || !IsUsable(plan.status)) continue;
    EXPECT_TRUE(SamePath(plan.path, maker.result().seed)) << "problem " << number;
    ++compared;
    with_goal_heading += problem->has_goal_heading ? 1 : 0;
  }
  EXPECT_GE(compared, 8);
  EXPECT_GE(with_goal_heading, 1);
}

}  // namespace
}  // namespace hardpack::command
