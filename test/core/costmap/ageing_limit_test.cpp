// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "core/costmap/height_grid.h"

namespace hardpack {
namespace {

constexpr float kPosts_m[] = {4.1f, 6.1f, 8.1f};

int Top_cm(const HeightGrid& grid, float x_m) {
  return grid.At(CellAt({x_m, 0.1f})).highest_hard_cm;
}

// Three posts in a row, 1 m high, and a beam that came back from behind all of them, half way up.
TEST(AgeingLimit, SoManyCellsAgeInATickAndTheOthersInTheNext) {
  const auto grid = std::make_unique<HeightGrid>();
  for (const float x_m : kPosts_m) {
    ASSERT_EQ(grid->Insert({x_m, 0.1f, 0.0f}, ReturnClass::kHard, 0), Status::kOk);
    ASSERT_EQ(grid->Insert({x_m, 0.1f, 1.0f}, ReturnClass::kHard, 0), Status::kOk);
  }
  SightFan fan;
  fan.sensor_odom = {0.1f, 0.1f, 0.5f};
  fan.direction_odom = {1.0f, 0.0f};
  fan.beams = 1;
  fan.level_m[0] = 20.0f;

  grid->BeginTick(2);
  ASSERT_EQ(grid->Age(fan, 1, 1), Status::kOk);
  EXPECT_EQ(Top_cm(*grid, kPosts_m[0]), 50);
  EXPECT_EQ(Top_cm(*grid, kPosts_m[1]), 50);
  EXPECT_EQ(Top_cm(*grid, kPosts_m[2]), 100);
  ASSERT_EQ(grid->Age(fan, 1, 1), Status::kOk);  // in the same tick
  EXPECT_EQ(Top_cm(*grid, kPosts_m[2]), 100);
  grid->BeginTick(2);
  ASSERT_EQ(grid->Age(fan, 1, 1), Status::kOk);
  EXPECT_EQ(Top_cm(*grid, kPosts_m[2]), 50);
}

}  // namespace
}  // namespace hardpack
