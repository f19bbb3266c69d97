// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "core/optimizer/optimizer.h"
#include "test/core/optimizer/optimizer_scene.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kNaN;

TEST(Perturb, KeepsEverythingOutsideTheWindow) {
  //            .-.          turned at 5, back on the path at 30
  //  0 ... 5 -'   '- 30 ... 59
  const WorldPath path = Staircase(1, 60, {3.0f, -7.0f});
  WorldPath perturbed;
  ASSERT_EQ(Perturb(path, 5, 0.3f, 25, true, perturbed), Status::kOk);
  ASSERT_EQ(perturbed.size(), path.size());
  for (int k = 0; k < path.size(); ++k) {
    const bool moved = perturbed[k].x_m != path[k].x_m || perturbed[k].y_m != path[k].y_m;
    // The last two of the window may be blended back to within a rounding.
    if (k == 28 || k == 29) continue;
    EXPECT_EQ(moved, k > 5 && k < 28) << k;
  }
}

TEST(Perturb, TurnsByDeltaAtThePoint) {
  const WorldPath path = Along({{0.0f, 0.0f}, {20.0f, 0.0f}});
  for (const float delta_rad : {-0.5f, -0.02f, 0.02f, 0.5f}) {
    WorldPath perturbed;
    ASSERT_EQ(Perturb(path, 5, delta_rad, 25, true, perturbed), Status::kOk);
    EXPECT_NEAR(perturbed[5].theta_rad, delta_rad, 2e-3f * std::abs(delta_rad));
    EXPECT_EQ(perturbed[4].theta_rad, 0.0f);
  }
}

// The paper's words: add delta to the step's phi, integrate forward, blend in world space.
TEST(Perturb, IsIntegrationBlendedByAQuintic) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    const WorldPath path = Staircase(seed, 80, {-10.0f, 4.0f});
    std::mt19937 random(seed);
    const int point = 1 + static_cast<int>(random() % 76);
    const int window = 2 + static_cast<int>(random() % 40);
    const float delta_rad = 0.4f * (static_cast<float>(random() % 1000) / 500.0f - 1.0f);
    ActuatorPath steps;
    WorldPath turned;
    ASSERT_EQ(ToActuator<PlanarModel>(path, steps), Status::kOk);
    steps.steps[point - 1].phi_rad += delta_rad;
    ASSERT_EQ(ToWorld<PlanarModel>(steps, turned), Status::kOk);
    WorldPath perturbed;
    WorldPath free;
    ASSERT_EQ(Perturb(path, point, delta_rad, window, true, perturbed), Status::kOk);
    ASSERT_EQ(Perturb(path, point, delta_rad, window, false, free), Status::kOk);
    const int used = std::min(window, path.size() - 1 - point);
    for (int k = 0; k < path.size(); ++k) {
      EXPECT_NEAR(free[k].x_m, turned[k].x_m, 1e-4f) << k;
      EXPECT_NEAR(free[k].y_m, turned[k].y_m, 1e-4f) << k;
      const double t = std::clamp((k - point) / static_cast<double>(used), 0.0, 1.0);
      const double blend = t * t * t * (t * (t * 6 - 15) + 10);
      EXPECT_NEAR(perturbed[k].x_m, (1 - blend) * turned[k].x_m + blend * path[k].x_m, 1e-4) << k;
      EXPECT_NEAR(perturbed[k].y_m, (1 - blend) * turned[k].y_m + blend * path[k].y_m, 1e-4) << k;
    }
  }
}

TEST(Perturb, LeavesNoStepOfCurvatureWhereTheWindowEnds) {
  // A quintic's second derivative is zero at the end, and grows from there by 60 delta / D^2 a
  // metre: the curvature one step before the end is small, a cubic blend's would be 4 delta / D.
  const WorldPath path = Along({{0.0f, 0.0f}, {20.0f, 0.0f}});
  constexpr float kDelta_rad = 0.2618f;
  WorldPath perturbed;
  ASSERT_EQ(Perturb(path, 10, kDelta_rad, 25, true, perturbed), Status::kOk);
  const float window_m = 25.0f * 0.275f;
  const float turn_rad = perturbed[35].theta_rad - perturbed[34].theta_rad;
  EXPECT_LT(std::abs(turn_rad / 0.275f), 0.5f * 4.0f * kDelta_rad / window_m);
  const float next_rad = perturbed[36].theta_rad - perturbed[35].theta_rad;
  EXPECT_EQ(next_rad, 0.0f);
}

TEST(Perturb, ShrinksItsWindowNearTheEnd) {
  const WorldPath path = Along({{0.0f, 0.0f}, {5.6f, 0.0f}});
  WorldPath perturbed;
  const int last = path.size() - 1;
  ASSERT_EQ(Perturb(path, last - 2, 0.2f, 25, true, perturbed), Status::kOk);
  EXPECT_NE(perturbed[last - 1].y_m, 0.0f);
  EXPECT_EQ(perturbed[last].x_m, path[last].x_m);
  EXPECT_EQ(perturbed[last].y_m, 0.0f);
}

TEST(Perturb, WorksInPlace) {
  const WorldPath path = Staircase(4, 50, {0.0f, 0.0f});
  WorldPath apart;
  WorldPath same = path;
  ASSERT_EQ(Perturb(path, 7, 0.1f, 20, true, apart), Status::kOk);
  ASSERT_EQ(Perturb(same, 7, 0.1f, 20, true, same), Status::kOk);
  EXPECT_TRUE(SamePoints(apart, same));
}

TEST(Perturb, RefusesBadArguments) {
  WorldPath path = Along({{0.0f, 0.0f}, {5.0f, 0.0f}});
  const int last = path.size() - 1;
  WorldPath perturbed;
  EXPECT_EQ(Perturb(path, -1, 0.1f, 25, true, perturbed), Status::kInvalidArgument);
  EXPECT_EQ(Perturb(path, last - 1, 0.1f, 25, true, perturbed), Status::kInvalidArgument);
  EXPECT_EQ(Perturb(path, last, 0.1f, 25, false, perturbed), Status::kInvalidArgument);
  EXPECT_EQ(Perturb(path, INT32_MAX, 0.1f, 25, true, perturbed), Status::kInvalidArgument);
  EXPECT_EQ(Perturb(path, 2, 0.1f, 1, true, perturbed), Status::kInvalidArgument);
  EXPECT_EQ(Perturb(WorldPath{}, 0, 0.1f, 25, false, perturbed), Status::kInvalidArgument);
  EXPECT_EQ(Perturb(path, 2, kNaN, 25, true, perturbed), Status::kNotFinite);
  EXPECT_EQ(Perturb(path, 2, 0.1f, INT32_MAX, true, perturbed), Status::kOk);
  path[4].y_m = kNaN;
  EXPECT_EQ(Perturb(path, 2, 0.1f, 25, true, perturbed), Status::kNotFinite);
  EXPECT_TRUE(perturbed.empty());
}

float F(double value, double alpha, double beta, double max) {
  const double size = std::abs(value);
  return static_cast<float>(size < max ? alpha * size : alpha * max + beta * (size - max));
}

TEST(CostOf, IsTheSumOfItsTerms) {
  const auto map = MapOf([](float x, float y) {
    return CostOfDiscs({{2.0f, 1.0f, 2.0f}, {-5.0f, -1.0f, 1.0f}}, x, y);
  });
  OptimizerParams params;
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const WorldPath path = Staircase(seed, 100, {-12.0f, -1.0f});
    constexpr float kStart_per_m = 0.1f;
    double map_cost = 0.0;
    double path_cost = 0.0;
    double before = kStart_per_m;
    for (int k = 0; k < path.size(); ++k) {
      const auto chord = [&](int i) {
        if (i < 0 || i + 1 >= path.size()) return std::pair{0.0, 0.0};
        return std::pair{double{path[i + 1].x_m} - path[i].x_m,
                         double{path[i + 1].y_m} - path[i].y_m};
      };
      const auto [ax, ay] = chord(k - 1);
      const auto [bx, by] = chord(k);
      const double ds = (std::hypot(ax, ay) + std::hypot(bx, by)) / 2;
      map_cost += ds * static_cast<double>(map->CostAt(path[k].x_m, path[k].y_m));
      if (k == 0 || k + 1 == path.size()) continue;
      const double curvature = std::atan2(ax * by - ay * bx, ax * bx + ay * by) / ds;
      path_cost += ds * static_cast<double>(F(curvature, params.curvature_alpha,
                                              params.curvature_beta, params.max_curvature_per_m));
      path_cost +=
          ds * static_cast<double>(F((curvature - before) / ds, params.curvature_rate_alpha,
                                     params.curvature_rate_beta, params.max_curvature_rate_per_m2));
      before = curvature;
    }
    const PathCost cost = CostOf(*map, params, path, kStart_per_m);
    EXPECT_NEAR(cost.map, map_cost, 1e-4 * (map_cost + 1.0));
    EXPECT_NEAR(cost.path, path_cost, 1e-3 * path_cost);
  }
}

TEST(CostOf, DoesNotDependOnHowFinelyTheMapIsCut) {
  const auto map = MapOf([](float x, float) { return 0.2f * std::max(0.0f, x + 20.0f); });
  const OptimizerParams params;
  const float coarse = CostOf(*map, params, Along({{-15, 0}, {15, 0}}, 0.3f), 0.0f).map;
  const float fine = CostOf(*map, params, Along({{-15, 0}, {15, 0}}, 0.15f), 0.0f).map;
  EXPECT_NEAR(coarse, fine, 0.015f * fine);
}

TEST(CostOf, TakesDegeneratePaths) {
  const auto map = EmptyMap();
  const OptimizerParams params;
  WorldPath path;
  EXPECT_EQ(CostOf(*map, params, path, 0.0f).total(), 0.0f);
  path.Resize(1);
  EXPECT_EQ(CostOf(*map, params, path, 0.0f).total(), 0.0f);
  path.Resize(10);  // all in one place
  EXPECT_EQ(CostOf(*map, params, path, 0.5f).total(), 0.0f);
}

}  // namespace
}  // namespace hardpack
