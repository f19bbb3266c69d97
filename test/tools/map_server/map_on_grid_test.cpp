// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "core/costmap/costmap.h"
#include "tools/map_server/map_server.h"

namespace hardpack::map_server {
namespace {

OccupancyMap FreeMap(int width_px, int height_px, double resolution_m, double x_m, double y_m) {
  OccupancyMap map;
  map.width_px = width_px;
  map.height_px = height_px;
  map.resolution_m = resolution_m;
  map.origin_x_m = x_m;
  map.origin_y_m = y_m;
  map.pixels.assign(static_cast<size_t>(width_px * height_px), Occupancy::kFree);
  return map;
}

uint8_t FlagsAt(const std::vector<uint8_t>& flags, const GridWindow& window, Vec2 point) {
  return flags[static_cast<size_t>(window.Index(CellAt(point)))];
}

TEST(MapOnGrid, HoldsAMapThatFitsWhole) {
  const OccupancyMap map = FreeMap(1000, 600, 0.1, -30.0, 5.0);  // 100 x 60 m
  const GridWindow window = WindowFor(map, {-29.0f, 6.0f});
  EXPECT_TRUE(window.Contains(CellAt({-29.9f, 5.1f})));
  EXPECT_TRUE(window.Contains(CellAt({69.9f, 64.9f})));
}

TEST(MapOnGrid, CentresOnTheStartWhereTheMapIsLarger) {
  const OccupancyMap map = FreeMap(3000, 600, 0.1, 0.0, 0.0);  // 300 x 60 m
  const GridWindow window = WindowFor(map, {200.05f, 3.0f});
  EXPECT_EQ(window.origin.x, CellAt({200.05f, 0.0f}).x - kMapSize_cells / 2);
  EXPECT_TRUE(window.Contains(CellAt({200.0f, 0.1f})));
  EXPECT_TRUE(window.Contains(CellAt({200.0f, 59.9f})));
}

TEST(MapOnGrid, MakesWhatIsOffTheMapHardAndNotObserved) {
  const OccupancyMap map = FreeMap(100, 100, 0.1, 0.0, 0.0);
  const GridWindow window = WindowFor(map, {5.0f, 5.0f});
  const auto flags = CellFlags(map, window, UnknownIs::kSoft);
  EXPECT_EQ(FlagsAt(flags, window, {5.0f, 5.0f}), Costmap::kObserved);
  EXPECT_EQ(FlagsAt(flags, window, {0.05f, 0.05f}), Costmap::kObserved);
  EXPECT_EQ(FlagsAt(flags, window, {9.95f, 9.95f}), Costmap::kObserved);
  EXPECT_EQ(FlagsAt(flags, window, {-0.05f, 5.0f}), Costmap::kHard);
  EXPECT_EQ(FlagsAt(flags, window, {5.0f, 10.05f}), Costmap::kHard);
}

TEST(MapOnGrid, MakesACellThatIsOnlyPartlyOnTheMapHard) {
  const OccupancyMap map = FreeMap(101, 100, 0.1, 0.0, 0.0);  // ends in the middle of a cell
  const GridWindow window = WindowFor(map, {5.0f, 5.0f});
  const auto flags = CellFlags(map, window, UnknownIs::kSoft);
  EXPECT_EQ(FlagsAt(flags, window, {10.05f, 5.0f}), Costmap::kHard);
}

TEST(MapOnGrid, MakesUnknownWhatIsAskedFor) {
  OccupancyMap map = FreeMap(50, 50, 0.2, 0.0, 0.0);
  map.pixels[0] = Occupancy::kUnknown;
  const GridWindow window = WindowFor(map, {5.0f, 5.0f});
  const auto flags_with = [&](UnknownIs what) {
    return FlagsAt(CellFlags(map, window, what), window, {0.1f, 0.1f});
  };
  EXPECT_EQ(flags_with(UnknownIs::kFree), 0);
  EXPECT_EQ(flags_with(UnknownIs::kSoft), Costmap::kSoft);
  EXPECT_EQ(flags_with(UnknownIs::kHard), Costmap::kHard);
}

// No obstacle may be lost or moved by resampling: every point of every hard pixel lies in a hard
// cell, and every hard cell touches a hard pixel.
TEST(MapOnGrid, LosesNoObstacleAtAnyResolution) {
  constexpr uint32_t kSeed = 7;
  std::mt19937 engine(kSeed);
  for (const double resolution_m : {0.03, 0.05, 0.1, 0.2, 0.25, 0.33, 1.0, 2.5}) {
    SCOPED_TRACE(testing::Message() << "resolution " << resolution_m << ", seed " << kSeed);
    OccupancyMap map = FreeMap(40, 30, resolution_m, -0.37, 0.11);
    for (int i = 0; i < 15; ++i) map.pixels[engine() % map.pixels.size()] = Occupancy::kHard;
    const GridWindow window = WindowFor(map, {0.5f, 0.5f});
    const auto flags = CellFlags(map, window, UnknownIs::kSoft);
    std::vector<bool> explained(flags.size(), false);
    for (int row = 0; row < map.height_px; ++row) {
      for (int column = 0; column < map.width_px; ++column) {
        if (map.pixels[static_cast<size_t>(row * map.width_px + column)] != Occupancy::kHard) {
          continue;
        }
        constexpr int kSamples = 60;  // along each side, from edge to edge
        const auto along = [](int sample) { return 1.0e-4 + 0.9998 * sample / (kSamples - 1); };
        for (int s = 0; s < kSamples * kSamples; ++s) {
          const double x_m = map.origin_x_m + (column + along(s % kSamples)) * resolution_m;
          const double y_m = map.origin_y_m + (row + along(s / kSamples)) * resolution_m;
          const int index =
              window.Index(CellAt({static_cast<float>(x_m), static_cast<float>(y_m)}));
          ASSERT_NE(flags[static_cast<size_t>(index)] & Costmap::kHard, 0);
          explained[static_cast<size_t>(index)] = true;
        }
      }
    }
    for (size_t i = 0; i < flags.size(); ++i) {
      const bool hard_on_map = flags[i] == (Costmap::kHard | Costmap::kObserved);
      ASSERT_TRUE(!hard_on_map || explained[i]) << "cell " << i;
    }
  }
}

}  // namespace
}  // namespace hardpack::map_server
