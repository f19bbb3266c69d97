// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <random>

#include "core/costmap/height_grid.h"
#include "test/core/costmap/stored_row.h"
#include "test/not_finite.h"

// What is known of the ground, and what becomes of heights when the odometry's jumps.

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

class HeightGridGround : public ::testing::Test {
 protected:
  int GroundCells() const {
    int count = 0;
    for (int index = 0; index < kMapCells; ++index) {
      count += grid_->At(grid_->window().FromIndex(index)).ground ? 1 : 0;
    }
    return count;
  }
  void File(const Vec3& point, ReturnClass what, uint32_t revolution) {
    ASSERT_EQ(grid_->Insert(point, what, revolution), Status::kOk);
  }
  std::unique_ptr<HeightGrid> grid_ = std::make_unique<HeightGrid>();
};

//   height 0.0 |x|.|.|.|.|x| 1.0
TEST_F(HeightGridGround, BridgesAllCellsOfALine) {
  ASSERT_EQ(grid_->BridgeGround({0.1f, 0.1f, 0.0f}, {2.1f, 0.1f, 1.0f}), Status::kOk);
  EXPECT_EQ(GroundCells(), 11);
  for (int32_t x = 0; x <= 10; ++x) {
    EXPECT_TRUE(grid_->At({x, 0}).ground);
    EXPECT_EQ(grid_->At({x, 0}).lowest_cm, 10 * x);
    EXPECT_EQ(grid_->At({x, 0}).highest_hard_cm, HeightGrid::kNone);
  }
}

// Where only sight of the ground is filed the same cells are observed, and no height is known.
TEST_F(HeightGridGround, ObservesTheCellsThatItWouldBridge) {
  const auto seen = std::make_unique<HeightGrid>();
  for (uint32_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-60.0f, 60.0f);  // some off the window
    std::uniform_real_distribution<float> way(-15.0f, 15.0f);
    const Vec3 from = {place(random), place(random), way(random)};
    const Vec3 to = {from.x_m + way(random), from.y_m + way(random), way(random)};
    ASSERT_EQ(grid_->BridgeGround(from, to), Status::kOk);
    ASSERT_EQ(seen->ObserveGround(from, to), Status::kOk);
  }
  for (int index = 0; index < kMapCells; ++index) {
    const Cell cell = grid_->window().FromIndex(index);
    ASSERT_EQ(seen->At(cell).observed, grid_->At(cell).ground) << cell.x << ", " << cell.y;
    ASSERT_EQ(grid_->At(cell).observed, grid_->At(cell).ground);
    ASSERT_FALSE(seen->At(cell).ground);
    ASSERT_EQ(seen->At(cell).lowest_cm, HeightGrid::kNone);
  }
  EXPECT_EQ(seen->ObserveGround({kNaN, 0.0f, 0.0f}, {}), Status::kNotFinite);
  EXPECT_EQ(seen->ObserveGround({0.0f, 0.0f, 0.0f}, {41.0f, 0.0f, 0.0f}), Status::kInvalidArgument);
}

// A height that comes later is taken, and sight of what has one changes nothing.
TEST_F(HeightGridGround, KeepsSightAndHeightOfTheGroundApart) {
  ASSERT_EQ(grid_->ObserveGround({0.1f, 0.1f, 0.0f}, {0.1f, 0.1f, 0.0f}), Status::kOk);
  File({0.1f, 0.1f, 0.7f}, ReturnClass::kHard, 1);
  EXPECT_FALSE(grid_->At({0, 0}).ground) << "a hard return is no ground, though it was observed";
  File({0.1f, 0.1f, -0.2f}, ReturnClass::kGround, 1);
  EXPECT_TRUE(grid_->At({0, 0}).ground);
  EXPECT_EQ(grid_->At({0, 0}).lowest_cm, -20);
  ASSERT_EQ(grid_->ObserveGround({0.1f, 0.1f, -9.0f}, {0.1f, 0.1f, -9.0f}), Status::kOk);
  EXPECT_EQ(grid_->At({0, 0}).lowest_cm, -20);
  EXPECT_TRUE(grid_->At({0, 0}).observed);
}

//   . . o o         every cell that the line crosses, so that none is missed at a corner
//   . o o .
//   o o . .
TEST_F(HeightGridGround, BridgesWithoutGapsAtCorners) {
  ASSERT_EQ(grid_->BridgeGround({0.1f, 0.1f, 0.5f}, {0.7f, 0.55f, 0.5f}), Status::kOk);
  EXPECT_EQ(GroundCells(), 6);
  for (const Cell cell : {Cell{0, 0}, Cell{1, 0}, Cell{1, 1}, Cell{2, 1}, Cell{2, 2}, Cell{3, 2}}) {
    EXPECT_TRUE(grid_->At(cell).ground) << cell.x << "," << cell.y;
    EXPECT_EQ(grid_->At(cell).lowest_cm, 50);
  }
}

TEST_F(HeightGridGround, BridgesPointsOfOneCell) {
  ASSERT_EQ(grid_->BridgeGround({0.1f, 0.1f, 0.3f}, {0.1f, 0.1f, 0.3f}), Status::kOk);
  ASSERT_EQ(grid_->BridgeGround({1.05f, 0.1f, 0.2f}, {1.15f, 0.1f, 0.4f}), Status::kOk);
  EXPECT_EQ(GroundCells(), 2);
  EXPECT_EQ(grid_->At({0, 0}).lowest_cm, 30);
  EXPECT_EQ(grid_->At({5, 0}).lowest_cm, 30);
}

TEST_F(HeightGridGround, BridgingLeavesObservedGroundAlone) {
  File({0.5f, 0.1f, 0.2f}, ReturnClass::kGround, 0);
  File({0.9f, 0.1f, 0.6f}, ReturnClass::kHard, 0);
  File({1.3f, 0.1f, -0.6f}, ReturnClass::kSoft, 0);
  ASSERT_EQ(grid_->BridgeGround({0.1f, 0.1f, 0.0f}, {1.9f, 0.1f, 0.0f}), Status::kOk);
  EXPECT_EQ(grid_->At({2, 0}).lowest_cm, 20);
  EXPECT_EQ(grid_->At({4, 0}).lowest_cm, 0);
  EXPECT_EQ(grid_->At({4, 0}).lowest_hard_cm, 60);
  EXPECT_EQ(grid_->At({6, 0}).lowest_cm, -60);
  EXPECT_TRUE(grid_->At({6, 0}).ground);
}

TEST_F(HeightGridGround, BridgesFromOffTheWindowAndOverItsEdge) {
  ASSERT_EQ(grid_->BridgeGround({50.1f, 0.1f, 0.0f}, {60.1f, 0.1f, 0.0f}), Status::kOk);
  EXPECT_EQ(GroundCells(), 6);
  ASSERT_EQ(grid_->BridgeGround({-60.0f, 0.1f, 0.0f}, {-70.0f, 5.0f, 0.0f}), Status::kOk);
  EXPECT_EQ(GroundCells(), 6);
}

TEST_F(HeightGridGround, BridgesAsFarAsItSays) {
  ASSERT_EQ(grid_->BridgeGround({-14.05f, -14.05f, 0.0f}, {14.15f, 14.15f, 0.0f}), Status::kOk);
  EXPECT_GE(GroundCells(), 142);
  EXPECT_EQ(grid_->BridgeGround({-20.0f, 0.1f, 0.0f}, {20.01f, 0.1f, 0.0f}),
            Status::kInvalidArgument);
  EXPECT_EQ(grid_->BridgeGround({-3.0e38f, 0.1f, 0.0f}, {3.0e38f, 3.0e38f, 0.0f}),
            Status::kInvalidArgument);
}

TEST_F(HeightGridGround, RefusesBridgesThatAreNotFinite) {
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int place = 0; place < 6; ++place) {
      Vec3 from = {0.1f, 0.1f, 0.0f};
      Vec3 to = {1.1f, 0.1f, 0.0f};
      float* const numbers[] = {&from.x_m, &from.y_m, &from.z_m, &to.x_m, &to.y_m, &to.z_m};
      *numbers[place] = bad;
      EXPECT_EQ(grid_->BridgeGround(from, to), Status::kNotFinite);
    }
  }
  EXPECT_EQ(GroundCells(), 0);
}

TEST_F(HeightGridGround, SurvivesTheEndOfThePlane) {
  const float far_away[] = {4.29496736e8f, -4.29496736e8f, 4.0e8f, -1.0e9f, 3.0e38f, 8.0e5f};
  for (const float x_m : far_away) {
    for (const float y_m : far_away) {
      ASSERT_EQ(grid_->Recenter({x_m, y_m}), Status::kOk);
      for (const float step_m : {0.0f, 32.0f, -32.0f}) {
        (void)grid_->BridgeGround({x_m, y_m, 0.0f}, {x_m + step_m, y_m - step_m, 1.0f});
        (void)grid_->BridgeGround({x_m, y_m, 0.0f}, {x_m, y_m + step_m, 1.0f});
      }
      (void)grid_->AssumeGround({x_m, y_m, 0.0f}, 20.0f);
      SightFan fan;
      fan.sensor_odom = {x_m, y_m, 0.0f};
      fan.beams = 1;
      fan.level_m[0] = 100.0f;
      for (const Vec2 direction : {Vec2{1.0f, 0.0f}, Vec2{0.0f, -1.0f}, Vec2{-0.6f, 0.8f}}) {
        fan.direction_odom = direction;
        (void)grid_->Age(fan, 1, 1);
      }
    }
  }
}

TEST_F(HeightGridGround, AssumesADiscOfGround) {
  File({0.5f, 0.1f, 0.2f}, ReturnClass::kGround, 0);
  ASSERT_EQ(grid_->AssumeGround({0.1f, 0.1f, -0.05f}, 5.0f), Status::kOk);
  for (int32_t y = -40; y <= 40; ++y) {
    for (int32_t x = -40; x <= 40; ++x) {
      const bool inside = x * x + y * y <= 25 * 25;
      EXPECT_EQ(grid_->At({x, y}).ground, inside) << x << "," << y;
      const int expected = x == 2 && y == 0 ? 20 : inside ? -5 : HeightGrid::kNone;
      EXPECT_EQ(grid_->At({x, y}).lowest_cm, expected);
    }
  }
}

TEST_F(HeightGridGround, AssumesAtMostWhatLiesOnTheWindow) {
  ASSERT_EQ(grid_->AssumeGround({0.1f, 0.1f, 0.0f}, 0.0f), Status::kOk);
  EXPECT_EQ(GroundCells(), 1);
  ASSERT_EQ(grid_->AssumeGround({0.15f, 0.1f, 0.0f}, 0.01f), Status::kOk);  // no cell's middle
  EXPECT_EQ(GroundCells(), 1);
  ASSERT_EQ(grid_->AssumeGround({51.1f, 51.1f, 0.0f}, 1.0f), Status::kOk);
  EXPECT_EQ(GroundCells(), 1 + 26);  // a quarter of the disc and its two axes
  ASSERT_EQ(grid_->AssumeGround({500.0f, 0.1f, 0.0f}, 20.0f), Status::kOk);
  EXPECT_EQ(GroundCells(), 27);
  ASSERT_EQ(grid_->AssumeGround({0.1f, 0.1f, 0.0f}, 20.0f), Status::kOk);
  EXPECT_GT(GroundCells(), 31000);
}

TEST_F(HeightGridGround, RefusesToAssumeNonsense) {
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(grid_->AssumeGround({bad, 0.1f, 0.0f}, 1.0f), Status::kNotFinite);
    EXPECT_EQ(grid_->AssumeGround({0.1f, bad, 0.0f}, 1.0f), Status::kNotFinite);
    EXPECT_EQ(grid_->AssumeGround({0.1f, 0.1f, bad}, 1.0f), Status::kNotFinite);
    EXPECT_EQ(grid_->AssumeGround({0.1f, 0.1f, 0.0f}, bad), Status::kNotFinite);
  }
  EXPECT_EQ(grid_->AssumeGround({0.1f, 0.1f, 0.0f}, -0.1f), Status::kInvalidArgument);
  EXPECT_EQ(grid_->AssumeGround({0.1f, 0.1f, 0.0f}, 20.1f), Status::kInvalidArgument);
  EXPECT_EQ(GroundCells(), 0);
}

// The odometry's height drifts upwards: the ground follows, a centimetre in a revolution.
TEST_F(HeightGridGround, RisesByOneCentimetreInARevolution) {
  const auto lowest = [&] { return grid_->At({0, 0}).lowest_cm; };
  File({0.1f, 0.1f, 0.0f}, ReturnClass::kGround, 0);
  for (uint32_t revolution = 1; revolution <= 5; ++revolution) {
    for (int i = 0; i < 10; ++i) File({0.1f, 0.1f, 0.05f}, ReturnClass::kGround, revolution);
    EXPECT_EQ(lowest(), static_cast<int>(revolution));
  }
  File({0.1f, 0.1f, 0.05f}, ReturnClass::kGround, 6);  // never above the return
  EXPECT_EQ(lowest(), 5);
  File({0.1f, 0.1f, 0.02f}, ReturnClass::kGround, 7);  // and at once below it
  EXPECT_EQ(lowest(), 2);
}

TEST_F(HeightGridGround, DoesNotRiseUnderAnObstacle) {
  File({0.1f, 0.1f, 0.0f}, ReturnClass::kGround, 0);
  File({0.3f, 0.1f, 0.0f}, ReturnClass::kGround, 0);
  File({0.1f, 0.1f, 1.0f}, ReturnClass::kHard, 0);
  File({0.3f, 0.1f, 1.0f}, ReturnClass::kSoft, 0);
  for (uint32_t revolution = 1; revolution <= 9; ++revolution) {
    File({0.1f, 0.1f, 0.5f}, ReturnClass::kGround, revolution);
    File({0.3f, 0.1f, 0.5f}, ReturnClass::kGround, revolution);
  }
  EXPECT_EQ(grid_->At({0, 0}).lowest_cm, 0);
  EXPECT_EQ(grid_->At({1, 0}).lowest_cm, 0);
}

TEST_F(HeightGridGround, TellsEverythingInTheNewHeightsAfterAJump) {
  File({0.1f, 0.1f, -0.2f}, ReturnClass::kGround, 0);
  File({0.1f, 0.1f, 0.3f}, ReturnClass::kPerson, 0);
  File({0.1f, 0.1f, 1.3f}, ReturnClass::kHard, 0);
  File({0.1f, 0.1f, 0.9f}, ReturnClass::kSoft, 0);
  ASSERT_EQ(grid_->ShiftHeights(-1.25f), Status::kOk);
  const HeightGrid::CellHeights heights = grid_->At({0, 0});
  EXPECT_EQ(heights.lowest_cm, -145);
  EXPECT_EQ(heights.lowest_hard_cm, -95);
  EXPECT_EQ(heights.highest_hard_cm, 5);
  EXPECT_EQ(heights.highest_soft_cm, -35);
  EXPECT_TRUE(heights.ground);
  EXPECT_TRUE(heights.person);
  EXPECT_EQ(grid_->At({1, 0}).lowest_cm, HeightGrid::kNone);
  File({0.1f, 0.1f, 0.5f}, ReturnClass::kHard, 0);  // filed in the new heights
  EXPECT_EQ(grid_->At({0, 0}).highest_hard_cm, 50);
  ASSERT_EQ(grid_->ShiftHeights(1.25f), Status::kOk);
  EXPECT_EQ(grid_->At({0, 0}).highest_hard_cm, 175);
  EXPECT_EQ(grid_->At({0, 0}).lowest_cm, -20);
}

TEST_F(HeightGridGround, ReadsRowsInTheNewHeightsToo) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3 point = {0.1f + 0.2f * static_cast<float>(random() % 64), 0.1f,
                        0.01f * static_cast<float>(random() % 300)};
    File(point, static_cast<ReturnClass>(1 + random() % 4), static_cast<uint32_t>(random() % 8));
  }
  ASSERT_EQ(grid_->ShiftHeights(37.5f), Status::kOk);
  const int32_t begin = grid_->window().origin.x;
  const StoredRow stored(*grid_, {begin, 0});
  for (int x = 0; x < kMapSize_cells; ++x) {
    const HeightGrid::CellHeights heights = grid_->At({begin + x, 0});
    const HeightGrid::CellHeights read = stored.At(x);
    EXPECT_EQ(read.lowest_cm, heights.lowest_cm);
    EXPECT_EQ(read.lowest_hard_cm, heights.lowest_hard_cm);
    EXPECT_EQ(read.highest_hard_cm, heights.highest_hard_cm);
    EXPECT_EQ(read.highest_soft_cm, heights.highest_soft_cm);
    EXPECT_EQ(read.ground, heights.ground);
    EXPECT_EQ(read.person, heights.person);
    EXPECT_EQ(read.observed, heights.observed);
    EXPECT_EQ(read.guessed, heights.guessed);
  }
}

TEST_F(HeightGridGround, SaturatesAboutTheSumOfTheShifts) {
  ASSERT_EQ(grid_->ShiftHeights(100.0f), Status::kOk);
  File({0.1f, 0.1f, 3.0e38f}, ReturnClass::kHard, 0);
  File({0.1f, 0.1f, -3.0e38f}, ReturnClass::kHard, 0);
  EXPECT_EQ(grid_->At({0, 0}).highest_hard_cm, 30000);
  EXPECT_EQ(grid_->At({0, 0}).lowest_hard_cm, -10000);
  ASSERT_EQ(grid_->ShiftHeights(-100.0f), Status::kOk);
  ASSERT_EQ(grid_->ShiftHeights(-100.0f), Status::kOk);
  EXPECT_EQ(grid_->At({0, 0}).highest_hard_cm, 10000);
  EXPECT_EQ(grid_->At({0, 0}).lowest_hard_cm, -30000);
}

TEST_F(HeightGridGround, RefusesShiftsThatAreTooLarge) {
  File({0.1f, 0.1f, 1.0f}, ReturnClass::kHard, 0);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(grid_->ShiftHeights(bad), Status::kNotFinite);
  }
  for (const float bad_m : {100.1f, -100.1f, 3.0e38f, -3.0e38f}) {
    EXPECT_EQ(grid_->ShiftHeights(bad_m), Status::kInvalidArgument);
  }
  EXPECT_EQ(grid_->At({0, 0}).highest_hard_cm, 100);
  ASSERT_EQ(grid_->ShiftHeights(60.0f), Status::kOk);
  EXPECT_EQ(grid_->ShiftHeights(60.0f), Status::kInvalidArgument);  // the sum would be
  EXPECT_EQ(grid_->At({0, 0}).highest_hard_cm, 6100);
  ASSERT_EQ(grid_->Reset({}), Status::kOk);
  EXPECT_EQ(grid_->ShiftHeights(60.0f), Status::kOk);
}

}  // namespace
}  // namespace hardpack
