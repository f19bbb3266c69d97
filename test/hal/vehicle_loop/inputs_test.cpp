// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "test/hal/vehicle_loop/closed_loop.h"

// Inputs that only look fresh, ticks that are missed, and memory that is not empty.

namespace hardpack {
namespace {

using control::GoalFrame;
using control::Kind;
using testing::ClosedLoop;

TEST(VehicleLoopInputs, AnInsThatRepeatsItselfIsASilentOne) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.repeats_ins = true;
  ASSERT_TRUE(drive.Until(1.0, [&] { return drive.mode() == Mode::kSafeStop; }));
  EXPECT_EQ(drive.reason(), StopReason::kInsOld);
  EXPECT_FALSE(drive.loop().odometry().uses_ins_rate());
}

// Nobody knows where the vehicle went meanwhile: it stops, and does not go on by itself.
TEST(VehicleLoopInputs, APauseOfTheTicksWhileDrivingStopsForGood) {
  for (const int missed : {25, 100}) {
    ClosedLoop drive;
    drive.DriveTo(60.0f, 0.0f);
    const uint64_t plans = drive.loop().replanner().committed().number;
    ASSERT_GT(plans, 0u);
    drive.Miss(missed);
    drive.Ticks(1);
    EXPECT_NE(drive.mode(), Mode::kDriving) << missed;
    EXPECT_EQ(drive.loop().drives().commanded().left_radps, 0.0f);
    EXPECT_EQ(drive.loop().counters().odometry_gaps, 1u);
    EXPECT_EQ(drive.loop().counters().missed_ticks, static_cast<uint64_t>(missed));
    EXPECT_TRUE(drive.Until(5.0, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }));
    drive.Ticks(200);
    EXPECT_EQ(drive.loop().goals(), 0);
    EXPECT_LT(std::fabs(drive.Speed_mps()), 0.02);
  }
}

// The ramps are the plan's, in metres per second squared, however late a tick is.
TEST(VehicleLoopInputs, AFewMissedTicksDoNotStretchTheRamps) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  const float before_mps = drive.loop().tracking().speed_mps;
  const float limit_mps2 = drive.config().planner.speed.max_deceleration_mps2;
  drive.Miss(4);
  drive.Ticks(1);
  ASSERT_EQ(drive.loop().permission().motion, Motion::kStopAlong);
  EXPECT_NEAR(before_mps - drive.loop().tracking().speed_mps, 0.05f * limit_mps2, 0.01f);
}

// However long the drives' own time-out is.
TEST(VehicleLoopInputs, WheelSpeedsAreAsOldAsTheyAre) {
  ClosedLoop drive;
  const auto config = std::make_unique<VehicleConfig>(drive.config());
  config->onboard.drive.feedback_timeout_ms = 500;
  ASSERT_EQ(drive.loop().Configure(*config), Status::kOk);
  drive.DriveTo(60.0f, 0.0f);
  drive.Act("at 0 process-data left off");
  drive.Ticks(15);
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  EXPECT_EQ(drive.reason(), StopReason::kOdometryOld);
}

// Wheels that turned while nobody was told: what was mapped before has no place any more.
TEST(VehicleLoopInputs, WheelSpeedsThatComeBackAfterASilenceAreAGap) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.Act("at 0 process-data left off");
  ASSERT_TRUE(drive.Until(2.0, [&] { return drive.mode() == Mode::kFault; }));
  drive.Ticks(200);
  EXPECT_EQ(drive.loop().counters().odometry_gaps, 0u);
  drive.Act("at 0 process-data left on");
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.loop().drives().standstill(); }));
  drive.Ticks(1);
  EXPECT_EQ(drive.loop().counters().odometry_gaps, 1u);
}

TEST(VehicleLoopInputs, DecidesTheSameInWhateverMemoryItIsMade) {
  uint64_t hash[2] = {};
  for (int i = 0; i < 2; ++i) {
    ClosedLoop drive("at 0 box 8 0 1.5 1.5", sim::LaneWorld(), i == 0 ? 0x00 : 0xff);
    drive.DriveTo(14.0f, 0.0f);
    drive.Ticks(300);
    ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
    drive.Ticks(50);
    hash[i] = drive.loop().decision_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(VehicleLoopInputs, ConfiguredAnewItIsAsNew) {
  uint64_t hash[2] = {};
  ClosedLoop used;
  used.DriveTo(14.0f, 0.0f);
  for (int i = 0; i < 2; ++i) {
    ClosedLoop drive;
    if (i == 1) {
      // What has driven, in the place of what is new.
      std::memcpy(static_cast<void*>(&drive.loop()), &used.loop(), sizeof(VehicleLoop));
      ASSERT_EQ(drive.loop().Configure(drive.config()), Status::kOk);
    }
    drive.DriveTo(14.0f, 0.0f);
    drive.Ticks(100);
    hash[i] = drive.loop().decision_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

}  // namespace
}  // namespace hardpack
