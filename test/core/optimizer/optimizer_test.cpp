// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/optimizer.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/optimizer/basic_optimizer.h"
#include "test/core/optimizer/optimizer_scene.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// Weights of these tests, so that they do not hang on the vehicle's defaults.
OptimizerParams DescentParams() {
  OptimizerParams params;
  params.method = OptimizerParams::kPaperDescent;
  params.max_curvature_per_m = 0.5f;
  params.max_curvature_rate_per_m2 = 0.5f;
  params.curvature_alpha = 1.0f;
  params.curvature_beta = 40.0f;
  params.curvature_rate_alpha = 0.1f;
  params.curvature_rate_beta = 20.0f;
  params.perturbation_rad = 0.02f;
  params.max_perturbation_rad = 0.04f;
  params.perturbation_scale = 0.1f;
  params.window_steps = 20;
  params.max_sweeps = 100;
  params.min_relative_decrease = 0.01f;
  return params;
}

// The paper's descent; the other one is in lateral_newton_test.cpp.
class OptimizerTest : public ::testing::Test {
 protected:
  Status Begin(const WorldPath& seed) {
    return optimizer_->Begin(*map_, params_, path_params_, seed, start_curvature_per_m_,
                             keep_end_heading_);
  }

  const OptimizerResult& Run(const WorldPath& seed) {
    EXPECT_EQ(Begin(seed), Status::kOk);
    EXPECT_EQ(optimizer_->Step(*map_, kAllUnits), Progress::kDone);
    return optimizer_->result();
  }

  float CostNow() const {
    return CostOf(*map_, params_, optimizer_->path(), start_curvature_per_m_).total();
  }

  // Eight discs about a way along y = 0.
  void UseForest(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<Disc> discs;
    for (int i = 0; i < 12; ++i) {
      discs.push_back({22.0f * unit(random), 8.0f * unit(random), 1.0f + 0.5f * unit(random)});
    }
    map_ = MapOf([&](float x, float y) { return CostOfDiscs(discs, x, y); });
  }

  std::unique_ptr<Costmap> map_ = EmptyMap();
  std::unique_ptr<Optimizer> optimizer_ = std::make_unique<Optimizer>();
  OptimizerParams params_ = DescentParams();
  PathParams path_params_;
  float start_curvature_per_m_ = 0.0f;
  bool keep_end_heading_ = false;
};

TEST_F(OptimizerTest, LeavesAStraightLineStraight) {
  const WorldPath seed = Along({{-20.0f, -3.0f}, {20.0f, 5.0f}});
  const OptimizerResult& result = Run(seed);
  EXPECT_EQ(result.status, Status::kOk);
  for (const Pose2& pose : optimizer_->path()) {
    EXPECT_NEAR(pose.y_m, -3.0f + 0.2f * (pose.x_m + 20.0f), 1e-3f);
  }
}

TEST_F(OptimizerTest, RoundsACornerWithinTheLimits) {
  //            /
  //           /      45 degrees of A*, to be rounded
  //  --------+
  const WorldPath seed = Along({{-15.0f, 0.0f}, {0.0f, 0.0f}, {10.0f, 10.0f}});
  ASSERT_GT(ShapeOf(seed, 0.0f).largest_curvature_per_m, 1.5f);
  const OptimizerResult& result = Run(seed);
  EXPECT_EQ(result.status, Status::kOk);
  const Shape shape = ShapeOf(optimizer_->path(), 0.0f);
  EXPECT_LE(shape.largest_curvature_per_m, 0.505f);
  EXPECT_LE(shape.largest_rate_per_m2, 0.505f);
  EXPECT_LT(result.after.total(), 0.05f * result.before.total());
  // Turning by 45 degrees costs alpha pi / 4 at least.
  EXPECT_GE(result.after.total(), 0.99f * params_.curvature_alpha * kPi / 4.0f);
}

TEST_F(OptimizerTest, SmoothsStaircasesWithinTheLimits) {
  int within = 0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const OptimizerResult& result = Run(Staircase(seed, 150, {-20.0f, 0.0f}));
    EXPECT_LT(result.after.total(), 0.1f * result.before.total());
    const Shape shape = ShapeOf(optimizer_->path(), 0.0f);
    if (shape.largest_curvature_per_m <= 0.505f && shape.largest_rate_per_m2 <= 0.505f) ++within;
  }
  EXPECT_GE(within, kSeeds * 9 / 10);
}

TEST_F(OptimizerTest, LowersTheCostAroundAnObstacle) {
  //        .-##-.      the seed passes close by, straight on into the halo
  //  -----/-####-\---
  map_ = MapOf([](float x, float y) { return CostOfDiscs({{0.0f, -1.2f, 1.5f}}, x, y); });
  const WorldPath seed = Along({{-12.0f, 0.0f}, {12.0f, 0.0f}});
  const OptimizerResult& result = Run(seed);
  EXPECT_LT(result.after.map, 0.3f * result.before.map);
  EXPECT_LT(result.after.total(), 0.7f * result.before.total());
  float highest_m = -1e9f;
  for (const Pose2& pose : optimizer_->path()) highest_m = std::max(highest_m, pose.y_m);
  EXPECT_GT(highest_m, 0.5f);
}

TEST_F(OptimizerTest, DoesNotCrossAnObstacleToItsOtherSide) {
  //      .--.
  //   .-'    '-.      the seed goes round on the left and stays there
  //  -    ##    -
  map_ = MapOf([](float x, float y) { return CostOfDiscs({{0.0f, 0.0f, 2.0f}}, x, y); });
  Run(Along(
      {{-14.0f, 0.0f}, {-4.0f, 0.0f}, {-1.5f, 2.5f}, {1.5f, 2.5f}, {4.0f, 0.0f}, {14.0f, 0.0f}}));
  for (const Pose2& pose : optimizer_->path()) {
    if (std::abs(pose.x_m) < 0.5f) {
      EXPECT_GT(pose.y_m, 2.0f);
    }
    EXPECT_GT(std::hypot(pose.x_m, pose.y_m), 2.0f);
  }
}

TEST_F(OptimizerTest, PassesABendInANarrowCorridor) {
  //  #####################
  //              ________
  //  ___________/   ######   walls cost from 1.2 m off the middle on
  //  #######################
  const auto middle = [](float x) { return x < -3.0f ? 0.0f : x > 3.0f ? 4.0f : 2.0f + x / 1.5f; };
  map_ = MapOf([&](float x, float y) {
    const float off_m = std::abs(y - middle(x));
    return off_m < 0.8f ? 0.0f : std::min(30.0f, 8.0f * (off_m - 0.8f));
  });
  Run(Along({{-14.0f, 0.0f}, {-3.0f, 0.0f}, {3.0f, 4.0f}, {14.0f, 4.0f}}));
  for (const Pose2& pose : optimizer_->path()) {
    EXPECT_LT(std::abs(pose.y_m - middle(pose.x_m)), 1.4f) << pose.x_m;
  }
  const Shape shape = ShapeOf(optimizer_->path(), 0.0f);
  EXPECT_LE(shape.largest_curvature_per_m, 0.505f);
  EXPECT_LE(shape.largest_rate_per_m2, 0.505f);
}

TEST_F(OptimizerTest, NeverRaisesTheCostAndAlwaysHasAWholePath) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    const WorldPath start = Staircase(seed, 120, {-20.0f, -2.0f});
    ASSERT_EQ(Begin(start), Status::kOk);
    float cost = CostNow();
    EXPECT_EQ(cost, optimizer_->result().before.total());
    while (optimizer_->Step(*map_, 1) == Progress::kBusy) {
      const WorldPath& path = optimizer_->path();
      ASSERT_GE(path.size(), 4);
      EXPECT_EQ(path[0].x_m, start[0].x_m);
      EXPECT_EQ(path.back().x_m, start.back().x_m);
      EXPECT_EQ(path.back().y_m, start.back().y_m);
      const float now = CostNow();
      ASSERT_LE(now, cost * 1.000002f);  // to the rounding of a sum
      cost = now;
    }
  }
}

TEST_F(OptimizerTest, CostsItsResultAsCostOfDoes) {
  // Every kept perturbation updated only its window: had one missed a term, these would differ.
  int kept = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    start_curvature_per_m_ = 0.05f * static_cast<float>(seed) - 0.3f;
    keep_end_heading_ = seed % 2 == 1;
    params_.window_steps = 2 + 7 * static_cast<int>(seed);
    const OptimizerResult& result =
        Run(Staircase(seed, 60 + 15 * static_cast<int>(seed), {-20, 0}));
    const PathCost cost = CostOf(*map_, params_, optimizer_->path(), start_curvature_per_m_);
    EXPECT_EQ(result.after.map, cost.map);
    EXPECT_EQ(result.after.path, cost.path);
    EXPECT_LE(result.after.total(), result.before.total());
    kept += result.perturbations_kept;
  }
  EXPECT_GT(kept, 2000);
}

// One sweep of Algorithm 1 in unit steps, with the whole path costed for every candidate.
WorldPath SweepSlowly(const Costmap& map, const OptimizerParams& params, WorldPath path) {
  float cost = CostOf(map, params, path, 0.0f).total();
  for (int point = 1; point + 2 < path.size(); ++point) {
    WorldPath turned[2];
    float turned_cost[2];
    for (int side = 0; side < 2; ++side) {
      const float delta_rad = side == 0 ? params.perturbation_rad : -params.perturbation_rad;
      EXPECT_EQ(Perturb(path, point, delta_rad, params.window_steps, true, turned[side]),
                Status::kOk);
      turned_cost[side] = CostOf(map, params, turned[side], 0.0f).total();
    }
    const int better = turned_cost[1] < turned_cost[0] ? 1 : 0;
    if (turned_cost[better] >= cost) continue;
    path = turned[better];
    cost = turned_cost[better];
  }
  return path;
}

TEST_F(OptimizerTest, SweepsAsAlgorithmOneDoesWithWholePathCosts) {
  params_.perturbation_scale = 0.0f;
  for (unsigned seed = 20; seed < 26; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    const WorldPath start = Staircase(seed, 60, {-8.0f, 0.0f});
    ASSERT_EQ(Begin(start), Status::kOk);
    static_cast<void>(optimizer_->Step(*map_, start.size() - 3));  // one sweep
    const WorldPath slow = SweepSlowly(*map_, params_, start);
    ASSERT_EQ(slow.size(), optimizer_->path().size());
    for (int k = 0; k < slow.size(); ++k) {
      EXPECT_NEAR(optimizer_->path()[k].x_m, slow[k].x_m, 1e-3f) << k;
      EXPECT_NEAR(optimizer_->path()[k].y_m, slow[k].y_m, 1e-3f) << k;
    }
  }
}

TEST_F(OptimizerTest, GivesTheSameResultInUnitsOfAnySize) {
  UseForest(3);
  const WorldPath seed = Staircase(3, 90, {-12.0f, 0.0f});
  const OptimizerResult whole = Run(seed);
  const WorldPath path = optimizer_->path();
  for (const int units : {1, 7, 1000}) {
    ASSERT_EQ(Begin(seed), Status::kOk);
    while (optimizer_->Step(*map_, units) == Progress::kBusy) {
    }
    EXPECT_TRUE(SamePoints(optimizer_->path(), path)) << units;
    EXPECT_EQ(optimizer_->result().after.total(), whole.after.total());
    EXPECT_EQ(optimizer_->result().sweeps, whole.sweeps);
  }
}

TEST_F(OptimizerTest, KeepsBothEndsAndTheFirstChordBitForBit) {
  for (const bool keep_end : {false, true}) {
    keep_end_heading_ = keep_end;
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(seed);
      UseForest(seed);
      const WorldPath start = Staircase(seed, 100, {-14.0f, 1.0f});
      Run(start);
      const WorldPath& path = optimizer_->path();
      for (int k = 0; k < 2; ++k) {
        EXPECT_EQ(path[k].x_m, start[k].x_m);
        EXPECT_EQ(path[k].y_m, start[k].y_m);
      }
      EXPECT_EQ(path[0].theta_rad, start[0].theta_rad);
      EXPECT_EQ(path.back().x_m, start.back().x_m);
      EXPECT_EQ(path.back().y_m, start.back().y_m);
      if (!keep_end) continue;
      EXPECT_EQ(path[path.size() - 2].x_m, start[start.size() - 2].x_m);
      EXPECT_EQ(path[path.size() - 2].y_m, start[start.size() - 2].y_m);
      EXPECT_EQ(path.back().theta_rad, start.back().theta_rad);
    }
  }
}

TEST_F(OptimizerTest, TakesTheVehiclesCurvatureIntoAccount) {
  const WorldPath seed = Along({{0.0f, 0.0f}, {20.0f, 0.0f}});
  start_curvature_per_m_ = 0.4f;
  const OptimizerResult& result = Run(seed);
  EXPECT_GT(result.before.path, 1.0f);
  EXPECT_LT(result.after.path, 0.7f * result.before.path);
  EXPECT_LE(ShapeOf(optimizer_->path(), 0.4f).largest_rate_per_m2, 0.51f);
  EXPECT_GT(optimizer_->path()[3].y_m, 0.0f);  // it goes on turning left, less and less
}

TEST_F(OptimizerTest, SpreadsItsPointsEvenly) {
  const OptimizerResult& result = Run(Staircase(4, 150, {-20.0f, 0.0f}));
  EXPECT_GT(result.spreads_kept, 0);
  const Shape shape = ShapeOf(optimizer_->path(), 0.0f);
  EXPECT_LT(shape.longest_step_m, 1.1f * shape.shortest_step_m);
}

TEST_F(OptimizerTest, GainsLittleFromRunningOn) {
  UseForest(9);
  const WorldPath seed = Staircase(9, 130, {-18.0f, 0.0f});
  params_.max_sweeps = 60;
  const float soon = Run(seed).after.total();
  params_.max_sweeps = 1000;
  params_.min_relative_decrease = 1e-6f;
  const OptimizerResult& result = Run(seed);
  EXPECT_LE(soon, 1.3f * result.after.total());
}

TEST_F(OptimizerTest, SaysWhenTheSweepLimitEndsIt) {
  const WorldPath seed = Staircase(2, 100, {-14.0f, 0.0f});
  params_.max_sweeps = 2;
  EXPECT_EQ(Run(seed).status, Status::kIterationLimit);
  EXPECT_EQ(optimizer_->result().sweeps, 2);
  params_.max_sweeps = 0;
  EXPECT_EQ(Run(seed).status, Status::kIterationLimit);
  EXPECT_TRUE(SamePoints(optimizer_->path(), seed));
}

TEST_F(OptimizerTest, TakesTheShortestAndTheLongestSeed) {
  const WorldPath shortest = Along({{0.0f, 0.0f}, {0.4f, 0.0f}, {0.9f, 0.4f}}, 0.3f);
  ASSERT_EQ(shortest.size(), 4);
  Run(shortest);
  EXPECT_LE(optimizer_->result().after.total(), optimizer_->result().before.total());
  keep_end_heading_ = true;  // nothing is left to move
  EXPECT_EQ(Run(shortest).status, Status::kOk);
  EXPECT_TRUE(SamePoints(optimizer_->path(), shortest));
  keep_end_heading_ = false;
  const WorldPath longest = Staircase(1, kMaxPathPoints, {-40.0f, 0.0f});
  ASSERT_EQ(longest.size(), kMaxPathPoints);
  const OptimizerResult& result = Run(longest);
  EXPECT_LT(result.after.total(), result.before.total());
  EXPECT_LE(optimizer_->path().size(), kMaxPathPoints);
}

TEST_F(OptimizerTest, RefusesBadSeeds) {
  WorldPath seed = Along({{0.0f, 0.0f}, {10.0f, 0.0f}});
  WorldPath few = seed;
  few.Resize(3);
  EXPECT_EQ(Begin(few), Status::kPathTooShort);
  few.Clear();
  EXPECT_EQ(Begin(few), Status::kPathTooShort);
  WorldPath repeated = seed;
  repeated[5] = repeated[4];
  EXPECT_EQ(Begin(repeated), Status::kInvalidArgument);
  for (const float bad : {kNaN, kInfinity}) {
    for (int field = 0; field < 3; ++field) {
      WorldPath damaged = seed;
      float* const fields[] = {&damaged[7].x_m, &damaged[7].y_m, &damaged[7].theta_rad};
      *fields[field] = bad;
      EXPECT_EQ(Begin(damaged), Status::kNotFinite);
      EXPECT_TRUE(optimizer_->path().empty());
    }
    start_curvature_per_m_ = bad;
    EXPECT_EQ(Begin(seed), Status::kNotFinite);
    start_curvature_per_m_ = 0.0f;
  }
  start_curvature_per_m_ = 3e38f;  // finite, but its cost is not
  EXPECT_EQ(Begin(seed), Status::kNotFinite);
  EXPECT_EQ(optimizer_->Step(*map_, 10), Progress::kDone);
  EXPECT_EQ(optimizer_->result().status, Status::kNotFinite);
}

TEST_F(OptimizerTest, SurvivesAnyScale) {
  for (const float scale : {1e-3f, 1e-2f, 1e3f, 1e6f, 1e12f, 1e18f}) {
    SCOPED_TRACE(scale);
    WorldPath seed = Staircase(6, 60, {-3.0f, 1.0f});
    for (Pose2& pose : seed) {
      pose.x_m *= scale;
      pose.y_m *= scale;
    }
    params_.max_sweeps = 5;
    if (Begin(seed) != Status::kOk) continue;
    EXPECT_EQ(optimizer_->Step(*map_, kAllUnits), Progress::kDone);
    EXPECT_LE(optimizer_->result().after.total(), optimizer_->result().before.total());
    for (const Pose2& pose : optimizer_->path()) EXPECT_TRUE(IsFinite(pose));
  }
}

// A chord without length would be driven as a turn on the spot. On dear ground, where all draws a
// path together.
TEST_F(OptimizerTest, MakesNoChordShorterThanASeedsMayBe) {
  for (uint16_t& cost_q8 : map_->cost_q8) cost_q8 = kMaxCost_q8;
  path_params_.step_m = 0.05f;
  params_.curvature_beta = 10000.0f;
  params_.curvature_rate_beta = 10000.0f;
  for (unsigned seed_number = 1; seed_number <= 60; ++seed_number) {
    SCOPED_TRACE("seed " + std::to_string(seed_number));
    std::mt19937 random(seed_number);
    WorldPath seed;
    Vec2 at = {0.0f, 0.0f};
    start_curvature_per_m_ = std::uniform_real_distribution<float>(-20.0f, 20.0f)(random);
    params_.curvature_alpha = seed_number % 2 == 0 ? 0.0f : 1000.0f;
    params_.curvature_rate_alpha = seed_number % 3 == 0 ? 0.0f : 1000.0f;
    for (int k = 0; k < kMaxPathPoints; ++k) {
      ASSERT_EQ(seed.PushBack({at.x_m, at.y_m, 0.0f}), Status::kOk);
      const float heading_rad = std::uniform_real_distribution<float>(-3.1f, 3.1f)(random);
      at.x_m += 0.05f * std::cos(heading_rad);
      at.y_m += 0.05f * std::sin(heading_rad);
    }
    ASSERT_EQ(Begin(seed), Status::kOk);
    ASSERT_EQ(optimizer_->Step(*map_, kAllUnits), Progress::kDone);
    EXPECT_GE(ShapeOf(optimizer_->path(), 0.0f).shortest_step_m, 1e-4f);
  }
}

TEST_F(OptimizerTest, RefusesParametersOutOfRange) {
  const WorldPath seed = Along({{0.0f, 0.0f}, {10.0f, 0.0f}});
  const OptimizerParams good = DescentParams();
  float OptimizerParams::*const fields[] = {
      &OptimizerParams::max_curvature_per_m,  &OptimizerParams::max_curvature_rate_per_m2,
      &OptimizerParams::curvature_alpha,      &OptimizerParams::curvature_beta,
      &OptimizerParams::curvature_rate_alpha, &OptimizerParams::curvature_rate_beta,
      &OptimizerParams::perturbation_rad,     &OptimizerParams::max_perturbation_rad,
      &OptimizerParams::perturbation_scale,   &OptimizerParams::min_relative_decrease};
  for (float OptimizerParams::*const field : fields) {
    for (const float bad : {kNaN, kInfinity, -1.0f}) {
      params_ = good;
      params_.*field = bad;
      EXPECT_EQ(Begin(seed), Status::kParameterOutOfRange);
    }
  }
  for (const int window : {-1, 1, 256, INT32_MAX, INT32_MIN}) {
    params_ = good;
    params_.window_steps = window;
    EXPECT_EQ(Begin(seed), Status::kParameterOutOfRange) << window;
  }
  params_ = good;
  params_.max_sweeps = -1;
  EXPECT_EQ(Begin(seed), Status::kParameterOutOfRange);
  for (const int method : {-1, 2, INT32_MAX, INT32_MIN}) {
    params_ = good;
    params_.method = method;
    EXPECT_EQ(Begin(seed), Status::kParameterOutOfRange) << method;
  }
  for (const int steps : {-1, LateralNewton::kMaxSteps + 1, INT32_MAX, INT32_MIN}) {
    params_ = good;
    params_.max_newton_steps = steps;
    EXPECT_EQ(Begin(seed), Status::kParameterOutOfRange) << steps;
  }
  params_ = good;
  path_params_.step_m = kNaN;
  EXPECT_EQ(Begin(seed), Status::kParameterOutOfRange);
}

// A vehicle whose heading changes twice as much as its chords say.
struct EagerModel : PlanarModel {
  static float TurnBetween(Vec2 chord, Vec2 next_chord) {
    return 2.0f * PlanarModel::TurnBetween(chord, next_chord);
  }
};

TEST_F(OptimizerTest, TakesAnotherVehicleModel) {
  auto eager = std::make_unique<BasicOptimizer<EagerModel>>();
  const WorldPath seed = Along({{-15.0f, 0.0f}, {0.0f, 0.0f}, {10.0f, 10.0f}});
  ASSERT_EQ(eager->Begin(*map_, params_, path_params_, seed, 0.0f, false), Status::kOk);
  ASSERT_EQ(eager->Step(*map_, kAllUnits), Progress::kDone);
  EXPECT_LE(ShapeOf(eager->path(), 0.0f).largest_curvature_per_m, 0.26f);
}

}  // namespace
}  // namespace hardpack
