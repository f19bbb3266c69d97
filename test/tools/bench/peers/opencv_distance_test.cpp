// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/opencv_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "test/tools/bench/peers/random_map.h"

namespace hardpack::peers {
namespace {

TEST(OpencvDistance, IsTheCostmapsBelowItsSaturation) {
  OpencvDistance distance;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    const std::unique_ptr<Costmap> map = RandomMap(seed, 40 << seed);
    distance.Load(*map);
    distance.Transform();
    for (int index = 0; index < kMapCells; ++index) {
      const float cells = distance.hard_distance_cells()[static_cast<size_t>(index)];
      const int squared = static_cast<int>(std::lround(std::min(cells * cells, 1e6f)));
      ASSERT_EQ(std::min(squared, kMaxDistance2_cells2), int{map->hard_distance2[index]})
          << "seed " << seed << ", cell " << index;
    }
  }
}

//   . . . . 4
//   . . . . .      one soft cell, S, and no hard one:
//   . . . . .      5 cells to the one up and to the right of it
//   S . . . 4
TEST(OpencvDistance, MeasuresTheSoftLayerToo) {
  const auto map = std::make_unique<Costmap>();
  constexpr int kSoft = 100 * kMapSize_cells + 200;
  map->flags[kSoft] = Costmap::kSoft;
  OpencvDistance distance;
  distance.Load(*map);
  distance.Transform();
  EXPECT_FLOAT_EQ(distance.soft_distance_cells()[kSoft], 0.0f);
  EXPECT_FLOAT_EQ(distance.soft_distance_cells()[kSoft + 4], 4.0f);
  EXPECT_FLOAT_EQ(distance.soft_distance_cells()[kSoft + 3 * kMapSize_cells + 4], 5.0f);
  EXPECT_GT(distance.hard_distance_cells()[kSoft], 512.0f);
}

TEST(OpencvDistance, ForgetsTheMapBefore) {
  const auto map = std::make_unique<Costmap>();
  map->flags[0] = Costmap::kHard;
  OpencvDistance distance;
  distance.Load(*map);
  distance.Transform();
  map->flags[0] = 0;
  map->flags[7] = Costmap::kHard;
  distance.Load(*map);
  distance.Transform();
  EXPECT_FLOAT_EQ(distance.hard_distance_cells()[0], 7.0f);
}

}  // namespace
}  // namespace hardpack::peers
