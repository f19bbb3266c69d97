// SPDX-License-Identifier: Apache-2.0
// A replanner whose plans take their time: where they join, and what comes too late.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "test/core/autonomy/replan_drive.h"

namespace hardpack {
namespace {

// A round takes half a second and more: the next plan joins so much further ahead.
TEST(ReplanLate, JoinsAheadOfTheVehicleHoweverLongAPlanTakes) {
  Drive drive({60.1f, 0.1f});
  drive.world.Add(60, -8, 64, 12);
  drive.world.Add(140, -12, 144, 8);
  drive.units = 200;
  drive.Start();
  float furthest_m = 0.0f;
  drive.on_round = [&] { furthest_m = std::max(furthest_m, drive.replanner().latency_s()); };
  while (drive.truth.x_m < 5.0f) drive.Tick();
  drive.world.Add(90, -3, 92, 3);  // blocks, so that something is replaced
  drive.DriveToGoal(60.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GT(furthest_m, 0.3f);
  EXPECT_LE(drive.replanner().counters().late, 1u);
}

// Planning slows down of a sudden: the plan that comes late is not used, and nothing jumps.
TEST(ReplanLate, DoesNotUseAPlanThatCameLate) {
  Drive drive({60.1f, 0.1f});
  drive.world.params.replan.min_latency_s = 0.0f;
  drive.Start();
  while (drive.truth.x_m < 8.0f || drive.replanner().busy()) drive.Tick();
  drive.units = 60;
  drive.world.Add(150, -4, 154, 4);
  const int rounds = drive.rounds;
  while (drive.rounds == rounds) drive.Tick();
  EXPECT_TRUE(drive.outcome().late);
  EXPECT_NE(drive.outcome().reason, ReplanReason::kCheaper);
  drive.units = 1000;
  drive.DriveToGoal(60.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GT(drive.Clearance(), 0.0);
}

// Begins a round, leaves its last unit, and drives on for so many ticks before that is done.
// Returns what would have come out in time.
ReplanDecision EndRoundLate(Drive& drive, int ticks) {
  drive.units = 0;
  drive.Tick();
  const auto in_time = std::make_unique<Replanner>(drive.replanner());
  while (in_time->StepCells(1) == Progress::kBusy) {
    EXPECT_EQ(drive.replanner().StepCells(1), Progress::kBusy);
  }
  for (int tick = 0; tick < ticks; ++tick) drive.Tick();
  drive.units = 1 << 20;
  drive.Tick();
  EXPECT_FALSE(drive.replanner().busy());
  return in_time->outcome().decision;
}

//   o ->  - - - - -[#]- - x       the new plan joins the path behind the stretch that planning
//                                 takes, or not long before a block that is far away: so far that
//                                 what is half way to it can be bent gently
// Where the vehicle has passed the joint by the time that the plan is ready, it stops, rather than
// joins behind itself.
TEST(ReplanLate, StopsWhereItHasPassedTheJointWhenThePlanIsReady) {
  struct Case {
    int block;
    int ticks;
    ReplanDecision in_time;
    bool late;
  };
  for (const Case& c : {Case{100, 1, ReplanDecision::kReplaced, false},
                        Case{100, 30, ReplanDecision::kReplaced, true},
                        Case{100, 150, ReplanDecision::kReplaced, true},
                        Case{140, 100, ReplanDecision::kExtended, false},
                        Case{140, 200, ReplanDecision::kExtended, true}}) {
    SCOPED_TRACE(c.block * 1000 + c.ticks);
    Drive drive({60.1f, 0.1f});
    drive.Start();
    while (drive.truth.x_m < 8.0f || drive.replanner().busy()) drive.Tick();
    drive.world.Add(c.block, -4, c.block + 4, 4);
    EXPECT_EQ(EndRoundLate(drive, c.ticks), c.in_time);
    EXPECT_EQ(drive.outcome().late, c.late);
    EXPECT_EQ(drive.outcome().decision, c.late ? ReplanDecision::kStop : c.in_time);
    drive.units = 1000;
    const double clearance = drive.DriveToGoal(40.0f);
    EXPECT_TRUE(drive.Arrived());
    EXPECT_GT(clearance, 0.0);
  }
}

}  // namespace
}  // namespace hardpack
