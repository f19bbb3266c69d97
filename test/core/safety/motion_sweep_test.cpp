// SPDX-License-Identifier: Apache-2.0
#include "core/safety/motion_sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace hardpack {
namespace {

struct Bench {
  VehicleParams vehicle;
  Footprint footprint = FootprintOf(vehicle);
  MotionSweep sweep;

  explicit Bench(float margin_m = 0.05f, Vec2 place = {0.0f, 0.0f}) {
    sweep.Configure(footprint, margin_m);
    sweep.Advance(place);
  }
  SweepResult Try(const std::vector<SweptPose>& motion) { return sweep.Try(motion); }
};

std::vector<SweptPose> SweptStraightOn(float way_m, float speed_mps) {
  std::vector<SweptPose> motion;
  for (int k = 0; k <= 40; ++k) {
    const float share = static_cast<float>(k) / 40.0f;
    motion.push_back({{share * way_m, 0.0f, 0.0f}, (1.0f - share) * speed_mps});
  }
  return motion;
}

// A turn about the point turn_m ahead of the middle, without getting on: what a skid-steered
// vehicle's hind part does at speed.
std::vector<SweptPose> TurnAbout(float turn_m, float turn_rad, float speed_mps) {
  std::vector<SweptPose> motion;
  for (int k = 0; k <= 40; ++k) {
    const float angle = turn_rad * static_cast<float>(k) / 40.0f;
    motion.push_back(
        {{turn_m - turn_m * std::cos(angle), -turn_m * std::sin(angle), angle}, speed_mps});
  }
  return motion;
}

// Outline of 1.52 x 1.38 m; a margin of 5 cm at speed.
//   [ > ]------->  x
TEST(MotionSweep, TellsWhatIsAheadAndHowFastItIsHit) {
  Bench bench;
  EXPECT_TRUE(bench.Try(SweptStraightOn(4.0f, 2.0f)).clear);
  bench.sweep.File({3.0f, 0.3f});
  const SweepResult hit = bench.Try(SweptStraightOn(4.0f, 2.0f));
  EXPECT_FALSE(hit.clear);
  // Touched after 3.0 - 0.76 m of 4.
  EXPECT_NEAR(hit.impact_mps, 2.0f * (1.0f - 2.24f / 4.0f), 0.12f);
  EXPECT_TRUE(bench.Try(SweptStraightOn(2.0f, 2.0f)).clear) << "it stops before";
}

TEST(MotionSweep, PassesWhatStandsBesideByMoreThanTheMargin) {
  for (const float aside_m : {0.84f, 0.77f}) {
    Bench bench;
    bench.sweep.File({3.0f, aside_m});
    EXPECT_TRUE(bench.Try(SweptStraightOn(4.0f, 3.0f)).clear) << aside_m;
  }
  Bench bench;
  bench.sweep.File({3.0f, 0.67f});
  EXPECT_FALSE(bench.Try(SweptStraightOn(4.0f, 3.0f)).clear);
}

// A motion may be off: along by 0.3 m, so that what it stops 0.2 m before is touched, and what
// stands 0.2 m beside it is not; aside the other way round.
// SR-MOV04
TEST(MotionSweep, WhatAMotionMayBeOffByCountsInItsDirection) {
  for (const bool is_along : {true, false}) {
    std::vector<SweptPose> motion = SweptStraightOn(2.0f, 1.0f);
    for (SweptPose& pose : motion) (is_along ? pose.along_m : pose.aside_m) = 0.3f;
    Bench ahead;
    ahead.sweep.File({2.0f + 0.76f + 0.2f, 0.0f});
    EXPECT_EQ(ahead.Try(motion).clear, !is_along);
    Bench beside;
    beside.sweep.File({1.5f, 0.69f + 0.2f});
    EXPECT_EQ(beside.Try(motion).clear, is_along);
  }
  // No further than kMaxOff_m.
  std::vector<SweptPose> motion = SweptStraightOn(2.0f, 1.0f);
  for (SweptPose& pose : motion) pose.along_m = 100.0f;
  Bench ahead;
  ahead.sweep.File({2.0f + 0.76f + MotionSweep::kMaxOff_m + 0.1f, 0.0f});
  EXPECT_TRUE(ahead.Try(motion).clear);
}

//  post         what turns left about a point ahead of its middle swings its tail to the right
//    o
//   [   >  .]
// SR-MOV01 the hind part of the outline counts while it turns
TEST(MotionSweep, TheTailThatSwingsOutTouches) {
  Bench bench;
  bench.sweep.File({-0.7f, -0.85f});  // 0.16 m beside the right flank, near the tail
  EXPECT_TRUE(bench.Try(SweptStraightOn(3.0f, 1.5f)).clear) << "straight on it is out of the way";
  EXPECT_FALSE(bench.Try(TurnAbout(0.7f, 0.35f, 1.5f)).clear);
  EXPECT_TRUE(bench.Try(TurnAbout(0.7f, -0.35f, 1.5f)).clear) << "to the other side";
}

TEST(MotionSweep, WhatTouchesAtTheStartDoesNotHoldUnlessItBecomesDeeper) {
  Bench bench;
  bench.sweep.File({0.0f, 0.68f});  // within the flank
  EXPECT_TRUE(bench.Try(SweptStraightOn(3.0f, 0.4f)).clear);
  EXPECT_FALSE(bench.Try(TurnAbout(0.0f, 0.5f, 0.0f)).clear) << "a corner would come onto it";
}

TEST(MotionSweep, AMapReplacesWhatItHasSeenAndKeepsWhatCameSince) {
  const auto map = std::make_unique<Costmap>();
  map->window = GridWindow::CenteredAt({0.0f, 0.0f});
  Bench bench;
  bench.sweep.File({2.0f, 0.0f});
  bench.sweep.MapBegun();
  bench.sweep.File({3.0f, 0.0f});
  bench.sweep.MapDone(*map);
  EXPECT_FALSE(bench.sweep.IsHard(CellAt({2.0f, 0.0f}))) << "the map says that there is nothing";
  EXPECT_TRUE(bench.sweep.IsHard(CellAt({3.0f, 0.0f}))) << "it came while the map was made";
  bench.sweep.MapBegun();
  map->flags[map->window.Index(CellAt({4.0f, 0.0f}))] = Costmap::kHard;
  bench.sweep.MapDone(*map);
  EXPECT_FALSE(bench.sweep.IsHard(CellAt({3.0f, 0.0f})));
  EXPECT_TRUE(bench.sweep.IsHard(CellAt({4.0f, 0.0f})));
  EXPECT_FALSE(bench.Try(SweptStraightOn(4.0f, 2.0f)).clear)
      << "all of a cell where no part is known";
}

// What has left the square does not come back on its other side.
TEST(MotionSweep, TheSquareFollowsTheVehicle) {
  Bench bench;
  bench.sweep.File({-3.0f, 0.0f});
  for (int step = 1; step <= 300; ++step) {
    bench.sweep.Advance({0.1f * static_cast<float>(step), 0.05f * static_cast<float>(step)});
  }
  for (int x = -32; x < 32; ++x) {
    for (int y = -32; y < 32; ++y) EXPECT_FALSE(bench.sweep.IsHard({150 + x, 75 + y}));
  }
  EXPECT_FALSE(bench.sweep.IsHard(CellAt({-3.0f, 0.0f})));
}

TEST(MotionSweep, MoreThanATickMayLookAtIsTakenForTouched) {
  Bench bench;
  for (float x = -2.0f; x < 6.0f; x += 0.2f) {
    for (float y = -2.0f; y < 2.0f; y += 0.2f) {
      if (std::fabs(y) > 1.2f) bench.sweep.File({x + 0.1f, y + 0.1f});
    }
  }
  int tries = 0;
  while (bench.Try(SweptStraightOn(3.0f, 1.0f)).clear && tries < 1000) ++tries;
  EXPECT_LT(tries, 1000);
  EXPECT_GT(tries, 2) << "both stops of a tick";
  bench.sweep.Advance({0.0f, 0.0f});
  EXPECT_TRUE(bench.Try(SweptStraightOn(3.0f, 1.0f)).clear) << "the next tick has its own";
}

TEST(MotionSweep, NumbersThatAreNoneChangeNothing) {
  Bench bench;
  bench.sweep.File({NAN, 0.0f});
  bench.sweep.File({INFINITY, 1.0f});
  bench.sweep.Advance({NAN, 0.0f});
  EXPECT_TRUE(bench.Try(SweptStraightOn(3.0f, 1.0f)).clear);
}

// Against the outline in double precision: no return within half a part of it goes unseen, none
// further off than margin and half a part is made up.
// SR-MOV01
TEST(MotionSweep, AgreesWithTheOutlineItself) {
  std::mt19937 random(7);
  const auto uniform = [&random](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  int touched = 0;
  for (int i = 0; i < 4000; ++i) {
    Bench bench;
    const Vec2 point = {uniform(-2.5f, 3.5f), uniform(-2.0f, 2.0f)};
    const float turn_rad = uniform(-1.0f, 1.0f);
    const float way_m = uniform(0.0f, 2.5f);
    std::vector<SweptPose> motion;
    double deepest_m = -10.0;
    double first_m = -10.0;
    for (int k = 0; k <= 40; ++k) {
      const float share = static_cast<float>(k) / 40.0f;
      const Pose2 pose = {share * way_m, 0.1f * share, share * turn_rad};
      motion.push_back({pose, 2.0f});
      const double c = std::cos(static_cast<double>(pose.theta_rad));
      const double s = std::sin(static_cast<double>(pose.theta_rad));
      const double dx = static_cast<double>(point.x_m - pose.x_m);
      const double dy = static_cast<double>(point.y_m - pose.y_m);
      const double depth_m =
          std::min(0.76 - std::fabs(c * dx + s * dy), 0.69 - std::fabs(c * dy - s * dx));
      deepest_m = std::max(deepest_m, depth_m);
      if (k == 0) first_m = depth_m;
    }
    bench.sweep.File(point);
    const bool is_clear = bench.Try(motion).clear;
    touched += is_clear ? 0 : 1;
    if (first_m > -0.1) continue;  // it touches at the start
    if (deepest_m > -0.02) {
      EXPECT_FALSE(is_clear) << i;
    }
    if (deepest_m < -0.08) {
      EXPECT_TRUE(is_clear) << i;
    }
  }
  EXPECT_GT(touched, 300);
}

}  // namespace
}  // namespace hardpack
