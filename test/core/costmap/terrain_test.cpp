// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/terrain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "core/costmap/costmap.h"
#include "test/core/costmap/costmap_reference.h"
#include "test/core/costmap/ground_of_heights.h"

namespace hardpack {
namespace {

using Ground = hardpack::testing::GroundOfHeights;

// Up to the centimetres of the heights.
TEST(Terrain, FindsTheGradeOfAPlaneInEveryDirection) {
  for (const double slope : {0.0, 0.1, 0.3, 0.466}) {
    for (double toward_rad = 0.0; toward_rad < 6.3; toward_rad += 0.7) {
      SCOPED_TRACE(::testing::Message() << slope << ' ' << toward_rad);
      const double a = slope * std::cos(toward_rad);
      const double b = slope * std::sin(toward_rad);
      const Ground ground([&](double x_m, double y_m) { return a * x_m + b * y_m; });
      for (double at_m = -18.0; at_m < 18.0; at_m += 3.3) {
        EXPECT_NEAR(ground.At(at_m, 2.0).grade_x, a, 0.025);
        EXPECT_NEAR(ground.At(at_m, 2.0).grade_y, b, 0.025);
        EXPECT_LT(ground.At(at_m, 2.0).roughness_m, 0.007);
        EXPECT_FALSE(ground.IsHard(at_m, 2.0)) << "a plane of 25 degrees is none";
      }
    }
  }
}

// As the formulas say, cell by cell, at the borders of blocks and of the ground too.
TEST(Terrain, EqualsTheReferenceOnRoughGround) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> rough(-0.1, 0.1);
  const Ground ground([&](double x_m, double y_m) {
    const bool is_hole = random() % 5 == 0;
    return is_hole ? NAN : 0.3 * x_m - 0.05 * x_m * y_m + rough(random);
  });
  const CostmapReference reference(ground.heights(), ground.heights().window(), ground.params());
  int told = 0;
  for (int index = 0; index < kMapCells; ++index) {
    const Terrain::Ground is = ground.terrain().At(index);
    const CostmapReference::TerrainValues& should = reference.TerrainAt(index);
    if (std::fabs(should.grade_x) > 1.9 || std::fabs(should.grade_y) > 1.9) continue;
    ASSERT_NEAR(is.grade_x, should.grade_x, 0.008) << index;
    ASSERT_NEAR(is.grade_y, should.grade_y, 0.008) << index;
    ASSERT_NEAR(is.roughness_m, should.roughness_m, 0.0011) << index;
    ASSERT_EQ(is.is_too_steep, should.is_too_steep) << index;
    told += should.grade != 0.0 ? 1 : 0;
  }
  EXPECT_GT(told, 20'000);
}

TEST(Terrain, TellsHowRoughTheGroundIs) {
  for (const double sigma_m : {0.02, 0.1}) {
    std::mt19937 random(3);
    std::normal_distribution<double> rough(0.0, sigma_m);
    const Ground ground([&](double x_m, double) { return 0.2 * x_m + rough(random); });
    double sum = 0.0;
    int cells = 0;
    for (double x_m = -15.0; x_m < 15.0; x_m += 1.1) {
      for (double y_m = -15.0; y_m < 15.0; y_m += 1.1, ++cells) {
        sum += static_cast<double>(ground.At(x_m, y_m).roughness_m);
      }
    }
    // Three of the 25 degrees of freedom go into the plane.
    EXPECT_NEAR(sum / cells, sigma_m * std::sqrt(22.0 / 25.0), 0.1 * sigma_m);
  }
}

// SR-TER01
TEST(Terrain, SteeperGroundThanAllowedIsHardAndLethal) {
  for (double toward_rad = 0.0; toward_rad < 6.3; toward_rad += 0.7) {
    for (const double slope : {0.47, 0.6, 1.2, 2.7}) {
      const Ground ground([&](double x_m, double y_m) {
        return slope * (std::cos(toward_rad) * x_m + std::sin(toward_rad) * y_m);
      });
      EXPECT_EQ(ground.IsHard(1.0, 1.0), slope > 0.5) << slope << ' ' << toward_rad;
      EXPECT_EQ(ground.At(1.0, 1.0).is_too_steep, slope > 0.5);
    }
  }
}

// SR-TER01: a ledge between cells that are known, seen from above or below; a kerb of 0.15 m costs.
TEST(Terrain, ALedgeIsHardAndAKerbIsDear) {
  for (const double height_m : {0.15, 0.55, 1.0, 30.0}) {
    const Ground ground([&](double x_m, double) { return x_m < 3.0 ? 0.0 : -height_m; });
    EXPECT_EQ(ground.IsHard(2.9, 0.0), height_m > 0.3 && height_m < 18.0) << height_m;
    EXPECT_FALSE(ground.IsHard(2.1, 0.0));
    EXPECT_EQ(ground.Cost(2.9, 0.0) > 0.3, height_m < 18.0) << height_m;
  }
}

// No jump where the cost begins, and growing from there.
TEST(Terrain, TheCostBeginsAtNothingAndGrowsWithTheGrade) {
  double before = 0.0;
  for (double slope = 0.0; slope < 0.49; slope += 0.01) {
    const Ground ground([&](double x_m, double) { return slope * x_m; });
    const double cost = ground.Cost(0.5, 0.5);
    if (std::fabs(slope - 0.155) > 0.02) {
      EXPECT_EQ(cost > 0.0, slope > 0.155) << slope;
    }
    EXPECT_GE(cost, before - 0.07) << slope;
    EXPECT_LT(cost, before + 0.4) << slope;
    before = cost;
  }
  EXPECT_NEAR(before, 5.0 * (0.48 - 0.15), 0.3);
}

TEST(Terrain, RoughGroundCosts) {
  std::mt19937 random(3);
  std::normal_distribution<double> rough(0.0, 0.1);
  CostmapParams params;
  params.grade_cost = 0.0f;
  params.max_grade = 1.9f;
  const Ground ground([&](double, double) { return rough(random); }, params);
  const double roughness_m = static_cast<double>(ground.At(1.0, 1.0).roughness_m);
  EXPECT_NEAR(ground.Cost(1.0, 1.0), 20.0 * (roughness_m - 0.04), 0.07);
}

// One ring of returns, or two rows of cells, tell nothing across.
TEST(Terrain, TellsNothingWhereTheKnownCellsLieOnALine) {
  for (const double width_m : {0.2, 0.4, 0.6}) {
    const Ground ground(
        [&](double x_m, double) { return x_m > 1.0 && x_m < 1.0 + width_m ? 10.0 * x_m : NAN; });
    EXPECT_EQ(ground.At(1.3, 0.0).is_too_steep, width_m > 0.5) << width_m;
  }
}

// Neither where it is not known itself, nor in the paper's rule, nor when it is turned off.
TEST(Terrain, IsNoneWithoutHeightsOrInThePapersRule) {
  const auto steep = [](double x_m, double y_m) { return std::fabs(y_m) < 0.1 ? NAN : x_m; };
  EXPECT_FALSE(Ground(steep).IsHard(1.0, 0.0));
  EXPECT_TRUE(Ground(steep).IsHard(1.0, 0.3));
  CostmapParams off;
  off.max_grade = 0.0f;
  EXPECT_FALSE(Ground(steep, off).IsHard(1.0, 0.3));
  CostmapParams paper;
  paper.obstacle_rule = ObstacleRule::kInCell;
  EXPECT_FALSE(Ground(steep, paper).IsHard(1.0, 0.3));
}

// A map of cells has none, whatever was built before.
TEST(Terrain, OfAnEarlierBuildIsNotAddedToAMapOfCells) {
  const Ground ground([](double x_m, double) { return 0.4 * x_m; });
  auto builder = std::make_unique<CostmapBuilder>();
  ASSERT_EQ(builder->Begin(ground.heights(), {}), Status::kOk);
  ASSERT_EQ(builder->Step(ground.heights(), CostmapBuilder::kUnits), Progress::kDone);
  ASSERT_EQ(builder->BeginCells(ground.heights().window(), {}), Status::kOk);
  ASSERT_EQ(builder->StepCells(CostmapBuilder::kUnits), Progress::kDone);
  for (int index = 0; index < kMapCells; ++index) ASSERT_EQ(builder->result().cost_q8[index], 0);
}

}  // namespace
}  // namespace hardpack
