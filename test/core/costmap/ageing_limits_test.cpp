// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>

#include "core/costmap/height_grid.h"

// How many cells a tick may hold against fans, how far a fan tells of anything, and how far above
// and below an obstacle a return still belongs to it.
//
//     o - - - -[10 m]- - - -[12 m]- - -[14 m]- - - - ->

namespace hardpack {
namespace {

constexpr int kNoHeight = HeightGrid::kNone;
constexpr float kLevelFar_m = 20.0f;

// From the sensor's height, level unless it says otherwise.
struct BeamOfLength {
  float level_m;
  float slope = 0.0f;
};

SightFan Fan(float sensor_m, std::initializer_list<BeamOfLength> beams, float along_x = 1.0f) {
  SightFan fan;
  fan.sensor_odom = {0.1f, 0.1f, sensor_m};
  fan.direction_odom = {along_x, 0.0f};
  for (const BeamOfLength& beam : beams) {
    fan.slope[fan.beams] = beam.slope;
    fan.level_m[fan.beams] = beam.level_m;
    ++fan.beams;
  }
  return fan;  // lowest_slope and highest_slope are the same: no margin for the beams' spacing
}

class AgeingLimits : public ::testing::Test {
 protected:
  // Hard from 0.9 m to 1.5 m, filed in revolution 0.
  void FileAt(Cell cell) {
    const Vec2 at = CellCenter(cell);
    for (const float height_m : {0.9f, 1.5f}) {
      ASSERT_EQ(grid_->Insert({at.x_m, at.y_m, height_m}, ReturnClass::kHard, 0), Status::kOk);
    }
  }
  // Through what stands in the way, at 1 m.
  void Look(uint32_t revolution, float along_x = 1.0f) {
    ASSERT_EQ(grid_->Age(Fan(1.0f, {{kLevelFar_m}}, along_x), revolution, 1), Status::kOk);
  }
  bool IsWhole(Cell cell) const { return grid_->At(cell).highest_hard_cm == 150; }

  std::unique_ptr<HeightGrid> grid_ = std::make_unique<HeightGrid>();
};

// SR-DET03
TEST_F(AgeingLimits, HoldNoMoreCellsAgainstFansThanATickMay) {
  const Cell near = {50, 0};
  const Cell middle = {60, 0};
  const Cell far = {70, 0};
  for (const Cell cell : {near, middle, far}) FileAt(cell);
  grid_->BeginTick(0);
  Look(1);
  EXPECT_TRUE(IsWhole(near));
  grid_->BeginTick(2);
  Look(1);
  EXPECT_FALSE(IsWhole(near));
  EXPECT_FALSE(IsWhole(middle));
  EXPECT_TRUE(IsWhole(far));
  Look(1);  // in the same tick
  EXPECT_TRUE(IsWhole(far));
  grid_->BeginTick(3);
  Look(1);
  EXPECT_FALSE(IsWhole(far));
}

// The fan comes back from 20 m, in column 100; its walk goes three columns further, for the cells'
// middles and the line's end. What stands behind that costs the tick nothing.
TEST_F(AgeingLimits, SpendNothingOnCellsBeyondWhatTheFanTellsOf) {
  const Cell behind = {104, 0};
  const Cell other = {-50, 0};
  FileAt(behind);
  FileAt(other);
  grid_->BeginTick(1);
  Look(1);
  EXPECT_TRUE(IsWhole(behind));
  Look(1, -1.0f);
  EXPECT_FALSE(IsWhole(other));
}

// The margin is the edge's 3 cm alone. Numbers of binary fractions meet it exactly.
//            - - - - -  0.795
//              o  0.78         the only return
//            - - - - -  0.765
//              x  0.75         as low as still belongs to it
TEST_F(AgeingLimits, ABeamThatEndedAtTheMarginItselfEndedThere) {
  constexpr float kDistance_m = 10.0f;
  for (const float ended_m : {0.75f, 0.734375f}) {
    ASSERT_EQ(grid_->Reset({}), Status::kOk);
    ASSERT_EQ(grid_->Insert({10.1f, 0.1f, 0.78f}, ReturnClass::kHard, 0), Status::kOk);
    const SightFan fan = Fan(ended_m, {{kLevelFar_m, (0.765f - ended_m) / kDistance_m},
                                       {kLevelFar_m, (0.795f - ended_m) / kDistance_m},
                                       {kDistance_m, 0.0f}});
    ASSERT_EQ(grid_->Age(fan, 1, 1), Status::kOk);
    EXPECT_EQ(grid_->At({50, 0}).highest_hard_cm, ended_m == 0.75f ? 78 : kNoHeight) << ended_m;
  }
}

}  // namespace
}  // namespace hardpack
