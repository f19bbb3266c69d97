// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <memory>

#include "core/base/math.h"
#include "core/costmap/height_grid.h"
#include "test/not_finite.h"

// Ageing, sentence by sentence: one cell 10 m ahead of a sensor 1 m above the ground, and beams of
// which the test says at what height they cross the cell's middle and how far they came.
//
//     o - - - - - - - - - - - -[cell]- - - - - ->        d = 10 m

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
constexpr Cell kCell = {50, 0};
constexpr float kDistance_m = 10.0f;
constexpr float kFar_m = 20.0f;
constexpr float kSensor_m = 1.0f;

struct Beam {
  float height_m;  // over the cell's middle
  float level_m = kFar_m;
};

SightFan Fan(std::initializer_list<Beam> beams) {
  SightFan fan;
  fan.sensor_odom = {0.1f, 0.1f, kSensor_m};
  fan.direction_odom = {1.0f, 0.0f};
  for (const Beam& beam : beams) {
    fan.slope[fan.beams] = (beam.height_m - kSensor_m) / kDistance_m;
    fan.level_m[fan.beams] = beam.level_m;
    ++fan.beams;
  }
  fan.lowest_slope = -0.3f;
  fan.highest_slope = -0.3f + 0.01f * static_cast<float>(fan.beams - 1);  // 10 cm apart there
  return fan;
}

class Ageing : public ::testing::Test {
 protected:
  void File(float height_m, ReturnClass what, uint32_t revolution) {
    ASSERT_EQ(grid_->Insert({10.1f, 0.1f, height_m}, what, revolution), Status::kOk);
  }
  void Look(uint32_t revolution, std::initializer_list<Beam> beams, int ageing = 3) {
    ASSERT_EQ(grid_->Age(Fan(beams), revolution, ageing), Status::kOk);
  }
  // Revolutions from first on with the same beams.
  void LookTimes(int times, uint32_t first, std::initializer_list<Beam> beams, int ageing = 3) {
    for (int i = 0; i < times; ++i) Look(first + static_cast<uint32_t>(i), beams, ageing);
  }
  // A hard obstacle from 0 to 1 m, filed in revolution 0.
  void FileBox() {
    File(0.0f, ReturnClass::kHard, 0);
    File(1.0f, ReturnClass::kHard, 0);
  }
  HeightGrid::CellHeights Heights() const { return grid_->At(kCell); }
  int Highest() const { return Heights().highest_hard_cm; }

  std::unique_ptr<HeightGrid> grid_ = std::make_unique<HeightGrid>();
};

constexpr int kNone = HeightGrid::kNone;

// SR-PER04
TEST_F(Ageing, TakesRevolutionsInWhichItIsSeenThrough) {
  for (int ageing = 1; ageing <= HeightGrid::kMaxAgeingRevolutions; ++ageing) {
    ASSERT_EQ(grid_->Reset({}), Status::kOk);
    FileBox();
    LookTimes(ageing - 1, 1, {{0.03f}}, ageing);
    EXPECT_EQ(Highest(), 100) << ageing;
    Look(static_cast<uint32_t>(ageing), {{0.03f}}, ageing);
    EXPECT_EQ(Highest(), kNone) << ageing;
    EXPECT_EQ(Heights().lowest_hard_cm, kNone);
  }
}

TEST_F(Ageing, CountsARevolutionOnce) {
  FileBox();
  for (int i = 0; i < 50; ++i) Look(1, {{0.03f}});
  for (int i = 0; i < 50; ++i) Look(2, {{0.03f}});
  EXPECT_EQ(Highest(), 100);
  Look(3, {{0.03f}});
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, CountsOnWhenTheRevolutionCounterWraps) {
  File(0.0f, ReturnClass::kHard, UINT32_MAX - 1);
  File(1.0f, ReturnClass::kHard, UINT32_MAX - 1);
  LookTimes(2, UINT32_MAX, {{0.03f}});  // the last number and 0
  EXPECT_EQ(Highest(), 100);
  Look(1, {{0.03f}});
  EXPECT_EQ(Highest(), kNone);
}

//            ___________ 1.00 highest
//   ------- /___________ 0.98: over the top, or nearly
//   ----------------------- 0.95
TEST_F(Ageing, HeedsNoBeamOverTheTop) {
  FileBox();
  LookTimes(20, 1, {{0.98f}, {1.01f}, {1.04f}, {1.5f}}, 1);
  EXPECT_EQ(Highest(), 100);
  Look(21, {{0.95f}}, 1);
  EXPECT_LT(Highest(), 100);
}

// Over the cell's length of 0.28 m a beam may fall by more than the 3 cm of the edge.
TEST_F(Ageing, AsksForTheWholeCellsLength) {
  FileBox();
  SightFan fan = Fan({{0.95f}});
  fan.sensor_odom.z_m = 4.0f;
  fan.slope[0] = (0.95f - 4.0f) / kDistance_m;  // 0.993 m high where it comes in
  ASSERT_EQ(grid_->Age(fan, 1, 1), Status::kOk);
  EXPECT_EQ(Highest(), 100);
  fan.slope[0] = (0.90f - 4.0f) / kDistance_m;  // 0.944
  ASSERT_EQ(grid_->Age(fan, 3, 1), Status::kOk);
  EXPECT_EQ(Highest(), 94);
}

TEST_F(Ageing, HeedsNoBeamBelowTheLowestReturn) {
  File(1.0f, ReturnClass::kHard, 0);
  File(1.5f, ReturnClass::kHard, 0);
  LookTimes(20, 1, {{0.98f}, {0.5f}, {0.0f}}, 1);  // under a branch
  EXPECT_EQ(Highest(), 150);
}

//   o-----------x          |    |            ended before the cell: occluded
//   o----------------------|----|-x          ended right behind it: a wall's returns scatter
//   o----------------------|----|----x       came back from further away
TEST_F(Ageing, AsksThatTheBeamCameBackFromBehind) {
  FileBox();
  LookTimes(20, 1, {{0.5f, 3.0f}, {0.6f, 9.8f}, {0.4f, 0.0f}, {0.3f, -1.0f}}, 1);
  EXPECT_EQ(Highest(), 100);
  LookTimes(20, 21, {{0.2f, 10.29f}}, 1);
  EXPECT_EQ(Highest(), 100);
  Look(41, {{0.2f, 10.31f}}, 1);
  EXPECT_EQ(Highest(), 21);
}

TEST_F(Ageing, ABeamThatSawNothingMayHaveNoSlope) {
  FileBox();
  SightFan fan = Fan({{0.5f, 0.0f}, {0.03f}});
  fan.slope[0] = kNaN;
  EXPECT_EQ(grid_->Age(fan, 1, 1), Status::kOk);
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, CutsDownToTheLowestBeamThatWentThrough) {
  FileBox();
  LookTimes(3, 1, {{0.8f}, {0.4f}, {0.6f}});
  // 0.4 m and half a centimetre and a bit for its slope over the cell.
  EXPECT_EQ(Highest(), 41);
  EXPECT_EQ(Heights().lowest_hard_cm, 0);
  // It is young again, and what is left takes as long.
  LookTimes(2, 4, {{0.1f}});
  EXPECT_EQ(Highest(), 41);
  Look(6, {{0.1f}});
  EXPECT_EQ(Highest(), 11);
}

TEST_F(Ageing, WhatIsLeftAFewCentimetresHighIsGone) {
  FileBox();
  LookTimes(3, 1, {{0.06f}});  // 7 cm where it is highest
  EXPECT_EQ(Highest(), 7);
  ASSERT_EQ(grid_->Reset({}), Status::kOk);
  FileBox();
  LookTimes(3, 1, {{0.035f}});  // 4.9 cm
  EXPECT_EQ(Highest(), kNone);
}

// Legs are firm, too: what is left of somebody who has gone is not a low thing.
// SR-PER04
TEST_F(Ageing, CountsOfWhatIsSeenThroughGoWithIt) {
  for (const float through_m : {0.03f, 0.1f, 0.4f}) {
    ASSERT_EQ(grid_->Reset({}), Status::kOk);
    FileBox();
    for (int i = 0; i < 15; ++i) grid_->CountLow({10.1f, 0.1f, 0.2f}, true);
    LookTimes(2, 1, {{through_m}});
    EXPECT_TRUE(Heights().firm) << through_m;
    Look(3, {{through_m}});
    EXPECT_FALSE(Heights().firm) << through_m;
    EXPECT_FALSE(Heights().growth) << through_m;
  }
}

// The highest of a rock's returns was too high by the noise; and a low thing that nothing passes
// through keeps its counts whatever passes above it.
TEST_F(Ageing, ALowThingKeepsItsCountsWhenItsTopIsCut) {
  File(0.0f, ReturnClass::kHard, 0);
  File(0.3f, ReturnClass::kHard, 0);
  for (int i = 0; i < 6; ++i) grid_->CountLow({10.1f, 0.1f, 0.2f}, true);
  LookTimes(20, 1, {{0.31f}, {0.5f}, {0.9f}}, 1);
  EXPECT_EQ(Highest(), 30);
  EXPECT_TRUE(Heights().firm);
  LookTimes(3, 21, {{0.2f}});
  EXPECT_EQ(Highest(), 21);
  EXPECT_TRUE(Heights().firm);
}

// Hits in the lower half do not keep the upper half, but it is not cut below them.
TEST_F(Ageing, IsNotCutBelowWhatWasHitMeanwhile) {
  FileBox();
  LookTimes(3, 1, {{0.2f}, {0.3f, 10.0f}, {0.7f}});
  EXPECT_EQ(Highest(), 30);
}

TEST_F(Ageing, AHitInTheUpperHalfKeepsItYoung) {
  FileBox();
  LookTimes(40, 1, {{0.2f}, {0.8f, 10.0f}, {0.9f}});
  EXPECT_EQ(Highest(), 100);
}

// A revolution:  through, through, hit, through, through   (beside a post, the post, beside it)
TEST_F(Ageing, OneHitIsEnoughForARevolution) {
  FileBox();
  for (uint32_t revolution = 1; revolution < 60; ++revolution) {
    for (int i = 0; i < 3; ++i) Look(revolution, {{0.5f}}, 2);
    Look(revolution, {{0.5f, 10.0f}}, 2);
    for (int i = 0; i < 3; ++i) Look(revolution, {{0.5f}}, 2);
    ASSERT_EQ(Highest(), 100);
  }
}

// What hangs above the obstacle, or stands further back, is no hit.
TEST_F(Ageing, WhatEndedElsewhereIsNoHit) {
  FileBox();
  LookTimes(3, 1, {{0.2f}, {1.3f, 10.0f}, {0.8f, 9.8f}, {0.9f, 10.4f}});
  EXPECT_EQ(Highest(), 21);
}

//            - - - - -  1.04   both came back from behind, and nothing ended between
//              o  1.00         the only return
//            - - - - -  0.96
TEST_F(Ageing, ASingleReturnIsSeenThroughByItsNeighbours) {
  File(1.0f, ReturnClass::kHard, 0);
  LookTimes(2, 1, {{0.96f}, {1.04f}});
  EXPECT_EQ(Highest(), 100);
  Look(3, {{0.96f}, {1.04f}});
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, OneNeighbourIsNotEnoughForASingleReturn) {
  File(1.0f, ReturnClass::kHard, 0);
  LookTimes(20, 1, {{1.04f}, {0.96f, 5.0f}}, 1);
  LookTimes(20, 21, {{0.96f}, {1.04f, 0.0f}}, 1);
  EXPECT_EQ(Highest(), 100);
}

TEST_F(Ageing, NeighboursFurtherAwayThanTheMarginSayNothing) {
  File(1.0f, ReturnClass::kHard, 0);
  LookTimes(20, 1, {{0.84f}, {1.16f}}, 1);  // 10 cm of spacing, 3 of edge
  EXPECT_EQ(Highest(), 100);
  Look(21, {{0.88f}, {1.12f}}, 1);
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, NothingIsSeenAroundWhereABeamEnded) {
  File(1.0f, ReturnClass::kHard, 0);
  LookTimes(20, 1, {{0.90f, 10.0f}, {0.96f}, {1.04f}}, 1);
  EXPECT_EQ(Highest(), 100);
}

TEST_F(Ageing, TheSoftObstacleAgesWhereThereIsNoHardOne) {
  File(0.0f, ReturnClass::kGround, 0);
  File(0.8f, ReturnClass::kSoft, 0);
  LookTimes(2, 1, {{0.3f}});
  EXPECT_EQ(Heights().highest_soft_cm, 80);
  Look(3, {{0.3f}});
  EXPECT_EQ(Heights().highest_soft_cm, 31);
  LookTimes(3, 4, {{0.03f}});
  EXPECT_EQ(Heights().highest_soft_cm, kNone);
  EXPECT_EQ(Heights().lowest_cm, 0);
  EXPECT_TRUE(Heights().ground);
}

TEST_F(Ageing, TheHardObstacleGoesBeforeTheSoftOne) {
  FileBox();
  File(0.8f, ReturnClass::kSoft, 0);
  LookTimes(3, 1, {{0.03f}});
  EXPECT_EQ(Highest(), kNone);
  EXPECT_EQ(Heights().highest_soft_cm, 80);
  EXPECT_EQ(Heights().lowest_cm, 0);
  LookTimes(2, 4, {{0.03f}});
  EXPECT_EQ(Heights().highest_soft_cm, 80);
  Look(6, {{0.03f}});
  EXPECT_EQ(Heights().highest_soft_cm, kNone);
  EXPECT_EQ(Heights().lowest_cm, kNone);  // nothing was known but the obstacle
}

TEST_F(Ageing, LeavesTheGroundThatWasObserved) {
  FileBox();
  File(-0.1f, ReturnClass::kGround, 0);
  LookTimes(3, 1, {{0.03f}});
  EXPECT_EQ(Highest(), kNone);
  EXPECT_EQ(Heights().lowest_cm, -10);
  EXPECT_TRUE(Heights().ground);
}

TEST_F(Ageing, FilingInTheUpperHalfMakesYoung) {
  FileBox();
  LookTimes(2, 1, {{0.03f}});
  File(0.5f, ReturnClass::kHard, 2);
  LookTimes(2, 3, {{0.03f}});
  EXPECT_EQ(Highest(), 100);
  Look(5, {{0.03f}});
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, FilingInTheUpperHalfEndsTheMissesOfItsRevolution) {
  FileBox();
  File(0.5f, ReturnClass::kHard, 1);
  Look(1, {{0.03f}}, 1);
  EXPECT_EQ(Highest(), 100);
  Look(2, {{0.03f}}, 1);
  EXPECT_EQ(Highest(), kNone);
}

// A root does not keep the ghost of a person who stood on it.
TEST_F(Ageing, FilingBelowTheMiddleDoesNotMakeYoung) {
  for (uint32_t revolution = 0; revolution < 3; ++revolution) {
    File(0.0f, ReturnClass::kPerson, revolution);
    File(1.0f, ReturnClass::kPerson, revolution);
  }
  for (uint32_t revolution = 3; revolution < 6; ++revolution) {
    File(0.07f, ReturnClass::kHard, revolution);
    Look(revolution, {{0.2f}, {0.07f, 10.0f}});
  }
  EXPECT_EQ(Highest(), 21);
  EXPECT_FALSE(Heights().person);
}

TEST_F(Ageing, FilingASoftReturnKeepsASoftObstacleOnly) {
  File(0.0f, ReturnClass::kSoft, 0);
  File(0.8f, ReturnClass::kSoft, 0);
  LookTimes(2, 1, {{0.03f}});
  File(0.4f, ReturnClass::kSoft, 2);
  LookTimes(2, 3, {{0.03f}});
  EXPECT_EQ(Heights().highest_soft_cm, 80);
  FileBox();  // makes it young, being new
  LookTimes(2, 5, {{0.03f}});
  File(0.8f, ReturnClass::kSoft, 6);
  Look(7, {{0.03f}});
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, WhatIsCutIsNoPersonAnyMore) {
  File(0.0f, ReturnClass::kPerson, 0);
  File(1.7f, ReturnClass::kPerson, 0);
  LookTimes(2, 1, {{0.9f}});
  EXPECT_TRUE(Heights().person);
  Look(3, {{0.9f}});
  EXPECT_EQ(Highest(), 90);
  EXPECT_FALSE(Heights().person);
}

TEST_F(Ageing, APersonFadesWithRevolutionsOfOtherReturns) {
  File(1.0f, ReturnClass::kPerson, 10);
  for (int i = 0; i < 9; ++i) File(1.0f, ReturnClass::kHard, 10);  // the same revolution
  File(1.0f, ReturnClass::kHard, 11);
  File(1.0f, ReturnClass::kHard, 11);
  File(1.0f, ReturnClass::kHard, 12);
  EXPECT_TRUE(Heights().person);
  File(1.0f, ReturnClass::kSoft, 13);
  EXPECT_TRUE(Heights().person);
  File(1.0f, ReturnClass::kHard, 13);
  EXPECT_FALSE(Heights().person);
  EXPECT_EQ(Highest(), 100);
  File(1.0f, ReturnClass::kPerson, 14);
  EXPECT_TRUE(Heights().person);
}

// A mask that bled onto the ground around a person: nothing stands there that could be seen
// through.
TEST_F(Ageing, APersonOnTheGroundFadesWithGroundReturns) {
  File(0.05f, ReturnClass::kPerson, 10);
  for (uint32_t revolution = 11; revolution <= 13; ++revolution) {
    EXPECT_TRUE(Heights().person);
    File(0.0f, ReturnClass::kGround, revolution);
    File(0.0f, ReturnClass::kGround, revolution);
  }
  EXPECT_FALSE(Heights().person);
}

// Lying, and seen together with the ground beside: a person as long as there are returns of one.
TEST_F(Ageing, APersonLyingDoesNotFade) {
  for (uint32_t revolution = 10; revolution <= 40; ++revolution) {
    File(0.0f, ReturnClass::kGround, revolution);
    File(0.2f, ReturnClass::kPerson, revolution);
    EXPECT_TRUE(Heights().person);
  }
}

TEST_F(Ageing, APersonWhoIsSeenNowAndThenDoesNotFade) {
  for (uint32_t revolution = 0; revolution < 40; ++revolution) {
    File(1.0f, revolution % 3 == 0 ? ReturnClass::kPerson : ReturnClass::kHard, revolution);
    EXPECT_TRUE(Heights().person);
  }
}

TEST_F(Ageing, AgesAlongEveryDirectionAndHeight) {
  for (int step = 0; step < 360; ++step) {
    const float angle_rad = static_cast<float>(step) * kRadPerDeg;
    const Vec2 direction = {std::cos(angle_rad), std::sin(angle_rad)};
    const Vec2 at = {0.03f + 7.3f * direction.x_m, 0.05f + 7.3f * direction.y_m};
    ASSERT_EQ(grid_->Insert({at.x_m, at.y_m, 150.0f}, ReturnClass::kHard, 0), Status::kOk);
    ASSERT_EQ(grid_->Insert({at.x_m, at.y_m, 151.0f}, ReturnClass::kHard, 0), Status::kOk);
    SightFan fan;
    fan.sensor_odom = {0.03f, 0.05f, 150.03f};
    fan.direction_odom = direction;
    fan.beams = 1;
    fan.level_m[0] = 8.0f;
    ASSERT_EQ(grid_->Age(fan, 1, 1), Status::kOk);
    EXPECT_EQ(grid_->At(CellAt(at)).highest_hard_cm, kNone) << step << " degrees";
  }
}

TEST_F(Ageing, ReachesTheWindowsEdgeAndNoFurther) {
  const Cell last = {kMapSize_cells / 2 - 1, 0};
  const Vec2 at = CellCenter(last);
  for (const float z_m : {0.95f, 1.5f}) {
    ASSERT_EQ(grid_->Insert({at.x_m, at.y_m, z_m}, ReturnClass::kHard, 0), Status::kOk);
  }
  SightFan fan = Fan({{1.0f, 3.0e38f}});
  EXPECT_EQ(grid_->Age(fan, 1, 1), Status::kOk);
  EXPECT_EQ(grid_->At(last).highest_hard_cm, kNone);
  // From one corner to the other, and out of the window at once.
  const float corner_m = 51.15f;
  for (const float way : {1.0f, -1.0f}) {
    fan.sensor_odom = {-corner_m * way, -corner_m * way, 1.0f};
    fan.direction_odom = {0.70710678f * way, 0.70710678f * way};
    EXPECT_EQ(grid_->Age(fan, 2, 1), Status::kOk);
    fan.direction_odom = {-0.70710678f * way, 0.70710678f * way};
    EXPECT_EQ(grid_->Age(fan, 2, 1), Status::kOk);
  }
}

TEST_F(Ageing, RefusesWhatIsNotFinite) {
  FileBox();
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int place = 0; place < 9; ++place) {
      SightFan fan = Fan({{0.03f}, {0.5f}});
      float* const numbers[] = {
          &fan.sensor_odom.x_m,    &fan.sensor_odom.y_m,    &fan.sensor_odom.z_m,
          &fan.direction_odom.x_m, &fan.direction_odom.y_m, &fan.level_m[1],
          &fan.slope[1],           &fan.lowest_slope,       &fan.highest_slope};
      *numbers[place] = bad;
      EXPECT_EQ(grid_->Age(fan, 1, 1), Status::kNotFinite) << place;
    }
  }
  EXPECT_EQ(Highest(), 100);
}

TEST_F(Ageing, RefusesWhatIsOutOfRange) {
  FileBox();
  const SightFan good = Fan({{0.03f}});
  for (const int beams : {-1, kMaxBeams + 1, INT32_MAX, INT32_MIN}) {
    SightFan fan = good;
    fan.beams = beams;
    EXPECT_EQ(grid_->Age(fan, 1, 1), Status::kInvalidArgument);
  }
  for (const Vec2 direction : {Vec2{0.0f, 0.0f}, Vec2{1.02f, 0.0f}, Vec2{0.98f, 0.0f},
                               Vec2{1.0f, 1.0f}, Vec2{3.0e38f, 3.0e38f}}) {
    SightFan fan = good;
    fan.direction_odom = direction;
    EXPECT_EQ(grid_->Age(fan, 1, 1), Status::kInvalidArgument);
  }
  for (const float x_m : {51.3f, -51.3f, 3.0e38f, -3.0e38f}) {
    SightFan fan = good;
    fan.sensor_odom.x_m = x_m;
    EXPECT_EQ(grid_->Age(fan, 1, 1), Status::kInvalidArgument);
  }
  for (const int ageing : {0, -1, 8, INT32_MAX, INT32_MIN}) {
    EXPECT_EQ(grid_->Age(good, 1, ageing), Status::kInvalidArgument);
  }
  EXPECT_EQ(Highest(), 100);
  SightFan nothing = good;
  nothing.beams = 0;
  EXPECT_EQ(grid_->Age(nothing, 1, 1), Status::kOk);
  EXPECT_EQ(Highest(), 100);
  EXPECT_EQ(grid_->Age(good, 1, 1), Status::kOk);
  EXPECT_EQ(Highest(), kNone);
}

TEST_F(Ageing, SurvivesHugeNumbers) {
  FileBox();
  const float numbers[] = {3.4e38f, -3.4e38f, 1.0e-45f, -0.0f, 1.0e20f, -1.0e20f};
  for (const float slope : numbers) {
    for (const float level_m : numbers) {
      for (const float z_m : numbers) {
        SightFan fan = Fan({{0.5f}, {0.6f}});
        fan.sensor_odom.z_m = z_m;
        fan.slope[0] = slope;
        fan.level_m[0] = level_m;
        fan.slope[1] = -slope;
        fan.lowest_slope = -slope;
        fan.highest_slope = slope;
        EXPECT_EQ(grid_->Age(fan, 1, HeightGrid::kMaxAgeingRevolutions), Status::kOk);
      }
    }
  }
}

TEST_F(Ageing, IsTheSameAfterAJumpOfTheHeight) {
  FileBox();
  ASSERT_EQ(grid_->ShiftHeights(5.0f), Status::kOk);
  EXPECT_EQ(Highest(), 600);
  SightFan fan = Fan({{0.03f}});
  LookTimes(5, 1, {{0.03f}}, 1);  // a beam of the old heights
  EXPECT_EQ(Highest(), 600);
  fan.sensor_odom.z_m += 5.0f;
  EXPECT_EQ(grid_->Age(fan, 7, 1), Status::kOk);
  EXPECT_EQ(Highest(), kNone);
}

// SR-PER11
TEST_F(Ageing, WhatAPersonLeftBehindIsReleasedAndNothingElse) {
  File(0.0f, ReturnClass::kGround, 0);
  File(0.3f, ReturnClass::kPerson, 1);
  File(0.9f, ReturnClass::kHard, 1);  // of the person, but not told
  grid_->ReleasePerson({10.6f, 0.1f}, 0.3f);
  EXPECT_EQ(Highest(), 90) << "too far away";
  grid_->ReleasePerson({10.3f, 0.2f}, 0.4f);
  EXPECT_EQ(Highest(), kNone);
  EXPECT_FALSE(Heights().person);
  EXPECT_TRUE(Heights().ground);
  EXPECT_EQ(Heights().lowest_cm, 0);
}

// SR-PER11
TEST_F(Ageing, WhatWasThereBeforeAPersonCameStays) {
  FileBox();
  File(0.9f, ReturnClass::kPerson, 1);
  grid_->ReleasePerson({10.1f, 0.1f}, 0.5f);
  EXPECT_EQ(Highest(), 100);
  // Once it is seen through, who comes then is the first.
  LookTimes(3, 2, {{0.03f}});
  ASSERT_EQ(Highest(), kNone);
  File(0.9f, ReturnClass::kPerson, 6);
  grid_->ReleasePerson({10.1f, 0.1f}, 0.5f);
  EXPECT_EQ(Highest(), kNone);
  // And the other way round.
  File(0.9f, ReturnClass::kHard, 7);
  grid_->ReleasePerson({10.1f, 0.1f}, 0.5f);
  EXPECT_EQ(Highest(), 90);
}

// The edge of a body, which the label does not reach.
// SR-PER11
TEST_F(Ageing, WhatIsFiledBesideAPersonIsTheirsForASecondOrTwo) {
  constexpr uint64_t kStretch_ns = HeightGrid::kNoted_ns;
  for (const uint64_t after_ns : {uint64_t{0}, kStretch_ns / 2, 3 * kStretch_ns}) {
    ASSERT_EQ(grid_->Reset({}), Status::kOk);
    uint64_t now_ns = 100 * kStretch_ns;
    grid_->ForgetNotes(now_ns);
    grid_->NotePerson({10.5f, 0.3f}, 0.8f);
    for (uint64_t passed_ns = 0; passed_ns < after_ns; passed_ns += 10'000'000) {
      now_ns += 10'000'000;
      grid_->ForgetNotes(now_ns);
    }
    File(0.9f, ReturnClass::kHard, 1);
    grid_->ReleasePerson({10.1f, 0.1f}, 0.5f);
    EXPECT_EQ(Highest() == kNone, after_ns < kStretch_ns) << after_ns;
  }
}

// Who walks without labels: what is hard around them is theirs, until other things return from it.
// SR-PER13
TEST_F(Ageing, WhatIsFlaggedIsAPersonAsIfItWereLabelled) {
  grid_->FlagPerson({10.1f, 0.1f}, 0.4f);
  EXPECT_FALSE(Heights().person) << "there is nothing hard";
  File(0.9f, ReturnClass::kHard, 1);
  grid_->FlagPerson({10.6f, 0.1f}, 0.4f);
  EXPECT_FALSE(Heights().person) << "too far away";
  grid_->FlagPerson({10.3f, 0.1f}, 0.4f);
  EXPECT_TRUE(Heights().person);
  uint32_t revolution = 2;
  for (; Heights().person && revolution < 10; ++revolution) {
    File(0.9f, ReturnClass::kHard, revolution);
  }
  EXPECT_EQ(revolution, 2u + HeightGrid::kPersonMemory);
  EXPECT_EQ(Highest(), 90);
}

TEST_F(Ageing, ReleasesNothingForWhatIsNoPlace) {
  File(0.9f, ReturnClass::kPerson, 1);
  grid_->NotePerson({kNaN, kInfinity}, 0.5f);
  grid_->NotePerson({3.0e38f, -3.0e38f}, 0.5f);
  grid_->FlagPerson({kNaN, kInfinity}, 0.5f);
  grid_->FlagPerson({10.1f, 0.1f}, HeightGrid::kMaxReleased_m + 0.1f);
  grid_->ReleasePerson({kNaN, 0.0f}, 0.5f);
  grid_->ReleasePerson({10.1f, 0.1f}, kNaN);
  grid_->ReleasePerson({10.1f, 0.1f}, -0.1f);
  grid_->ReleasePerson({10.1f, 0.1f}, HeightGrid::kMaxReleased_m + 0.1f);
  grid_->ReleasePerson({1.0e9f, -1.0e9f}, 0.5f);
  grid_->ReleasePerson({3.0e38f, 3.0e38f}, 0.5f);
  EXPECT_EQ(Highest(), 90);
}

}  // namespace
}  // namespace hardpack
