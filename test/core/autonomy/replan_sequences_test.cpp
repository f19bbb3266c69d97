// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "test/core/autonomy/replan_drive.h"

// Drives from start to end, with what happens on the way. Every round of every drive is checked by
// Drive itself: rest at the end, speeds within the limits and from the vehicle's own, and the new
// path joined to the old one where the vehicle is.

namespace hardpack {
namespace {

// +1 or -1: the side on which a path passes x_m; 0 if it does not.
int SideAt(const WorldPath& path, float x_m, float middle_y_m) {
  for (const Pose2& pose : path) {
    if (pose.x_m >= x_m) return pose.y_m > middle_y_m ? 1 : -1;
  }
  return 0;
}

// A yard 40 m long, so that a search that finds no way has not far to look.
//   ######################
//   #  o ->              #
//   ######################
void AddYard(Scene& world) {
  world.Add(-15, 25, 195, 26);
  world.Add(-15, -26, 195, -25);
  world.Add(-16, -26, -15, 26);
  world.Add(195, -26, 196, 26);
}

//                _____
//             _-       -_
//   o -------< [  4 m  ]  >------- x      as good on either side
//             -_       _-
TEST(ReplanSequence, KeepsItsSideOfASymmetricObstacle) {
  for (const uint32_t seed : {1u, 2u}) {
    SCOPED_TRACE(seed);
    Drive drive({24.1f, 0.1f});
    drive.units = 2500;
    drive.world.Add(70, -10, 76, 10);
    drive.random.seed(seed);
    drive.jitter_m = 0.03f;
    drive.jitter_rad = 0.02f;
    drive.map_flickers = true;
    drive.Start();
    int side = 0;
    int switches = 0;
    int rounds = 0;
    int others = 0;  // new plans that would have passed on the other side
    drive.on_round = [&] {
      if (drive.truth.x_m > 13.0f) return;
      ++rounds;
      const int now = SideAt(drive.committed().path, 14.5f, 0.1f);
      const int wanted = SideAt(drive.replanner().planner().result().path, 14.5f, 0.1f);
      if (side != 0 && now != side) ++switches;
      if (side != 0 && wanted == -side) ++others;
      side = now;
    };
    drive.DriveToGoal(30.0f);
    EXPECT_TRUE(drive.Arrived());
    EXPECT_GE(rounds, 100);
    EXPECT_GT(others, 5) << "nothing to resist";
    EXPECT_EQ(switches, 0);
  }
}

// The same, and behind it the committed path is blocked again and again far away: that is no reason
// to pass the near one on the other side.
TEST(ReplanSequence, KeepsItsSideWhenSomethingFarAwayIsBlocked) {
  Drive drive({45.1f, 0.1f});
  drive.units = 500;  // so that what is added every sixth round does not fill the world
  drive.world.Add(60, -10, 66, 10);
  drive.jitter_m = 0.03f;
  drive.jitter_rad = 0.02f;
  drive.map_flickers = true;
  drive.Start();
  int side = 0;
  int switches = 0;
  int blocked = 0;
  drive.on_round = [&] {
    if (drive.truth.x_m > 11.0f) return;
    const int now = SideAt(drive.committed().path, 12.5f, 0.1f);
    if (side != 0 && now != side) ++switches;
    if (drive.outcome().reason == ReplanReason::kBlocked) ++blocked;
    side = now;
    // On the path, 30 m on.
    if (drive.rounds % 6 != 0) return;
    const PathState far = StateAt(drive.committed(), 30.0f);
    const Cell cell = CellAt({far.pose.x_m, far.pose.y_m});
    drive.world.Add(cell.x, cell.y, cell.x + 1, cell.y + 1);
  };
  drive.DriveToGoal(40.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GE(blocked, 3);
  EXPECT_EQ(switches, 0);
}

//            #               #             #
//   o ->           then  o ->      then    #      a gap of 4 m, 2 m, none
//            #               #             #
// SR-PLN02
TEST(ReplanSequence, DrivesSlowlyToANarrowingGapAndStopsShortOfAClosedOne) {
  Drive drive({35.1f, 0.1f});
  AddYard(drive.world);
  drive.world.Add(100, -25, 101, -10);
  drive.world.Add(100, 11, 101, 25);
  drive.units = 1500;
  drive.Start();
  while (drive.truth.x_m < 4.0f) drive.Tick();
  EXPECT_FALSE(drive.committed().narrow);
  drive.world.Add(100, -25, 101, -5);
  drive.world.Add(100, 6, 101, 25);
  const uint32_t number = drive.committed().number;
  while (drive.truth.x_m < 12.0f && drive.now_ns < 30'000'000'000u) drive.Tick();
  ASSERT_GE(drive.truth.x_m, 12.0f);
  EXPECT_TRUE(drive.committed().narrow);
  EXPECT_EQ(drive.committed().status, Status::kNarrowGap);
  EXPECT_EQ(drive.committed().number, number) << "the way through its middle is the same";
  const CommittedPlan& narrow = drive.committed();
  for (int k = 0; k < narrow.path.size(); ++k) {
    if (std::abs(narrow.path[k].x_m - 20.1f) < 0.5f) {
      EXPECT_LE(narrow.speed[k], drive.world.params.speed.min_speed_mps) << k;
    }
  }
  EXPECT_GT(drive.speed_mps, 1.0f);
  drive.world.Add(100, -25, 101, 25);
  for (int tick = 0; tick < 400; ++tick) drive.Tick();
  EXPECT_EQ(drive.outcome().decision, ReplanDecision::kStop);
  EXPECT_FALSE(IsUsable(drive.outcome().status));
  EXPECT_LT(drive.speed_mps, 0.5f);
  EXPECT_GT(drive.Clearance(), 0.0);
  EXPECT_LT(drive.truth.x_m, 20.0f);
  // And it goes on when the gap opens again.
  drive.world.blocks.erase(drive.world.blocks.begin() + 6, drive.world.blocks.end());
  drive.DriveToGoal(30.0f);
  EXPECT_TRUE(drive.Arrived());
}

//   o-> |                                             x     the goal is 150 m away, the map reaches
//       | 51 m                                              51 m
TEST(ReplanSequence, DrivesOnToAGoalBeyondTheMap) {
  Drive drive({150.1f, 20.1f});
  drive.world.Add(150, -20, 160, 40);  // some obstacles on the way
  drive.world.Add(350, 20, 356, 90);
  drive.world.Add(500, 0, 520, 70);
  drive.Start();
  float before_m = drive.ToGoal();
  while (!drive.Arrived() && drive.now_ns < 80'000'000'000u) {
    for (int tick = 0; tick < 200 && !drive.Arrived(); ++tick) drive.Tick();
    ASSERT_TRUE(drive.Arrived() || drive.ToGoal() < before_m - 1.0f)
        << drive.truth.x_m << ", " << drive.truth.y_m;
    before_m = drive.ToGoal();
  }
  EXPECT_TRUE(drive.Arrived());
  EXPECT_TRUE(drive.committed().reaches_goal);
  EXPECT_GT(drive.replanner().counters().extended, 5u);
  EXPECT_EQ(drive.replanner().counters().stopped, 0u);
}

// A detour is longer than the capacity of a path: it is cut, and carried on while it is driven.
TEST(ReplanSequence, CarriesOnAPathThatWasCut) {
  Drive drive({30.1f, 0.1f});
  drive.world.params.path.step_m = 0.12f;  // 30 m fill a path
  drive.world.Add(75, -90, 78, 60);
  drive.Start();
  drive.DriveToGoal(40.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GT(drive.replanner().counters().extended, 0u);
}

//   o ->  - - [#] - - - x       it was not there when the path was planned
// SR-PLN02
TEST(ReplanSequence, ReplacesAPathThatIsBlockedWithinOnePlan) {
  Drive drive({40.1f, 0.1f});
  drive.Start();
  while (drive.truth.x_m < 8.0f) drive.Tick();
  while (drive.replanner().busy()) drive.Tick();
  drive.world.Add(90, -4, 94, 4);
  const int rounds = drive.rounds;
  while (drive.rounds == rounds) drive.Tick();
  EXPECT_EQ(drive.outcome().decision, ReplanDecision::kReplaced);
  EXPECT_EQ(drive.outcome().reason, ReplanReason::kBlocked);
  Plan plan;
  plan.path = drive.committed().path;
  EXPECT_GT(ClearanceOf(drive.world, plan), 0.0);
  const double clearance = drive.DriveToGoal(30.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GT(clearance, 0.0);
}

//   o ->  - - -#- - - - x       a wall, and no way around
// SR-PLN02
TEST(ReplanSequence, StopsShortOfAWallThatAppears) {
  Drive drive({37.1f, 0.1f});
  AddYard(drive.world);
  drive.Start();
  while (drive.truth.x_m < 8.0f) drive.Tick();
  const float speed_mps = drive.speed_mps;
  drive.world.Add(90, -25, 91, 25);
  drive.units = 1500;
  for (int tick = 0; tick < 300; ++tick) {
    drive.Tick();
    ASSERT_GT(drive.Clearance(), 0.0);
  }
  EXPECT_EQ(drive.outcome().decision, ReplanDecision::kStop);
  EXPECT_TRUE(drive.committed().is_stop);
  EXPECT_LT(drive.speed_mps, 0.5f);  // the last metre takes long
  // It brakes at once and as hard as it may, not only at the wall.
  EXPECT_LT(drive.truth.x_m, 8.0f + speed_mps * speed_mps / 4.0f + 3.0f);
}

// A wall nearer than the vehicle can stop: what is free is kept to brake on, and the outcome says
// so.
// SR-PLN02
TEST(ReplanSequence, SaysStopWhereItIsTooLateToStop) {
  Drive drive({37.1f, 0.1f});
  AddYard(drive.world);
  drive.Start();
  while (drive.truth.x_m < 8.0f) drive.Tick();
  const int x = static_cast<int>(drive.truth.x_m * 5.0f) + 14;
  drive.world.Add(x, -25, x + 10, 25);
  drive.follows = false;
  drive.units = 1 << 20;
  for (int tick = 0; tick < 3; ++tick) drive.Tick();
  EXPECT_EQ(drive.outcome().decision, ReplanDecision::kStop);
  EXPECT_FALSE(IsUsable(drive.outcome().status));
  EXPECT_TRUE(drive.committed().is_stop);
  Plan plan;
  plan.path = drive.committed().path;
  EXPECT_GT(ClearanceOf(drive.world, plan), 0.0);
  EXPECT_LT(LengthOf(plan.path), 2.5f);
}

//   x   <-   o - -|    Braked harder than planned, it stands short of the end of its stop, and has
// to turn on the spot to get away. From ahead, at the speed that the stop has there, it could not.
// SR-PLN02
TEST(ReplanSequence, PlansFromWhereItStandsShortOfTheEndOfAStop) {
  Drive drive({37.1f, 0.1f});
  drive.Start();
  while (drive.truth.x_m < 8.0f) drive.Tick();
  drive.units = 1 << 20;
  drive.goal.position_odom = {-20.1f, 0.1f};
  for (int tick = 0; tick < 3; ++tick) drive.Tick();
  ASSERT_TRUE(drive.committed().is_stop);
  drive.follows = false;
  drive.speed_mps = 0.0f;
  ASSERT_GT(WayTo(drive.committed().path, drive.committed().path.size() - 1) -
                drive.replanner().place().along_m,
            2.0f * kAtPoint_m);
  for (int tick = 0; tick < 5; ++tick) drive.Tick();
  EXPECT_TRUE(IsUsable(drive.outcome().status));
  EXPECT_FALSE(drive.committed().is_stop);
}

// The same with a way around it: a plan that first turns where the stop ends is none for a vehicle
// that cannot stop by then, and must not make it take the stop for a path that is kept.
//            _#_
//   o ----->| # |
//            \#/
TEST(ReplanSequence, SaysStopUntilItStandsWhereAPlanBeginsWithATurn) {
  Drive drive({37.1f, 0.1f});
  drive.Start();
  while (drive.truth.x_m < 8.0f) drive.Tick();
  const int x = static_cast<int>(drive.truth.x_m * 5.0f) + 14;
  drive.world.Add(x, -25, x + 10, 25);
  drive.units = 1 << 20;
  for (int tick = 0; tick < 2; ++tick) drive.Tick();  // one is of the map before
  drive.world.blocks.back().low.x += 5;               // leaves room to turn, not to stop
  bool could_turn = false;
  while (drive.speed_mps > 1.0f) {
    drive.Tick();
    could_turn = could_turn || IsUsable(drive.outcome().plan_status);
    ASSERT_EQ(drive.outcome().decision, ReplanDecision::kStop);
    EXPECT_FALSE(IsUsable(drive.outcome().status));
    EXPECT_TRUE(drive.committed().is_stop);
  }
  EXPECT_TRUE(could_turn);
}

TEST(ReplanSequence, KeepsOnePathInOpenGroundWhateverThePosesJitter) {
  Drive drive({40.1f, 10.1f}, {0.1f, 0.1f, 0.3f});
  drive.jitter_m = 0.03f;
  drive.jitter_rad = 0.02f;
  drive.Start();
  drive.on_round = [&] { EXPECT_EQ(drive.committed().slow_points, 0); };
  drive.DriveToGoal(30.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_EQ(drive.committed().number, 1u);
  EXPECT_EQ(drive.Replaced(), 1);
  EXPECT_GT(drive.rounds, 80);
}

//   o ------->  - - - x
//            \.
//              \.______ x'      another goal while it drives
TEST(ReplanSequence, TurnsToAnotherGoalWithoutAStep) {
  Drive drive({40.1f, 0.1f});
  drive.Start();
  while (drive.truth.x_m < 10.0f) drive.Tick();
  drive.goal.position_odom = {35.1f, -20.1f};
  const int rounds = drive.rounds;
  while (drive.rounds < rounds + 2) drive.Tick();
  EXPECT_EQ(drive.replanner().counters().replaced[static_cast<int>(ReplanReason::kGoalChanged)],
            1u);
  EXPECT_TRUE(drive.committed().reaches_goal);
  drive.DriveToGoal(30.0f);
  EXPECT_TRUE(drive.Arrived());
}

// The other goal is behind: it stops, turns on the spot, and drives back.
TEST(ReplanSequence, StopsAndTurnsForAGoalBehind) {
  Drive drive({40.1f, 0.1f});
  drive.Start();
  while (drive.truth.x_m < 10.0f) drive.Tick();
  drive.goal.position_odom = {-10.1f, 0.1f};
  float furthest_m = 0.0f;
  for (int tick = 0; tick < 4000 && !drive.Arrived(); ++tick) {
    drive.Tick();
    furthest_m = std::max(furthest_m, drive.truth.x_m);
  }
  EXPECT_TRUE(drive.Arrived());
  EXPECT_LT(furthest_m, 22.0f);
  EXPECT_NEAR(std::abs(drive.truth.theta_rad), kPi, 0.2f);
}

// A goal that drifts by centimetres, as one given on the globe does, is the same goal.
TEST(ReplanSequence, TakesADriftingGoalForTheSame) {
  Drive drive({40.1f, 0.1f});
  drive.Start();
  drive.on_round = [&] { drive.goal.position_odom.y_m += 0.002f; };
  drive.DriveToGoal(30.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_EQ(drive.replanner().counters().replaced[static_cast<int>(ReplanReason::kGoalChanged)],
            0u);
}

// The same of its heading: what turns by less than a tenth of a radian is the same goal.
TEST(ReplanSequence, TakesAGoalThatTurnsALittleForTheSame) {
  for (const float turn_rad : {0.09f, -0.09f, 0.11f, -0.11f}) {
    SCOPED_TRACE(turn_rad);
    Drive drive({40.1f, 0.1f});
    drive.goal.has_heading = true;
    drive.Start();
    while (drive.truth.x_m < 10.0f) drive.Tick();
    drive.goal.heading_rad += turn_rad;
    const int rounds = drive.rounds;
    while (drive.rounds < rounds + 2) drive.Tick();
    EXPECT_EQ(drive.replanner().counters().replaced[static_cast<int>(ReplanReason::kGoalChanged)],
              std::abs(turn_rad) < 0.1f ? 0u : 1u);
  }
}

//   ============ . . . x
//        o->                 0.6 m beside its path
TEST(ReplanSequence, StartsFromThePoseWhenItIsFarOffItsPath) {
  for (const float off_m : {0.4f, 0.6f, -0.6f}) {
    SCOPED_TRACE(off_m);
    Drive drive({40.1f, 0.1f});
    drive.Start();
    while (drive.truth.x_m < 10.0f || drive.replanner().busy()) drive.Tick();
    const int rounds = drive.rounds;
    drive.truth.y_m += off_m;
    drive.follows = false;
    drive.units = 1 << 20;
    while (drive.rounds == rounds) drive.Tick();
    const bool is_far = std::abs(off_m) > 0.5f;
    EXPECT_EQ(drive.replanner().counters().reanchored, is_far ? 1u : 0u);
    EXPECT_EQ(drive.outcome().reason == ReplanReason::kOffPath, is_far);
    if (!is_far) continue;
    EXPECT_FALSE(drive.outcome().anchored);
    EXPECT_EQ(drive.committed().path[0].x_m, drive.state.pose.x_m);
    EXPECT_EQ(drive.committed().path[0].y_m, drive.state.pose.y_m);
    EXPECT_NEAR(drive.committed().path[0].theta_rad, drive.state.pose.theta_rad, 1e-4f);
  }
}

// A turn on the spot that was given up goes on a little: the path is planned from where that ends.
// SR-STA06
TEST(ReplanSequence, StartsFromThePoseWhenItStandsTurnedOffItsPath) {
  for (const float off_rad : {0.2f, 0.5f, -0.5f}) {
    SCOPED_TRACE(off_rad);
    Drive drive({40.1f, 0.1f});
    drive.follows = false;
    drive.units = 1 << 20;
    drive.Start();
    while (drive.rounds < 2) drive.Tick();
    drive.truth.theta_rad += off_rad;
    drive.Tick();
    const bool is_far = std::abs(off_rad) > Replanner::kMaxStandingTurn_rad;
    EXPECT_EQ(drive.outcome().reason == ReplanReason::kOffPath, is_far);
    if (!is_far) continue;
    EXPECT_NEAR(drive.committed().path[0].theta_rad, off_rad, 1e-3f);
  }
}

//               #
//   o --_    _--  | _-- x   what was planned around is gone: the path is made straight, although it
//        | --_-   | -       is cheaper by less than one on another side would have to be
//        #        #
TEST(ReplanSequence, StraightensItsPathOnTheSameWay) {
  Drive drive({40.1f, 0.1f});
  drive.world.Add(60, -30, 64, -9);
  drive.world.Add(110, 10, 114, 30);
  drive.Start();
  while (drive.truth.x_m < 3.0f) drive.Tick();
  const uint32_t number = drive.committed().number;
  float gain = 0.0f;
  drive.on_round = [&] {
    if (drive.outcome().reason != ReplanReason::kCheaper) return;
    gain = std::max(gain, drive.outcome().committed_cost - drive.outcome().new_cost);
  };
  drive.world.blocks.clear();
  const int rounds = drive.rounds;
  while (drive.rounds < rounds + 3) drive.Tick();
  EXPECT_GT(drive.committed().number, number);
  EXPECT_GE(gain, Replanner::kSameWayFloor);
  EXPECT_LT(gain, drive.world.params.replan.cheaper_floor);
}

//          ~~~~~~~~~~
//   o ____/~~~[#]~~~~\___ x       the side that was taken turns out to be bushes, the other one is
//                                 free: clearly cheaper
TEST(ReplanSequence, TakesAClearlyCheaperWayOnce) {
  Drive drive({40.1f, 0.1f});
  drive.world.Add(100, -10, 104, 10);
  drive.Start();
  while (drive.truth.x_m < 3.0f) drive.Tick();
  EXPECT_EQ(drive.Replaced(), 1);
  if (SideAt(drive.committed().path, 20.0f, 0.1f) > 0) {
    drive.world.Add(60, 3, 130, 60, Costmap::kSoft);
  } else {
    drive.world.Add(60, -60, 130, -3, Costmap::kSoft);
  }
  drive.DriveToGoal(30.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_EQ(drive.replanner().counters().replaced[static_cast<int>(ReplanReason::kCheaper)], 1u);
  EXPECT_EQ(drive.Replaced(), 2);
}

//        p          a person steps up beside the way: the path stays, its speeds do not
//   o ----------> x
TEST(ReplanSequence, SlowsOnAKeptPathForAPerson) {
  Drive drive({40.1f, 0.1f});
  drive.Start();
  while (drive.truth.x_m < 3.0f || drive.replanner().busy()) drive.Tick();
  const float before_mps = drive.SlowestBetween(12.0f, 18.0f);
  const uint32_t number = drive.committed().number;
  drive.world.Add(90, 18, 91, 19, Costmap::kPerson);
  const int rounds = drive.rounds;
  while (drive.rounds == rounds) drive.Tick();
  EXPECT_EQ(drive.committed().number, number);
  EXPECT_EQ(drive.outcome().decision, ReplanDecision::kKept);
  EXPECT_LT(drive.SlowestBetween(12.0f, 18.0f), 0.8f * before_mps);
}

// So near that braking along the path leaves it too fast beside them, it is held; further away the
// ramp is enough. They leave room to creep, so that standing is nowhere asked for.
// SR-SPD03
TEST(ReplanSequence, IsHeldForAPersonWhoComesUpTooNear) {
  for (const bool is_near : {false, true}) {
    Drive drive({60.1f, 0.1f});
    drive.Start();
    while (drive.speed_mps < 4.0f || drive.replanner().busy()) drive.Tick();
    const int x = FloorToInt(drive.truth.x_m * kCellsPerMeter) + (is_near ? 17 : 90);
    drive.world.Add(x, 18, x + 1, 19, Costmap::kPerson);
    const int rounds = drive.rounds;
    while (drive.rounds == rounds) drive.Tick();
    EXPECT_EQ(drive.outcome().decision, ReplanDecision::kKept);
    EXPECT_EQ(drive.outcome().held, is_near);
    if (is_near) {
      EXPECT_EQ(drive.outcome().held_by, CapCause::kPerson);
      EXPECT_GT(drive.committed().speed[drive.committed().speed.size() / 2], 0.5f);
    }
  }
}

//          ##          a gap of 4 m aside
//   o ---         x    wheels that follow a turn half as fast: the same bends, driven more slowly,
//          ##          by the square root of it where the rate of the curvature is what limits
TEST(ReplanSequence, DrivesBendsMoreSlowlyWithWheelsThatFollowThemMoreSlowly) {
  const auto slowest_mps = [](float quickness) {
    Drive drive({30.1f, 0.1f});
    drive.world.Add(30, -60, 33, 0);
    drive.world.Add(30, 21, 33, 60);
    drive.world.params.optimizer.preferred_curvature_rate_per_m2 = 0.175f;
    drive.state.turn_quickness = quickness;
    drive.follows = false;
    drive.Start();
    while (drive.rounds < 2) drive.Tick();
    EXPECT_GT(drive.committed().path.size(), 2);
    return drive.SlowestBetween(2.0f, 9.0f);
  };
  const float typical_mps = slowest_mps(1.0f);
  EXPECT_LT(slowest_mps(0.5f), 0.85f * typical_mps);
  EXPECT_GT(slowest_mps(0.5f), 0.65f * typical_mps);
  EXPECT_EQ(slowest_mps(2.0f), typical_mps) << "what is quicker gets no more";
}

// Rocks everywhere, flickering, and noisy poses: it arrives, and touches nothing.
TEST(ReplanSequence, ArrivesThroughRocks) {
  Drive drive({80.1f, 60.1f});
  std::mt19937 random(5);
  for (int i = 0; i < 90; ++i) {
    const int x = static_cast<int>(random() % 460u) - 20;
    const int y = static_cast<int>(random() % 360u) - 20;
    if ((std::abs(x) < 15 && std::abs(y) < 15) ||
        (std::abs(x - 400) < 16 && std::abs(y - 300) < 16)) {
      continue;
    }
    drive.world.Add(x, y, x + static_cast<int>(random() % 9u), y + static_cast<int>(random() % 9u));
  }
  drive.jitter_m = 0.03f;
  drive.jitter_rad = 0.02f;
  drive.map_flickers = true;
  drive.Start();
  const double clearance = drive.DriveToGoal(60.0f);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GT(clearance, 0.0);
}

}  // namespace
}  // namespace hardpack
