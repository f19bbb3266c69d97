// SPDX-License-Identifier: Apache-2.0
// Standing things, from the lidar's beams to the cells of the map: what is hard, what is soft, what
// is free and what is unknown.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "test/core/autonomy/perception_scene.h"

namespace hardpack::perception {
namespace {

constexpr uint8_t kObstacle = Costmap::kHard | Costmap::kSoft;
constexpr uint8_t kObserved = Costmap::kObserved;

std::vector<Cell> CellsWith(const Chain& chain, const Area& area, uint8_t flags) {
  std::vector<Cell> cells;
  area.ForEach([&](Cell cell) {
    if (chain.Has(cell, flags)) cells.push_back(cell);
  });
  return cells;
}

int CountWith(const Chain& chain, const std::vector<Cell>& cells, uint8_t flags) {
  return static_cast<int>(
      std::count_if(cells.begin(), cells.end(), [&](Cell cell) { return chain.Has(cell, flags); }));
}

// The vehicle drives up to a box of 0.6 m, stops and waits. From there the lowest beam passes
// above the box:
//
//   sensor ------ - - _ _          lowest beam at the box: 0.72 m
//     |                   - - _
//   [====]                 [] 0.6 m
//   0 -> 13 m           15.05
class BoxAhead {
 public:
  static constexpr double kStop_s = 8.7;  // 13 m at 1.5 m/s
  static constexpr double kBox_x = 15.05;
  static constexpr Area kAround = {14.8, -0.4, 15.8, 0.6};
  static constexpr Area kFront = {15.0, -0.2, 15.2, 0.4};
  // The lowest beam comes down to the box's height 2.4 m ahead; the rest of the box can be seen.
  static constexpr Area kUnseen = {14.8, -0.4, 15.4, 0.6};

  explicit BoxAhead(bool with_labels) : chain(with_labels, Sector{20.0}) {
    chain.world.bodies = {Box({kBox_x, -0.15, 0.0}, {kBox_x + 0.6, 0.45, 0.6})};
    chain.truth = [this](double t) {
      Pose pose;
      pose.x = t < back_off_s ? std::min(1.5 * t, 13.0) : std::max(13.0 - (t - back_off_s), 5.0);
      return pose;
    };
  }

  double back_off_s = kNothing;
  Chain chain;
};

// SR-PER04
TEST(PerceptionScenes, BoxTwoMetersAheadIsKnownAfterHalfAMinute) {
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto scene = std::make_unique<BoxAhead>(with_labels);
    Chain& chain = scene->chain;
    chain.RunUntil(BoxAhead::kStop_s + 0.5);
    chain.Build();
    const std::vector<Cell> known = CellsWith(chain, BoxAhead::kAround, Costmap::kHard);
    EXPECT_EQ(chain.Count(BoxAhead::kFront, Costmap::kHard), Chain::Cells(BoxAhead::kFront))
        << chain.Picture(BoxAhead::kAround);
    chain.RunUntil(BoxAhead::kStop_s + 30.5);
    chain.Build();
    EXPECT_EQ(CountWith(chain, known, Costmap::kHard), static_cast<int>(known.size()))
        << chain.Picture(BoxAhead::kAround);
  }
}

// SR-PER04
TEST(PerceptionScenes, BoxTakenAwayStaysUntilTheLidarSeesThroughIt) {
  const auto scene = std::make_unique<BoxAhead>(false);
  Chain& chain = scene->chain;
  const double taken_s = BoxAhead::kStop_s + 1.0;
  chain.world.bodies[0].until_s = taken_s;
  scene->back_off_s = taken_s + 3.0;
  chain.RunUntil(taken_s);
  chain.Build();
  const std::vector<Cell> known = CellsWith(chain, BoxAhead::kUnseen, Costmap::kHard);
  EXPECT_GE(known.size(), 3u);
  chain.RunUntil(scene->back_off_s);
  chain.Build();
  EXPECT_EQ(CountWith(chain, known, Costmap::kHard), static_cast<int>(known.size()))
      << chain.Picture(BoxAhead::kAround);
  chain.RunUntil(scene->back_off_s + 9.0);
  chain.Build();
  EXPECT_EQ(chain.Count(BoxAhead::kAround, kObstacle), 0) << chain.Picture(BoxAhead::kAround);
}

// A ditch across the way, 1.5 m wide and 1 m deep: behind its near edge nothing is seen but the
// upper part of its far wall.
//
//   sensor - - _ _
//     |            - - _ _
//   [====]                 - .
//   ----------------------+   |------
//                     6.5 |   | 8.0
//                         +---+
// SR-PER09
TEST(PerceptionScenes, DitchIsUnknownGround) {
  World world;
  world.ground = Ground(
      {{-1000.0, 0.0}, {6.5, 0.0}, {6.5, -1.0}, {8.0, -1.0}, {8.0, 0.0}, {1000.0, 0.0}}, 0.0);
  constexpr Area kBefore = {4.6, -2.0, 6.2, 2.0};
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(world, with_labels, 1.5);
    const std::string picture = chain->Picture({4.0, -2.0, 12.0, 2.0});
    EXPECT_EQ(chain->Count(kBefore, kObserved), Chain::Cells(kBefore)) << picture;
    // Every row of cells across it has at least 0.8 m without ground, always the same ones.
    const Area middle = {6.7, -2.0, 7.7, 2.0};
    std::vector<int> unknown(64, 0);
    int rows = 0;
    Area{0.0, -2.0, 0.2, 2.0}.ForEach([&](Cell) { ++rows; });
    middle.ForEach([&](Cell cell) {
      if (!chain->Has(cell, kObserved)) ++unknown[static_cast<size_t>(cell.x)];
    });
    EXPECT_GE(std::count(unknown.begin(), unknown.end(), rows), 4) << picture;
  }
}

// Beams meet flat ground in rings, further apart with distance; between them it counts as seen.
TEST(PerceptionScenes, FlatGroundIsObservedBetweenTheRings) {
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(World{}, with_labels, 0.7, Sector{});
    int observed = 0;
    int cells = 0;
    Area{-15.0, -15.0, 15.0, 15.0}.ForEach([&](Cell cell) {
      const Vec2 middle = CellCenter(cell);
      const double distance = std::hypot(middle.x_m, middle.y_m);
      if (distance < 5.0 || distance > 15.0) return;
      ++cells;
      observed += chain->Has(cell, kObserved) ? 1 : 0;
    });
    EXPECT_GE(observed, 0.95 * cells);
    EXPECT_EQ(chain->Count({-40.0, -40.0, 40.0, 40.0}, kObstacle), 0);
  }
}

// Grass: beams end somewhere in it.
//
//   [====]  wWwwWWwwWw  0.4 m
// SR-PER07
TEST(PerceptionScenes, GrassIsFree) {
  World world;
  Body grass = Box({5.0, -3.0, 0.0}, {12.0, 3.0, 0.4}, kGrassCode);
  grass.free_path_m = 0.6;
  world.bodies = {grass};
  constexpr Area kGrass = {5.0, -3.0, 12.0, 3.0};
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(world, with_labels, 1.5);
    EXPECT_EQ(chain->Count(kGrass, kObstacle), 0) << chain->Picture(kGrass);
    // What no beam came back from in three directions side by side is not bridged over.
    EXPECT_GE(chain->Count(kGrass, kObserved), 0.75 * Chain::Cells(kGrass))
        << chain->Picture(kGrass);
  }
}

constexpr Area kBushCore = {6.6, -0.4, 7.4, 0.4};  // of the bushes below

// A bush, 1.2 m high, through which beams get by and by:
//
//           .oOo.
//   [====]  oOOOo  1.2 m
//            oOo
World WithBush() {
  World world;
  world.bodies = {Bush(7.0, 0.0, 1.2, 0.5)};
  return world;
}
constexpr Area kAroundBush = {6.0, -1.0, 8.0, 1.0};

TEST(PerceptionScenes, BushIsSoft) {
  const auto chain = Standing(WithBush(), true, 1.5);
  // Until all labels have come.
  chain->lidar_on = false;
  chain->RunUntil(1.7);
  chain->Build();
  EXPECT_EQ(chain->Count(kBushCore, Costmap::kSoft), Chain::Cells(kBushCore))
      << chain->Picture(kAroundBush);
}

TEST(PerceptionScenes, BushByGeometryIsSoftInMostOfItsCells) {
  // With labels what is pending has its geometric class.
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(WithBush(), with_labels, 1.5);
    const int cells = Chain::Cells(kBushCore);
    EXPECT_EQ(chain->Count(kBushCore, kObstacle), cells) << chain->Picture(kAroundBush);
    EXPECT_GT(2 * chain->Count(kBushCore, Costmap::kSoft), cells) << chain->Picture(kAroundBush);
  }
}

//          .oO|Oo.
//   [====] oOO|OOo
//           oO|Oo
// SR-PER02
TEST(PerceptionScenes, TrunkInsideABushIsHard) {
  World world;
  world.bodies = {Bush(7.1, 0.1, 1.2, 0.6), Cylinder(7.1, 0.1, 0.09, 1.2, kTreeCode)};
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(world, with_labels, 2.0);
    EXPECT_TRUE(chain->Has(CellAt({7.1f, 0.1f}), Costmap::kHard))
        << chain->Picture({6.0, -1.0, 8.0, 1.0});
  }
}

// A branch across the way.
//
//            ______
//   [====]             free beneath, or not
//   -----------------
World WithBranch(double from_z) {
  World world;
  world.bodies = {Box({8.02, -1.0, from_z}, {8.18, 1.0, from_z + 0.16}, kTreeCode)};
  return world;
}
constexpr Area kBranch = {8.0, -0.8, 8.2, 0.8};
constexpr Area kAroundBranch = {7.6, -1.6, 8.6, 1.6};

// SR-PER03
TEST(PerceptionScenes, BranchAtTwoAndAHalfMetersIsFree) {
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(WithBranch(2.5), with_labels, 1.5);
    EXPECT_GT(chain->mapper().counters().overhead_returns, 0u);
    EXPECT_EQ(chain->Count(kAroundBranch, kObstacle), 0) << chain->Picture(kAroundBranch);
    EXPECT_EQ(chain->Count(kBranch, kObserved), Chain::Cells(kBranch));
  }
}

// SR-PER03
TEST(PerceptionScenes, BranchAtOneMeterSeventyIsHard) {
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    const auto chain = Standing(WithBranch(1.7), with_labels, 1.5);
    EXPECT_EQ(chain->Count(kBranch, Costmap::kHard), Chain::Cells(kBranch))
        << chain->Picture(kAroundBranch);
  }
}

// On its wheels at (x, y), driving along x.
Pose OnGround(const Ground& ground, double x) {
  constexpr double kHalfBase_m = 0.5;
  const double front = ground.HeightAt(x + kHalfBase_m, 0.0);
  const double rear = ground.HeightAt(x - kHalfBase_m, 0.0);
  Pose pose;
  pose.x = x;
  pose.z = 0.5 * (front + rear);
  pose.pitch = -std::atan2(front - rear, 2.0 * kHalfBase_m);
  return pose;
}

const double kSteep = std::tan(25.0 * kDegree_rad);

//                ____          drives up it, over its top and down the other side
//   [====]    .-'    '-.
//   ------- -'  25 deg  '- ---
// SR-PER07
TEST(PerceptionScenes, SlopeUpAndDownIsFree) {
  World world;
  world.ground = Ground({{-1000.0, 0.0},
                         {6.0, 0.0},
                         {12.0, 6.0 * kSteep},
                         {15.0, 6.0 * kSteep},
                         {21.0, 0.0},
                         {1000.0, 0.0}},
                        0.0);
  constexpr Area kWay = {-2.0, -3.0, 30.0, 3.0};
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    Chain chain(with_labels, Sector{25.0});
    chain.world = world;
    chain.truth = [&](double t) { return OnGround(world.ground, 2.0 * t); };
    for (int i = 1; i <= 12; ++i) {
      chain.RunUntil(i);
      chain.Build();
      EXPECT_EQ(chain.Count(kWay, kObstacle), 0) << "after " << i << " s" << chain.Picture(kWay);
    }
    // The slope that it drives up is known as ground before it gets there.
    EXPECT_GE(chain.Count({6.0, -0.5, 12.0, 0.5}, kObserved), 0.9 * 30 * 5);
  }
}

// Along the slope, which falls away to the right:  \[==]
//                                                   \---
// SR-PER07
TEST(PerceptionScenes, SlopeAcrossTheWayIsFree) {
  World world;
  world.ground = Ground({{-1000.0, -1000.0 * kSteep}, {1000.0, 1000.0 * kSteep}}, 0.5 * kPi_rad);
  constexpr Area kWay = {2.0, -6.0, 20.0, 6.0};
  for (const bool with_labels : {false, true}) {
    SCOPED_TRACE(with_labels ? "with labels" : "by geometry");
    Chain chain(with_labels, Sector{60.0});
    chain.world = world;
    chain.truth = [](double t) {
      Pose pose;
      pose.x = 2.0 * t;
      pose.roll = 25.0 * kDegree_rad;
      return pose;
    };
    chain.RunUntil(2.0);
    chain.Build();
    EXPECT_EQ(chain.Count(kWay, kObstacle), 0) << chain.Picture(kWay);
    EXPECT_GE(chain.Count({5.0, -2.0, 14.0, 2.0}, kObserved), 0.9 * 45 * 20) << chain.Picture(kWay);
  }
}

//                 ________
//   [====]       |  0.6 m
//   -------------+
// SR-PER01
TEST(PerceptionScenes, KerbIsHard) {
  World world;
  world.ground = Ground({{-1000.0, 0.0}, {8.1, 0.0}, {8.1, 0.6}, {1000.0, 0.6}}, 0.0);
  const auto chain = Standing(world, false, 1.5);
  constexpr Area kKerb = {8.0, -2.0, 8.2, 2.0};
  EXPECT_EQ(chain->Count(kKerb, Costmap::kHard), Chain::Cells(kKerb))
      << chain->Picture({6.0, -2.0, 11.0, 2.0});
}

}  // namespace
}  // namespace hardpack::perception
