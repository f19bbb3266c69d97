// SPDX-License-Identifier: Apache-2.0
// The builder against the plain reference, cell by cell, on random maps. A map holds some eighty
// random patches of returns, so that these are thousands.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "core/costmap/costmap.h"
#include "test/core/base/rounds.h"
#include "test/core/costmap/costmap_reference.h"
#include "test/core/costmap/scene.h"

namespace hardpack {
namespace {

class Dice {
 public:
  explicit Dice(uint32_t seed) : random_(seed) {}

  int Below(int n) { return static_cast<int>(random_() % static_cast<uint32_t>(n)); }
  int Between(int low, int high) { return low + Below(high - low + 1); }
  bool OneIn(int n) { return Below(n) == 0; }
  // A multiple of `step` up to `high`.
  float UpTo(float high, float step) {
    return step * static_cast<float>(Below(static_cast<int>(high / step + 0.5f) + 1));
  }

 private:
  std::mt19937 random_;
};

CostmapParams RandomParams(Dice& dice) {
  for (;;) {
    CostmapParams params;
    params.obstacle_rule = dice.OneIn(3) ? ObstacleRule::kInCell : ObstacleRule::kLocalGround;
    params.growth_height_m = dice.UpTo(1.0f, 0.01f);
    params.obstacle_height_m = std::min(params.growth_height_m, 0.2f);
    params.clearance_height_m = dice.UpTo(3.0f, 0.01f);
    params.ground_window_cells = 1 + 2 * dice.Below(16);
    params.planning_radius_m = dice.UpTo(dice.OneIn(4) ? 3.0f : 1.4f, 0.01f);
    params.halo_m = dice.UpTo(3.0f, 0.01f);
    params.hard_edge_cost = dice.UpTo(12.0f, 0.01f);
    params.hard_slope_per_m = dice.UpTo(20.0f, 0.01f);
    params.soft_edge_cost = dice.UpTo(6.0f, 0.01f);
    params.soft_slope_per_m = dice.UpTo(10.0f, 0.01f);
    params.unknown_cost = dice.UpTo(5.0f, 0.01f);
    params.max_grade = dice.OneIn(4) ? 0.0f : dice.UpTo(1.9f, 0.01f);
    params.free_grade = dice.UpTo(0.5f, 0.01f);
    params.grade_cost = dice.UpTo(30.0f, 0.01f);
    params.free_roughness_m = dice.UpTo(0.1f, 0.01f);
    params.roughness_cost_per_m = dice.UpTo(60.0f, 0.01f);
    if (CheckCostmapParams(params) == Status::kOk) return params;
  }
}

// A map's returns.
class RandomMap {
 public:
  RandomMap(Dice& dice, HeightGrid& heights) : dice_(dice), heights_(heights) {
    const float far_m = dice.OneIn(2) ? 0.0f : 4000.0f;
    const Vec2 center = {dice.UpTo(2.0f * far_m, 0.3f) - far_m, dice.UpTo(60.0f, 0.3f)};
    EXPECT_EQ(heights.Reset(center), Status::kOk);
    const int patches = dice.Between(60, 100);
    for (int i = 0; i < patches; ++i) {
      if (dice.OneIn(30)) {  // what has been filed rolls, and some of it out
        const Vec2 moved = {center.x_m + dice.UpTo(40.0f, 0.1f),
                            center.y_m - dice.UpTo(9.0f, 0.1f)};
        EXPECT_EQ(heights.Recenter(moved), Status::kOk);
      }
      AddPatch();
    }
  }

  // A cell of the map, as a rule in or near a patch.
  int SomeIndex() {
    const Cell patch =
        corners_[static_cast<size_t>(dice_.Below(static_cast<int>(corners_.size())))];
    const Cell cell = {patch.x + dice_.Between(-30, 60), patch.y + dice_.Between(-30, 60)};
    const bool anywhere = dice_.OneIn(8) || !heights_.window().Contains(cell);
    return anywhere ? dice_.Below(kMapCells) : heights_.window().Index(cell);
  }

 private:
  // Returns above a plane, with holes in the ground; at the border of the map, one side is cut off.
  void AddPatch() {
    const int side = dice_.Between(1, 25);
    const Cell origin = heights_.window().origin;
    const Cell corner = {origin.x + dice_.Between(-side, kMapSize_cells),
                         origin.y + dice_.Between(-side, kMapSize_cells)};
    corners_.push_back(corner);
    const int base_cm = dice_.OneIn(6) ? dice_.Between(-19000, 19000) : dice_.Between(-300, 300);
    const int slope_x_cm = dice_.Between(-15, 15);  // per cell: up to 37 degrees
    const int slope_y_cm = dice_.Between(-15, 15);
    const int ground_in = dice_.Between(1, 40);  // one cell in so many has ground
    const int other_in = 1 << dice_.Below(8);
    const int highest_cm = dice_.OneIn(3) ? 60 : 400;
    for (int i = 0; i < side * side; ++i) {
      const Cell cell = {corner.x + i % side, corner.y + i / side};
      if (!heights_.window().Contains(cell)) continue;
      const int ground_cm = base_cm + slope_x_cm * (i % side) + slope_y_cm * (i / side);
      if (dice_.OneIn(ground_in)) Add(cell, ground_cm + dice_.Below(10), ReturnClass::kGround);
      if (!dice_.OneIn(other_in)) continue;
      const int returns = dice_.Between(1, 3);
      for (int k = 0; k < returns; ++k) {
        const auto kind = static_cast<ReturnClass>(dice_.Below(5));
        Add(cell, ground_cm + dice_.Between(-40, highest_cm), kind);
      }
    }
  }

  void Add(Cell cell, int height_cm, ReturnClass return_class) {
    const Vec2 center = CellCenter(cell);
    const Vec3 point = {center.x_m, center.y_m, 0.01f * static_cast<float>(height_cm)};
    EXPECT_EQ(heights_.Insert(point, return_class), Status::kOk);
    if (dice_.OneIn(2)) heights_.CountLow(point, dice_.OneIn(3));
  }

  Dice& dice_;
  HeightGrid& heights_;
  std::vector<Cell> corners_;
};

// Builds in one of three ways: at once, or in parts of random size, or in these with marks between
// the halves, which the reference gets too.
void Build(Dice& dice, RandomMap& random, Scene& scene, const CostmapParams& params,
           CostmapReference& reference) {
  CostmapBuilder& builder = scene.builder();
  ASSERT_EQ(builder.Begin(scene.heights(), params), Status::kOk);
  const int way = dice.Below(3);
  if (way == 0) {
    ASSERT_EQ(builder.Step(scene.heights(), CostmapBuilder::kUnits), Progress::kDone);
    return;
  }
  if (way == 1) {
    while (builder.Step(scene.heights(), dice.Between(1, 600)) == Progress::kBusy) continue;
    return;
  }
  while (builder.StepHeights(scene.heights(), dice.Between(1, 600)) == Progress::kBusy) continue;
  const int marks = dice.Below(200);
  for (int i = 0; i < marks; ++i) {
    const int index = random.SomeIndex();
    const uint8_t flags = static_cast<uint8_t>(dice.Below(256));
    builder.Mark(index, flags);
    reference.Mark(index, flags);
  }
  while (builder.StepCells(dice.Between(1, 600)) == Progress::kBusy) continue;
}

CostmapReference::CellValues ValuesOf(const Costmap& map, int index) {
  return {map.flags[index], map.hard_distance2[index], map.hard_depth2[index], map.cost_q8[index]};
}

void ExpectSame(const Costmap& map, int index, const CostmapReference::CellValues& expected) {
  const CostmapReference::CellValues is = ValuesOf(map, index);
  ASSERT_EQ(is, expected) << "column " << index % kMapSize_cells << ", row "
                          << index / kMapSize_cells << ": flags " << is.flags << ", not "
                          << expected.flags << "; distance2 " << is.hard_distance2 << ", not "
                          << expected.hard_distance2 << "; depth2 " << is.hard_depth2 << ", not "
                          << expected.hard_depth2 << "; cost_q8 " << is.cost_q8 << ", not "
                          << expected.cost_q8;
}

enum class Extent { kSomeCells, kEveryCell };

void CompareOneMap(uint32_t seed, Extent extent, Scene& scene) {
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  Dice dice(seed);
  const CostmapParams params = RandomParams(dice);
  RandomMap random(dice, scene.heights());
  CostmapReference reference(scene.heights(), scene.heights().window(), params);
  ASSERT_NO_FATAL_FAILURE(Build(dice, random, scene, params, reference));
  reference.Dilate();
  const Costmap& map = scene.builder().result();
  if (extent == Extent::kEveryCell) {
    const std::vector<CostmapReference::CellValues> expected = reference.All();
    for (int index = 0; index < kMapCells; ++index) {
      ASSERT_NO_FATAL_FAILURE(ExpectSame(map, index, expected[static_cast<size_t>(index)]));
    }
    return;
  }
  for (int index = 0; index < kMapCells; ++index) {
    if (map.flags[index] == reference.FlagsAt(index)) continue;
    ASSERT_NO_FATAL_FAILURE(ExpectSame(map, index, reference.At(index)));
  }
  for (int i = 0; i < 600; ++i) {
    const int index = random.SomeIndex();
    ASSERT_NO_FATAL_FAILURE(ExpectSame(map, index, reference.At(index)));
  }
}

// The flags of all cells, and everything of some, found in the plainest way.
TEST(CostmapBuilder, EqualsThePlainReferenceOnThousandsOfRandomPatches) {
  Scene scene;
  for (uint32_t seed = 1; seed <= Rounds(40u, 10u); ++seed) {
    CompareOneMap(seed, Extent::kSomeCells, scene);
    if (HasFailure()) return;
  }
}

TEST(CostmapBuilder, EqualsTheReferenceInEveryCell) {
  Scene scene;
  for (uint32_t seed = 1001; seed <= 1000 + Rounds(3u, 1u); ++seed) {
    CompareOneMap(seed, Extent::kEveryCell, scene);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace hardpack
