// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>

#include "core/costmap/height_grid.h"
#include "test/core/costmap/ageing_scene.h"

// What ageing is for, with a lidar that turns in a small world.

namespace hardpack {
namespace {

constexpr int kAgeing = 3;
constexpr Upright kWall = {12.0f, 12.4f, -30.0f, 30.0f, 0.0f, 3.0f};

using HeightsByCell = std::map<std::pair<int32_t, int32_t>, HeightGrid::CellHeights>;

// Cells with a hard obstacle that reaches higher than a kerb over the ground at 0.
HeightsByCell HardCells(const HeightGrid& grid, float min_x_m, float max_x_m, float reach_y_m) {
  HeightsByCell cells;
  const Cell first = CellAt({min_x_m, -reach_y_m});
  const Cell last = CellAt({max_x_m, reach_y_m});
  for (int32_t y = first.y; y <= last.y; ++y) {
    for (int32_t x = first.x; x <= last.x; ++x) {
      const HeightGrid::CellHeights heights = grid.At({x, y});
      if (heights.highest_hard_cm == HeightGrid::kNone || heights.highest_hard_cm < 20) continue;
      cells[{x, y}] = heights;
    }
  }
  return cells;
}

//  sensor 1.3 m o---___                                       | wall
//                      ---___  lowest beam: 0.7 m over 2 m    |
//                +--+        ---___                           |
//  ==============|  |==================================================
//                0.6 m box
// SR-PER04
TEST(AgeingScene, ABoxInTheBlindConeStaysForever) {
  const auto grid = std::make_unique<HeightGrid>();
  LidarScene scene;
  scene.boxes = {kWall, {2.0f, 2.4f, -0.3f, 0.3f, 0.0f, 0.6f}};
  uint32_t revolution = 0;
  for (float x_m = -6.0f; x_m < 0.05f; x_m += 0.2f) {
    scene.sensor.x_m = x_m;
    scene.Revolve(*grid, 60, ++revolution, kAgeing);
  }
  const auto before = HardCells(*grid, 1.5f, 3.0f, 1.0f);
  ASSERT_GE(before.size(), 3u);
  int16_t top_cm = 0;
  for (const auto& [cell, heights] : before) top_cm = std::max(top_cm, heights.highest_hard_cm);
  ASSERT_GT(top_cm, 50);
  for (int i = 0; i < 300; ++i) scene.Revolve(*grid, 60, ++revolution, 1);
  const auto after = HardCells(*grid, 1.5f, 3.0f, 1.0f);
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [cell, heights] : before) {
    ASSERT_TRUE(after.contains(cell));
    EXPECT_EQ(after.at(cell).highest_hard_cm, heights.highest_hard_cm);
    EXPECT_EQ(after.at(cell).lowest_hard_cm, heights.lowest_hard_cm);
  }
}

//                 P' after
//
//   o - - - - - - P before - - - - - - | wall
TEST(AgeingScene, APersonWhoWalkedOnVanishes) {
  for (int ageing = 1; ageing <= HeightGrid::kMaxAgeingRevolutions; ++ageing) {
    SCOPED_TRACE(::testing::Message() << ageing << " revolutions");
    const auto grid = std::make_unique<HeightGrid>();
    LidarScene scene;
    Upright person = {5.0f, 5.4f, -0.2f, 0.2f, 0.0f, 1.75f, ReturnClass::kPerson};
    scene.boxes = {kWall, person};
    uint32_t revolution = 6;
    for (int i = 0; i < 5; ++i) scene.Revolve(*grid, 40, ++revolution, ageing);
    const auto before = HardCells(*grid, 4.5f, 6.0f, 1.0f);
    ASSERT_GE(before.size(), 2u);
    for (const auto& [cell, heights] : before) EXPECT_TRUE(heights.person);

    scene.boxes = {kWall};  // out of the part of the revolution that is turned here
    for (int i = 1; i < ageing; ++i) scene.Revolve(*grid, 40, ++revolution, ageing);
    EXPECT_EQ(HardCells(*grid, 4.5f, 6.0f, 1.0f).size(), before.size());
    scene.Revolve(*grid, 40, ++revolution, ageing);
    EXPECT_TRUE(HardCells(*grid, 4.5f, 6.0f, 1.0f).empty());
    for (const auto& [cell, heights] : before) {
      EXPECT_FALSE(grid->At({cell.first, cell.second}).person);
    }
  }
}

//   o - - - | lorry that stopped in between      box
// SR-PER04
TEST(AgeingScene, AnOccludedObstacleStays) {
  const auto grid = std::make_unique<HeightGrid>();
  LidarScene scene;
  const Upright box = {8.0f, 8.4f, -0.5f, 0.5f, 0.0f, 1.2f};
  scene.boxes = {kWall, box};
  uint32_t revolution = 0;
  for (int i = 0; i < 3; ++i) scene.Revolve(*grid, 40, ++revolution, kAgeing);
  const auto before = HardCells(*grid, 7.5f, 9.0f, 1.0f);
  ASSERT_GE(before.size(), 4u);
  scene.boxes = {kWall, {4.0f, 5.0f, -3.0f, 3.0f, 0.0f, 3.5f}};  // and the box is taken away
  for (int i = 0; i < 300; ++i) scene.Revolve(*grid, 40, ++revolution, 1);
  EXPECT_EQ(HardCells(*grid, 7.5f, 9.0f, 1.0f).size(), before.size());
}

// With nothing behind it, no beam comes back that could tell of it.
// SR-PER04
TEST(AgeingScene, AnObstacleThatNoBeamComesBackFromBehindStays) {
  const auto grid = std::make_unique<HeightGrid>();
  LidarScene scene;
  scene.boxes = {{20.0f, 20.4f, -0.5f, 0.5f, 0.0f, 1.6f}};
  uint32_t revolution = 0;
  for (int i = 0; i < 3; ++i) scene.Revolve(*grid, 20, ++revolution, kAgeing);
  const auto before = HardCells(*grid, 19.5f, 21.0f, 1.0f);
  ASSERT_GE(before.size(), 3u);
  scene.boxes.clear();
  scene.max_range_m = 18.0f;
  for (int i = 0; i < 300; ++i) scene.Revolve(*grid, 20, ++revolution, 1);
  EXPECT_EQ(HardCells(*grid, 19.5f, 21.0f, 1.0f).size(), before.size());
}

//  before, from further away            now: the highest beam passes under it
//                      =====  branch                 =====
//  o--------------------             o---________----------
// SR-PER04
TEST(AgeingScene, ABranchAboveTheHighestBeamStays) {
  const auto grid = std::make_unique<HeightGrid>();
  LidarScene scene;
  scene.boxes = {kWall, {3.0f, 3.2f, -1.0f, 1.0f, 1.85f, 1.95f}};
  uint32_t revolution = 0;
  for (float x_m = -4.0f; x_m <= 2.0f; x_m += 0.1f) {
    scene.sensor.x_m = x_m;
    scene.Revolve(*grid, 60, ++revolution, kAgeing);
  }
  const auto before = HardCells(*grid, 2.8f, 3.4f, 0.4f);
  ASSERT_GE(before.size(), 3u);
  for (int i = 0; i < 300; ++i) scene.Revolve(*grid, 80, ++revolution, 1);
  const auto after = HardCells(*grid, 2.8f, 3.4f, 0.4f);
  for (const auto& [cell, heights] : before) {
    ASSERT_TRUE(after.contains(cell));
    EXPECT_EQ(after.at(cell).highest_hard_cm, heights.highest_hard_cm);
  }
}

// A mesh fence 8 m away stops one beam in three, at random. Guaranteed is that it is an obstacle in
// every revolution in which a beam stops in its upper half, from then on; each of its cells is
// crossed by several fans of eight beams in the upper half, so that is nearly always so.
// SR-PER02
TEST(AgeingScene, AMeshFenceThatStopsOneBeamInThreeStays) {
  const auto grid = std::make_unique<HeightGrid>();
  LidarScene fence;
  fence.boxes = {kWall, {8.05f, 8.10f, -1.0f, 1.0f, 0.0f, 1.5f}};
  LidarScene open;
  open.boxes = {kWall};
  std::mt19937 random(11);
  int looks = 0;
  int obstacles = 0;
  for (uint32_t revolution = 1; revolution <= 300; ++revolution) {
    std::vector<Return> stopped;
    std::vector<Return> passed;
    for (int direction = -15; direction <= 15; ++direction) {
      SightFan fan = fence.Look(direction, stopped);
      const SightFan through = open.Look(direction, passed);
      std::vector<Vec3> hits;
      for (int beam = 0; beam < fan.beams; ++beam) {
        const float level_m = fan.level_m[beam];
        const bool at_fence = level_m > 7.9f && level_m < 8.3f && through.level_m[beam] != level_m;
        if (!at_fence) continue;
        if (random() % 3 != 0) {
          fan.level_m[beam] = through.level_m[beam];
          continue;
        }
        hits.push_back({fan.sensor_odom.x_m + fan.direction_odom.x_m * level_m,
                        fan.sensor_odom.y_m + fan.direction_odom.y_m * level_m,
                        fan.sensor_odom.z_m + fan.slope[beam] * level_m});
      }
      (void)grid->Age(fan, revolution, kAgeing);
      for (const Vec3& hit : hits) (void)grid->Insert(hit, ReturnClass::kHard, revolution);
    }
    if (revolution < 3) continue;
    for (float y_m = -0.5f; y_m < 0.55f; y_m += 0.2f) {
      const HeightGrid::CellHeights heights = grid->At(CellAt({8.07f, y_m}));
      ++looks;
      obstacles += heights.highest_hard_cm != HeightGrid::kNone && heights.highest_hard_cm > 100;
    }
  }
  ASSERT_GT(looks, 1500);
  EXPECT_GE(obstacles * 100, looks * 99);
}

// Posts that fill their cells only in part: beams pass beside them through the same cells in every
// revolution. Their returns are filed up to three revolutions late and in any order.
//
//    |  |    cell of 0.2 m, post of 0.05 m: beams left and right of it go on to the wall
//    | #|
//    |  |
// SR-PER02
TEST(AgeingScene, ThinPostsNeverVanishHoweverLateTheirReturnsAreFiled) {
  for (uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto share = [&] { return static_cast<float>(random() % 10007) / 10007.0f; };
    const int ageing = 2 + static_cast<int>(seed % (HeightGrid::kMaxAgeingRevolutions - 1));
    const auto grid = std::make_unique<HeightGrid>();
    LidarScene scene;
    scene.boxes = {kWall};
    for (int i = 0; i < 5; ++i) {
      const float x_m = 4.0f + 5.0f * share();
      const float y_m = 3.0f * share() - 1.5f;
      scene.boxes.push_back({x_m, x_m + 0.05f, y_m, y_m + 0.05f, 0.0f, 0.9f + share()});
    }
    struct Late {
      Return what;
      uint32_t taken;
      uint32_t filed;
    };
    std::vector<Late> waiting;
    HeightsByCell posts;
    int seen_again = 0;
    uint32_t revolution = 0;
    for (int i = 0; i < 50; ++i) {
      ++revolution;
      std::vector<Return> returns;
      for (int direction = -64; direction <= 64; ++direction) {
        const SightFan fan = scene.Look(direction, returns);
        EXPECT_EQ(grid->Age(fan, revolution, ageing), Status::kOk);
        for (const Return& item : returns) {
          if (item.what != ReturnClass::kHard || item.point.x_m > 11.0f) continue;
          waiting.push_back({item, revolution, revolution + static_cast<uint32_t>(random() % 4)});
        }
        for (const auto& [cell, heights] : posts) {
          const HeightGrid::CellHeights now = grid->At({cell.first, cell.second});
          ASSERT_NE(now.highest_hard_cm, HeightGrid::kNone);
          ASSERT_GE(now.highest_hard_cm, heights.highest_hard_cm);
          ++seen_again;
        }
        // A few of those that are due, wherever they are in the queue.
        for (int tries = 0; tries < 40 && !waiting.empty(); ++tries) {
          const size_t pick = random() % waiting.size();
          if (waiting[pick].filed > revolution) continue;
          const Late late = waiting[pick];
          waiting[pick] = waiting.back();
          waiting.pop_back();
          EXPECT_EQ(grid->Insert(late.what.point, late.what.what, late.taken), Status::kOk);
          const Cell cell = CellAt({late.what.point.x_m, late.what.point.y_m});
          posts[{cell.x, cell.y}] = grid->At(cell);
        }
      }
    }
    EXPECT_GT(seen_again, 1000);
  }
}

// The fans show nothing of the obstacle itself, as when its beams look a little past the cell; only
// what is filed keeps it, up to ageing_revolutions - 2 revolutions late.
TEST(AgeingScene, FilingAloneKeepsAnObstacle) {
  for (uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const int ageing = 2 + static_cast<int>(seed % (HeightGrid::kMaxAgeingRevolutions - 1));
    const auto grid = std::make_unique<HeightGrid>();
    LidarScene scene;
    scene.boxes = {kWall};
    const Vec3 top = {6.1f, 0.1f, 1.4f};
    std::map<uint32_t, std::vector<uint32_t>> due;  // when filed: when taken
    for (uint32_t revolution = 1; revolution <= 200; ++revolution) {
      due[revolution + static_cast<uint32_t>(random()) % static_cast<uint32_t>(ageing - 1)]
          .push_back(revolution);
      std::vector<Return> returns;
      const int when = static_cast<int>(random() % 7) - 3;
      for (int direction = -4; direction <= 4; ++direction) {
        if (direction == when) {
          for (const uint32_t taken : due[revolution]) {
            (void)grid->Insert({top.x_m, top.y_m, 0.1f}, ReturnClass::kHard, taken);
            (void)grid->Insert(top, ReturnClass::kHard, taken);
          }
        }
        EXPECT_EQ(grid->Age(scene.Look(direction, returns), revolution, ageing), Status::kOk);
        if (revolution > 8) {
          ASSERT_EQ(grid->At(CellAt({top.x_m, top.y_m})).highest_hard_cm, 140) << revolution;
        }
      }
    }
  }
}

}  // namespace
}  // namespace hardpack
