// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/ceres_smoother.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/optimizer/optimizer.h"
#include "test/core/optimizer/optimizer_scene.h"

namespace hardpack::peers {
namespace {

constexpr CeresMethod kMethods[] = {CeresMethod::kTrustRegion, CeresMethod::kLineSearch};
constexpr int kIterations = 100;

bool SamePlace(const Pose2& a, const Pose2& b) {
  return a.x_m == b.x_m && a.y_m == b.y_m;
}

// Discs beside the way that Staircase takes from (0, 0), none near the start.
std::unique_ptr<Costmap> DiscMap(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Disc> discs;
  for (int i = 0; i < 12; ++i) {
    discs.push_back({4.0f + 0.1f * static_cast<float>(random() % 400),
                     -12.0f + 0.1f * static_cast<float>(random() % 240), 0.8f});
  }
  return MapOf([&discs](float x_m, float y_m) { return CostOfDiscs(discs, x_m, y_m); });
}

TEST(CeresSmoother, LowersTheCostAndLeavesTheEndsAlone) {
  const OptimizerParams params;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const std::unique_ptr<Costmap> map = DiscMap(seed);
    const WorldPath path = Staircase(seed, 150, {0.0f, 0.0f});
    for (const CeresMethod method : kMethods) {
      for (const bool keep_end_heading : {false, true}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", method "
                                        << static_cast<int>(method) << ", " << keep_end_heading);
        const CeresResult result =
            Smooth(method, *map, params, path, 0.02f, keep_end_heading, kIterations);
        ASSERT_TRUE(result.usable);
        ASSERT_EQ(result.path.size(), path.size());
        EXPECT_EQ(result.before.total(), CostOf(*map, params, path, 0.02f).total());
        EXPECT_EQ(result.after.total(), CostOf(*map, params, result.path, 0.02f).total());
        EXPECT_LT(result.after.total(), 0.7f * result.before.total());
        EXPECT_LE(result.iterations, kIterations);
        const int last = path.size() - 1;
        EXPECT_TRUE(SamePlace(result.path[0], path[0]));
        EXPECT_TRUE(SamePlace(result.path[1], path[1]));
        EXPECT_TRUE(SamePlace(result.path[last], path[last]));
        EXPECT_EQ(SamePlace(result.path[last - 1], path[last - 1]), keep_end_heading);
      }
    }
  }
}

TEST(CeresSmoother, StraightensAStaircaseWhereNothingIsInTheWay) {
  const std::unique_ptr<Costmap> map = EmptyMap();
  const WorldPath path = Staircase(7, 120, {0.0f, 0.0f});
  const CeresResult result =
      Smooth(CeresMethod::kTrustRegion, *map, OptimizerParams{}, path, 0.0f, false, kIterations);
  ASSERT_TRUE(result.usable);
  EXPECT_LT(result.after.total(), 0.1f * result.before.total());
}

// Points moved at random off the seed, so that limits are broken and obstacles are entered.
TEST(CeresSmoother, DerivativesAreThoseOfTheObjective) {
  constexpr double kStep_m = 1e-6;
  const OptimizerParams params;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const std::unique_ptr<Costmap> map = DiscMap(seed);
    const WorldPath path = Staircase(seed, 80, {0.0f, 0.0f});
    for (const CeresMethod method : kMethods) {
      for (const bool keep_end_heading : {false, true}) {
        std::mt19937 random(seed);
        std::vector<double> offsets_m(keep_end_heading ? 76 : 77);
        for (double& offset_m : offsets_m)
          offset_m = 1e-4 * static_cast<int>(random() % 2000) - 0.1;
        const auto value_at = [&](size_t moved, double by_m) {
          std::vector<double> offsets = offsets_m;
          offsets[moved] += by_m;
          return ObjectiveOf(method, *map, params, path, 0.02f, keep_end_heading, offsets).value;
        };
        const CeresObjective objective =
            ObjectiveOf(method, *map, params, path, 0.02f, keep_end_heading, offsets_m);
        ASSERT_EQ(objective.gradient_per_m.size(), offsets_m.size());
        for (size_t i = 0; i < offsets_m.size(); ++i) {
          const double slope = (value_at(i, kStep_m) - value_at(i, -kStep_m)) / (2.0 * kStep_m);
          EXPECT_NEAR(objective.gradient_per_m[i], slope, 1e-4 * (1.0 + std::abs(slope)))
              << "seed " << seed << ", method " << static_cast<int>(method) << ", free point " << i;
        }
      }
    }
  }
}

// A gentle wave breaks no limit, so that only the rounding of |u| near 0 tells the two apart.
TEST(CeresSmoother, MinimisesTheCostButForItsRounding) {
  const OptimizerParams params;
  const std::unique_ptr<Costmap> map = MapOf([](float x_m, float y_m) {
    return CostOfDiscs({{15.0f, 1.0f, 0.5f}}, x_m, y_m);
  });
  WorldPath path;
  for (int k = 0; k < 120; ++k) {
    const float x_m = 0.25f * static_cast<float>(k);
    ASSERT_EQ(path.PushBack({x_m, 0.5f * std::sin(0.4f * x_m), 0.0f}), Status::kOk);
  }
  const float start_curvature_per_m = 0.0f;
  const double cost = CostOf(*map, params, path, start_curvature_per_m).total();
  ASSERT_GT(cost, 2.0);
  const std::vector<double> none(117, 0.0);
  for (const CeresMethod method : kMethods) {
    const double rounded =
        ObjectiveOf(method, *map, params, path, start_curvature_per_m, false, none).value;
    EXPECT_LT(rounded, cost + 1e-4);
    EXPECT_GT(rounded, cost - 0.006 * path.size());
  }
}

TEST(CeresSmoother, BothMethodsMinimiseTheSame) {
  const std::unique_ptr<Costmap> map = DiscMap(5);  // free at the path's fixed first point
  const WorldPath path = Staircase(5, 60, {0.0f, 0.0f});
  const std::vector<double> offsets_m(57, 0.03);
  const CeresObjective squares =
      ObjectiveOf(CeresMethod::kTrustRegion, *map, OptimizerParams{}, path, 0.1f, false, offsets_m);
  const CeresObjective whole =
      ObjectiveOf(CeresMethod::kLineSearch, *map, OptimizerParams{}, path, 0.1f, false, offsets_m);
  ASSERT_EQ(map->CostAt(path[0].x_m, path[0].y_m), 0.0f);
  EXPECT_NEAR(squares.value, whole.value, 1e-9 * whole.value);
  for (size_t i = 0; i < offsets_m.size(); ++i) {
    EXPECT_NEAR(squares.gradient_per_m[i], whole.gradient_per_m[i], 1e-9) << "free point " << i;
  }
}

TEST(CeresSmoother, RefusesPathsThatAreNone) {
  const std::unique_ptr<Costmap> map = EmptyMap();
  const WorldPath good = Staircase(1, 20, {0.0f, 0.0f});
  WorldPath shorter = good;
  shorter.Resize(3);
  WorldPath repeated = good;
  repeated[9] = repeated[10];
  WorldPath missing = good;
  missing[5].y_m = std::numeric_limits<float>::quiet_NaN();
  WorldPath fixed = good;
  fixed.Resize(4);
  for (const CeresMethod method : kMethods) {
    for (const WorldPath& path : {shorter, repeated, missing}) {
      EXPECT_FALSE(Smooth(method, *map, {}, path, 0.0f, false, kIterations).usable);
    }
    EXPECT_FALSE(Smooth(method, *map, {}, fixed, 0.0f, true, kIterations).usable);
    EXPECT_FALSE(
        Smooth(method, *map, {}, good, std::numeric_limits<float>::infinity(), false, kIterations)
            .usable);
    EXPECT_TRUE(Smooth(method, *map, {}, good, 0.0f, false, kIterations).usable);
  }
}

}  // namespace
}  // namespace hardpack::peers
