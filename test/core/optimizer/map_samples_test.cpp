// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/map_samples.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace hardpack {
namespace {

std::unique_ptr<Costmap> RandomMap(Vec2 center_odom) {
  std::mt19937 random(5);
  auto map = std::make_unique<Costmap>();
  map->window = GridWindow::CenteredAt(center_odom);
  for (uint16_t& cost_q8 : map->cost_q8) cost_q8 = static_cast<uint16_t>(random() % 9985);
  return map;
}

void ExpectAsCostAt(const Costmap& map, const std::vector<Vec2>& places) {
  for (size_t first = 0; first < places.size(); first += kMaxSamples) {
    float x_m[kMaxSamples];
    float y_m[kMaxSamples];
    float costs[kMaxSamples];
    const size_t count = std::min<size_t>(kMaxSamples, places.size() - first);
    for (size_t i = 0; i < count; ++i) {
      x_m[i] = places[first + i].x_m;
      y_m[i] = places[first + i].y_m;
    }
    SampleCosts(map, x_m, y_m, static_cast<int>(count), costs);
    for (size_t i = 0; i < count; ++i) {
      EXPECT_EQ(costs[i], map.CostAt(x_m[i], y_m[i])) << x_m[i] << ' ' << y_m[i];
    }
  }
}

TEST(MapSamples, AreWhatCostAtGivesBitForBit) {
  for (const Vec2 center : {Vec2{0.0f, 0.0f}, Vec2{-1234.5f, 777.7f}, Vec2{40000.0f, -3.0f}}) {
    const auto map = RandomMap(center);
    std::mt19937 random(6);
    std::uniform_real_distribution<float> offset_m(-60.0f, 60.0f);  // off the window too
    std::vector<Vec2> places;
    for (int i = 0; i < 5003; ++i) {
      places.push_back({center.x_m + offset_m(random), center.y_m + offset_m(random)});
    }
    ExpectAsCostAt(*map, places);
  }
}

TEST(MapSamples, AreExactAtCentersAndBordersOfCells) {
  const auto map = RandomMap({0.0f, 0.0f});
  std::vector<Vec2> places;
  for (int x = -258; x <= 258; ++x) {
    for (const int y : {-257, -256, -255, -1, 0, 1, 7, 254, 255, 256}) {
      for (const float half : {0.0f, 0.5f}) {
        const float x_m = (static_cast<float>(x) + half) / kCellsPerMeter;
        const float y_m = (static_cast<float>(y) + half) / kCellsPerMeter;
        places.push_back({x_m, y_m});
        places.push_back({y_m, x_m});
      }
    }
  }
  ExpectAsCostAt(*map, places);
}

// In blocks: what lies behind the last place is another's, whether a block ends there or not.
TEST(MapSamples, WriteNothingBehindTheLast) {
  const auto map = RandomMap({0.0f, 0.0f});
  const float places_m[kMaxSamples] = {};
  for (int points = 0; points < kMaxSamples; ++points) {
    float costs[kMaxSamples];
    for (float& cost : costs) cost = -1.0f;
    SampleCosts(*map, places_m, places_m, points, costs);
    for (int i = 0; i < kMaxSamples; ++i) ASSERT_EQ(costs[i] < 0.0f, i >= points) << points;
  }
}

TEST(MapSamples, TakeAnyNumber) {
  const auto map = RandomMap({0.0f, 0.0f});
  constexpr float kLargest = std::numeric_limits<float>::max();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec2> places;
  for (const float x : {-kInfinity, -kLargest, -1e9f, -1e-40f, 0.0f, 1e-40f, 1e9f, kLargest}) {
    for (const float y : {-kLargest, 0.3f, kInfinity}) places.push_back({x, y});
  }
  ExpectAsCostAt(*map, places);
  for (const float nan : {kNaN, -kNaN}) {
    const float places_m[2] = {nan, 1.0f};
    float costs[2];
    SampleCosts(*map, places_m, places_m, 2, costs);
    EXPECT_GE(costs[0], 0.0f);
    EXPECT_LE(costs[0], 39.0f);
    EXPECT_EQ(costs[1], map->CostAt(1.0f, 1.0f));
  }
}

}  // namespace
}  // namespace hardpack
