// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/lateral_newton.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/optimizer/optimizer.h"
#include "test/core/optimizer/optimizer_scene.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// Weights of these tests, so that they do not hang on the vehicle's defaults.
OptimizerParams NewtonParams() {
  OptimizerParams params;
  params.method = OptimizerParams::kLateralNewton;
  params.max_curvature_per_m = 0.5f;
  params.max_curvature_rate_per_m2 = 0.5f;
  params.curvature_alpha = 1.0f;
  params.curvature_beta = 40.0f;
  params.curvature_rate_alpha = 0.1f;
  params.curvature_rate_beta = 20.0f;
  params.min_relative_decrease = 0.01f;
  params.max_newton_steps = 20;
  return params;
}

class LateralNewtonTest : public ::testing::Test {
 protected:
  Status Begin(const WorldPath& seed) {
    return newton_->Begin(*map_, params_, path_params_, seed, start_curvature_per_m_,
                          keep_end_heading_);
  }

  const OptimizerResult& Run(const WorldPath& seed) {
    EXPECT_EQ(Begin(seed), Status::kOk);
    EXPECT_EQ(newton_->Step(*map_, kAllUnits), Progress::kDone);
    return newton_->result();
  }

  PathCost CostNow(const WorldPath& path) const {
    return CostOf(*map_, params_, path, start_curvature_per_m_);
  }

  // Discs about a way along y = 0; mirrored: about the x axis.
  void UseForest(unsigned seed, bool mirrored = false) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    std::vector<Disc> discs;
    for (int i = 0; i < 12; ++i) {
      const float x_m = 22.0f * unit(random);
      const float y_m = 8.0f * unit(random);
      discs.push_back({x_m, mirrored ? -y_m : y_m, 1.0f + 0.5f * unit(random)});
    }
    map_ = MapOf([&](float x, float y) { return CostOfDiscs(discs, x, y); });
  }

  std::unique_ptr<Costmap> map_ = EmptyMap();
  std::unique_ptr<LateralNewton> newton_ = std::make_unique<LateralNewton>();
  OptimizerParams params_ = NewtonParams();
  PathParams path_params_;
  float start_curvature_per_m_ = 0.0f;
  bool keep_end_heading_ = false;
};

TEST_F(LateralNewtonTest, LeavesAStraightLineStraight) {
  EXPECT_EQ(Run(Along({{-20.0f, -3.0f}, {20.0f, 5.0f}})).status, Status::kOk);
  for (const Pose2& pose : newton_->path()) {
    EXPECT_NEAR(pose.y_m, -3.0f + 0.2f * (pose.x_m + 20.0f), 1e-3f);
  }
}

TEST_F(LateralNewtonTest, CutsACornerOfOpenGroundAsFarAsItsStartHeadingLets) {
  //            +
  //         .-'      the end heading is free: nothing but the turn towards the end is needed
  //  ---.-'
  const OptimizerResult& result = Run(Along({{-15.0f, 0.0f}, {0.0f, 0.0f}, {10.0f, 10.0f}}));
  EXPECT_EQ(result.status, Status::kOk);
  const Shape shape = ShapeOf(newton_->path(), 0.0f);
  EXPECT_LE(shape.largest_curvature_per_m, 0.505f);
  EXPECT_LE(shape.largest_rate_per_m2, 0.505f);
  const float least = params_.curvature_alpha * std::atan2(10.0f, 25.0f);
  EXPECT_GE(result.after.total(), 0.99f * least);
  EXPECT_LE(result.after.total(), 1.35f * least);
}

TEST_F(LateralNewtonTest, SmoothsStaircasesWithinTheLimits) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const OptimizerResult& result = Run(Staircase(seed, 150, {-20.0f, 0.0f}));
    EXPECT_LT(result.after.total(), 0.1f * result.before.total());
    const Shape shape = ShapeOf(newton_->path(), 0.0f);
    EXPECT_LE(shape.largest_curvature_per_m, 0.505f);
    EXPECT_LE(shape.largest_rate_per_m2, 0.505f);
  }
}

TEST_F(LateralNewtonTest, LowersTheCostAroundAnObstacle) {
  //        .-##-.      the seed passes close by, straight on into the halo
  //  -----/-####-\---
  map_ = MapOf([](float x, float y) { return CostOfDiscs({{0.0f, -1.2f, 1.5f}}, x, y); });
  const OptimizerResult& result = Run(Along({{-12.0f, 0.0f}, {12.0f, 0.0f}}));
  EXPECT_LT(result.after.map, 0.3f * result.before.map);
  EXPECT_LT(result.after.total(), 0.7f * result.before.total());
  float highest_m = -1e9f;
  for (const Pose2& pose : newton_->path()) highest_m = std::max(highest_m, pose.y_m);
  EXPECT_GT(highest_m, 0.5f);
}

TEST_F(LateralNewtonTest, DoesNotCrossAnObstacleToItsOtherSide) {
  //      .--.
  //   .-'    '-.      the seed goes round on the left and stays there
  //  -    ##    -
  map_ = MapOf([](float x, float y) { return CostOfDiscs({{0.0f, 0.0f, 2.0f}}, x, y); });
  Run(Along(
      {{-14.0f, 0.0f}, {-4.0f, 0.0f}, {-1.5f, 2.5f}, {1.5f, 2.5f}, {4.0f, 0.0f}, {14.0f, 0.0f}}));
  for (const Pose2& pose : newton_->path()) {
    if (std::abs(pose.x_m) < 0.5f) {
      EXPECT_GT(pose.y_m, 2.0f);
    }
    EXPECT_GT(std::hypot(pose.x_m, pose.y_m), 2.0f);
  }
}

TEST_F(LateralNewtonTest, NeverRaisesTheCostAndAlwaysHasAWholePath) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    const WorldPath start = Staircase(seed, 120, {-20.0f, -2.0f});
    ASSERT_EQ(Begin(start), Status::kOk);
    float cost = CostNow(newton_->path()).total();
    EXPECT_EQ(cost, newton_->result().before.total());
    while (newton_->Step(*map_, 1) == Progress::kBusy) {
      const WorldPath& path = newton_->path();
      ASSERT_GE(path.size(), 4);
      EXPECT_EQ(path[0].x_m, start[0].x_m);
      EXPECT_EQ(path.back().x_m, start.back().x_m);
      EXPECT_EQ(path.back().y_m, start.back().y_m);
      const float now = CostNow(path).total();
      ASSERT_LE(now, cost * 1.00001f);  // to the rounding of a sum
      cost = now;
    }
  }
}

TEST_F(LateralNewtonTest, CostsItsResultAsCostOfDoes) {
  int kept = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    start_curvature_per_m_ = 0.05f * static_cast<float>(seed) - 0.3f;
    keep_end_heading_ = seed % 2 == 1;
    const OptimizerResult& result =
        Run(Staircase(seed, 60 + 15 * static_cast<int>(seed), {-20, 0}));
    const PathCost cost = CostNow(newton_->path());
    EXPECT_EQ(result.after.map, cost.map);
    EXPECT_EQ(result.after.path, cost.path);
    EXPECT_LE(result.after.total(), result.before.total());
    kept += result.perturbations_kept;
  }
  EXPECT_GT(kept, 60);
}

TEST_F(LateralNewtonTest, GivesTheSameResultInUnitsOfAnySize) {
  UseForest(3);
  const WorldPath seed = Staircase(3, 90, {-12.0f, 0.0f});
  const OptimizerResult whole = Run(seed);
  const WorldPath path = newton_->path();
  for (const int units : {1, 7, 1000}) {
    ASSERT_EQ(Begin(seed), Status::kOk);
    while (newton_->Step(*map_, units) == Progress::kBusy) {
    }
    EXPECT_TRUE(SamePoints(newton_->path(), path)) << units;
    EXPECT_EQ(newton_->result().after.total(), whole.after.total());
    EXPECT_EQ(newton_->result().sweeps, whole.sweeps);
  }
}

TEST_F(LateralNewtonTest, RemembersNothingOfEarlierPaths) {
  UseForest(3);
  const WorldPath seed = Staircase(3, 90, {-12.0f, 0.0f});
  Run(seed);
  const WorldPath fresh = newton_->path();
  for (const float scale : {1.0f, 1e15f}) {  // a longer one, and one of huge numbers
    WorldPath other = Staircase(7, 200, {-20.0f, 0.0f});
    for (Pose2& pose : other) {
      pose.x_m *= scale;
      pose.y_m *= scale;
    }
    Run(other);
    Run(seed);
    EXPECT_TRUE(SamePoints(newton_->path(), fresh));
  }
}

TEST_F(LateralNewtonTest, KeepsBothEndsAndTheFirstChordBitForBit) {
  for (const bool keep_end : {false, true}) {
    keep_end_heading_ = keep_end;
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(seed);
      UseForest(seed);
      const WorldPath start = Staircase(seed, 100, {-14.0f, 1.0f});
      Run(start);
      const WorldPath& path = newton_->path();
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

TEST_F(LateralNewtonTest, TakesTheVehiclesCurvatureIntoAccount) {
  start_curvature_per_m_ = 0.4f;
  const OptimizerResult& result = Run(Along({{0.0f, 0.0f}, {20.0f, 0.0f}}));
  EXPECT_GT(result.before.path, 1.0f);
  EXPECT_LT(result.after.path, 0.7f * result.before.path);
  EXPECT_LE(ShapeOf(newton_->path(), 0.4f).largest_rate_per_m2, 0.505f);
  EXPECT_GT(newton_->path()[3].y_m, 0.0f);  // it goes on turning left, less and less
}

TEST_F(LateralNewtonTest, SpreadsItsPointsEvenly) {
  Run(Staircase(4, 150, {-20.0f, 0.0f}));
  const Shape open = ShapeOf(newton_->path(), 0.0f);
  EXPECT_LT(open.longest_step_m, 1.1f * open.shortest_step_m);
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    Run(Staircase(seed, 150, {-20.0f, 0.0f}));
    const Shape shape = ShapeOf(newton_->path(), 0.0f);
    EXPECT_LT(shape.longest_step_m, 2.0f * shape.shortest_step_m);
  }
}

// The same problem seen in a mirror, start curvature and all. What is rounded otherwise may grow,
// where two ways cost the same; here one is cheaper.
TEST_F(LateralNewtonTest, BendsAMirroredPathTheOtherWay) {
  //        .--.                             ----------.  ## .---
  //  -----'    '----     and in the mirror             '--'
  //         ##
  const auto disc = [](float y_m) {
    return MapOf([=](float x, float y) { return CostOfDiscs({{1.0f, y_m, 1.5f}}, x, y); });
  };
  map_ = disc(-1.2f);
  start_curvature_per_m_ = 0.2f;
  const float cost = Run(Along({{-12.0f, 0.0f}, {12.0f, 0.8f}})).after.total();
  const WorldPath path = newton_->path();
  map_ = disc(1.2f);
  start_curvature_per_m_ = -0.2f;
  EXPECT_NEAR(Run(Along({{-12.0f, 0.0f}, {12.0f, -0.8f}})).after.total(), cost, 0.01f * cost);
  ASSERT_EQ(newton_->path().size(), path.size());
  for (int k = 0; k < path.size(); ++k) {
    EXPECT_NEAR(newton_->path()[k].x_m, path[k].x_m, 0.05f) << k;
    EXPECT_NEAR(newton_->path()[k].y_m, -path[k].y_m, 0.05f) << k;
  }
}

// A smooth bump to one side, over the points about `middle`.
WorldPath Bumped(const WorldPath& path, int middle, int half_width, float size_m) {
  WorldPath bumped = path;
  for (int k = middle - half_width + 1; k < middle + half_width; ++k) {
    const float t = static_cast<float>(k - middle) / static_cast<float>(half_width);
    const float move_m = size_m * (1.0f - t * t) * (1.0f - t * t) * (1.0f - t * t);
    bumped[k].x_m -= move_m * std::sin(path[k].theta_rad);
    bumped[k].y_m += move_m * std::cos(path[k].theta_rad);
  }
  return bumped;
}

// An independent look for something that was left undone.
TEST_F(LateralNewtonTest, LeavesNoBumpThatWouldLowerTheCostMuch) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    const float cost = Run(Staircase(seed, 130, {-18.0f, 0.0f})).after.total();
    const WorldPath path = newton_->path();
    for (const int half_width : {4, 8, 16, 32}) {
      for (int middle = half_width + 2; middle + half_width < path.size() - 1; middle += 3) {
        for (const float size_m : {-0.1f, -0.02f, -0.004f, 0.004f, 0.02f, 0.1f}) {
          EXPECT_GE(CostNow(Bumped(path, middle, half_width, size_m)).total(), 0.97f * cost)
              << middle << ' ' << half_width << ' ' << size_m;
        }
      }
    }
  }
}

// On problems of which each is made of discs and of a staircase through them. Run to convergence,
// the paper's solver is stopped by nothing but its own steps.
TEST_F(LateralNewtonTest, IsSeldomWorseThanThePapersDescentRunToConvergence) {
  constexpr int kProblems = 12;
  auto descent = std::make_unique<Optimizer>();
  OptimizerParams converged = params_;
  converged.method = OptimizerParams::kPaperDescent;
  converged.max_sweeps = 200;
  converged.min_relative_decrease = 1e-4f;
  int not_worse = 0;
  int lost_limits = 0;
  for (unsigned seed = 100; seed < 100 + kProblems; ++seed) {
    SCOPED_TRACE(seed);
    UseForest(seed);
    const WorldPath start = Staircase(seed, 110, {-16.0f, 0.0f});
    const OptimizerResult& result = Run(start);
    ASSERT_EQ(descent->Begin(*map_, converged, path_params_, start, 0.0f, false), Status::kOk);
    ASSERT_EQ(descent->Step(*map_, kAllUnits), Progress::kDone);
    if (result.after.total() <= 1.001f * descent->result().after.total()) ++not_worse;
    const Shape theirs = ShapeOf(descent->path(), 0.0f);
    const Shape ours = ShapeOf(newton_->path(), 0.0f);
    const bool they_keep =
        theirs.largest_curvature_per_m <= 0.505f && theirs.largest_rate_per_m2 <= 0.505f;
    const bool we_keep =
        ours.largest_curvature_per_m <= 0.505f && ours.largest_rate_per_m2 <= 0.505f;
    if (they_keep && !we_keep) ++lost_limits;
  }
  EXPECT_GE(not_worse, kProblems - 1);
  EXPECT_EQ(lost_limits, 0);
}

TEST_F(LateralNewtonTest, SaysWhenTheStepLimitEndsIt) {
  UseForest(2);
  const WorldPath seed = Staircase(2, 100, {-14.0f, 0.0f});
  params_.max_newton_steps = 2;
  EXPECT_EQ(Run(seed).status, Status::kIterationLimit);
  EXPECT_EQ(newton_->result().sweeps, 2);
  params_.min_relative_decrease = 0.5f;  // while the kinks are wide, that tells nothing
  EXPECT_EQ(Run(seed).status, Status::kIterationLimit);
  params_.max_newton_steps = 0;
  EXPECT_EQ(Run(seed).status, Status::kIterationLimit);
  EXPECT_TRUE(SamePoints(newton_->path(), seed));
}

// There is always a share of next to nothing left to gain.
TEST_F(LateralNewtonTest, IsDoneWhereNextToNoCostIsLeft) {
  //        .-'-.
  //  -----'     '-----      on open ground: straight it would cost nothing
  for (int tenths_m = 5; tenths_m <= 30; ++tenths_m) {
    SCOPED_TRACE(tenths_m);
    const float aside_m = 0.1f * static_cast<float>(tenths_m);
    const OptimizerResult& result =
        Run(Along({{-20.0f, 0.0f}, {-10.0f, 0.0f}, {0.0f, aside_m}, {10.0f, 0.0f}, {20.0f, 0.0f}}));
    EXPECT_LT(result.after.total(), 0.05f);
    EXPECT_EQ(result.status, Status::kOk);
  }
}

TEST_F(LateralNewtonTest, TakesTheShortestAndTheLongestSeed) {
  const WorldPath shortest = Along({{0.0f, 0.0f}, {0.4f, 0.0f}, {0.9f, 0.4f}}, 0.3f);
  ASSERT_EQ(shortest.size(), 4);
  Run(shortest);
  EXPECT_LE(newton_->result().after.total(), newton_->result().before.total());
  keep_end_heading_ = true;  // nothing is left to move
  EXPECT_EQ(Run(shortest).status, Status::kOk);
  EXPECT_TRUE(SamePoints(newton_->path(), shortest));
  keep_end_heading_ = false;
  const WorldPath longest = Staircase(1, kMaxPathPoints, {-40.0f, 0.0f});
  ASSERT_EQ(longest.size(), kMaxPathPoints);
  const OptimizerResult& result = Run(longest);
  EXPECT_LT(result.after.total(), result.before.total());
  EXPECT_LE(newton_->path().size(), kMaxPathPoints);
}

TEST_F(LateralNewtonTest, RefusesBadSeeds) {
  const WorldPath seed = Along({{0.0f, 0.0f}, {10.0f, 0.0f}});
  WorldPath few = seed;
  few.Resize(3);
  EXPECT_EQ(Begin(few), Status::kPathTooShort);
  WorldPath repeated = seed;
  repeated[5] = repeated[4];
  EXPECT_EQ(Begin(repeated), Status::kInvalidArgument);
  // Wherever it is, and only there: a chord across the origin is as good as any.
  WorldPath along_y = Along({{3.0f, 2.0f}, {3.0f, 12.0f}});
  EXPECT_TRUE(IsUsable(Begin(along_y)));
  along_y[5] = along_y[4];
  EXPECT_EQ(Begin(along_y), Status::kInvalidArgument);
  for (const Vec2 half : {Vec2{0.1f, 0.0f}, Vec2{0.0f, 0.1f}, Vec2{0.1f, 0.1f}}) {
    WorldPath across;
    across.Resize(8);
    for (int k = 0; k < across.size(); ++k) {
      const auto steps = static_cast<float>(2 * k - 7);
      across[k] = {steps * half.x_m, steps * half.y_m, HeadingOf(half)};
    }
    EXPECT_TRUE(IsUsable(Begin(across)));
  }
  for (const float bad : {kNaN, kInfinity}) {
    WorldPath damaged = seed;
    damaged[7].y_m = bad;
    EXPECT_EQ(Begin(damaged), Status::kNotFinite);
    EXPECT_TRUE(newton_->path().empty());
    start_curvature_per_m_ = bad;
    EXPECT_EQ(Begin(seed), Status::kNotFinite);
    start_curvature_per_m_ = 0.0f;
  }
  start_curvature_per_m_ = 3e38f;  // finite, but its cost is not
  EXPECT_EQ(Begin(seed), Status::kNotFinite);
  EXPECT_EQ(newton_->Step(*map_, 10), Progress::kDone);
  EXPECT_EQ(newton_->result().status, Status::kNotFinite);
}

TEST_F(LateralNewtonTest, SurvivesAnyScaleAndAnyShape) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (const float scale : {1e-3f, 1e-2f, 1.0f, 1e3f, 1e6f, 1e12f, 1e18f}) {
    SCOPED_TRACE(scale);
    for (const bool folded : {false, true}) {
      WorldPath seed = Staircase(6, 60, {-3.0f, 1.0f});
      for (Pose2& pose : seed) {
        if (folded) pose = {unit(random), unit(random), 0.0f};
        pose.x_m *= scale;
        pose.y_m *= scale;
      }
      if (Begin(seed) != Status::kOk) continue;
      EXPECT_EQ(newton_->Step(*map_, kAllUnits), Progress::kDone);
      EXPECT_LE(newton_->result().after.total(), newton_->result().before.total());
      for (const Pose2& pose : newton_->path()) EXPECT_TRUE(IsFinite(pose));
    }
  }
}

TEST_F(LateralNewtonTest, TakesAPathThatTurnsBackOnItself) {
  WorldPath seed = Along({{0.0f, 0.0f}, {8.0f, 0.0f}});
  for (int k = 20; k < seed.size(); ++k) seed[k].x_m = seed[19].x_m - 0.275f * float(k - 19);
  const OptimizerResult& result = Run(seed);
  EXPECT_LE(result.after.total(), result.before.total());
}

TEST_F(LateralNewtonTest, TakesWeightsOfZero) {
  UseForest(4);
  params_.curvature_alpha = 0.0f;
  params_.curvature_beta = 0.0f;
  params_.curvature_rate_alpha = 0.0f;
  params_.curvature_rate_beta = 0.0f;
  const OptimizerResult& result = Run(Staircase(4, 100, {-14.0f, 0.0f}));
  EXPECT_LE(result.after.total(), result.before.total());
}

TEST_F(LateralNewtonTest, IsWhatTheOptimizerRunsByDefault) {
  UseForest(5);
  const WorldPath seed = Staircase(5, 100, {-14.0f, 0.0f});
  params_ = OptimizerParams{};
  const OptimizerResult& result = Run(seed);
  auto optimizer = std::make_unique<Optimizer>();
  ASSERT_EQ(optimizer->Begin(*map_, params_, path_params_, seed, 0.0f, false), Status::kOk);
  ASSERT_EQ(optimizer->Step(*map_, kAllUnits), Progress::kDone);
  EXPECT_TRUE(SamePoints(optimizer->path(), newton_->path()));
  EXPECT_EQ(optimizer->result().after.total(), result.after.total());
}

}  // namespace
}  // namespace hardpack
