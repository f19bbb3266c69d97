// SPDX-License-Identifier: Apache-2.0
#include "core/safety/corridor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/base/math.h"
#include "core/speed/speed.h"
#include "test/core/safety/path_of.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
using testing::PathOf;
constexpr CorridorSize kSize = {.half_width_m = 0.74f, .pivot_radius_m = 1.08f, .reach_m = 12.0f};

WorldPath Straight(float length_m, float step_m = 0.275f, Vec2 from = {}) {
  WorldPath path;
  for (float x_m = 0.0f; x_m <= length_m && !path.full(); x_m += step_m) {
    EXPECT_EQ(path.PushBack({from.x_m + x_m, from.y_m, 0.0f}), Status::kOk);
  }
  return path;
}

struct Rig {
  std::unique_ptr<Corridor> corridor = std::make_unique<Corridor>();
  explicit Rig(const WorldPath& path, float along_m = 0.0f) {
    corridor->Reset();
    corridor->Advance({path[0].x_m, path[0].y_m}, 1);
    EXPECT_EQ(corridor->Build(path, along_m, kSize, 1), Status::kOk);
  }
  bool Holds(float x_m, float y_m) { return corridor->File({x_m, y_m}, false); }
};

//   - - - - - - - + - - - -   0.74
//   [>]================
//   - - - - - - - + - - - -  -0.74
// SR-COR01
TEST(Corridor, ToldToTheCentimetreOnBothSides) {
  for (const float side : {-1.0f, 1.0f}) {
    for (float x_m = 0.5f; x_m < 10.0f; x_m += 0.173f) {
      Rig inside(Straight(11.0f));
      EXPECT_TRUE(inside.Holds(x_m, side * 0.735f)) << x_m;
      EXPECT_NEAR(inside.corridor->obstacle_along_m(), x_m, 1e-3f);
      Rig outside(Straight(11.0f));
      EXPECT_FALSE(outside.Holds(x_m, side * 0.745f)) << x_m;
      EXPECT_FALSE(outside.corridor->has_obstacle());
    }
  }
}

TEST(Corridor, BeginsAtTheVehiclesMiddleAndEndsRoundBehindThePath) {
  Rig test(Straight(6.0f, 0.25f), 2.0f);
  EXPECT_FALSE(test.Holds(1.95f, 0.0f));  // under the vehicle, or behind it
  EXPECT_FALSE(test.Holds(0.5f, 0.3f));
  EXPECT_FALSE(test.Holds(-3.0f, 0.0f));
  EXPECT_TRUE(test.Holds(2.05f, 0.7f));
  EXPECT_TRUE(test.Holds(6.73f, 0.0f));
  EXPECT_FALSE(test.Holds(6.75f, 0.0f));
  EXPECT_FALSE(test.Holds(6.6f, 0.6f));
}

TEST(Corridor, EndsAtItsReach) {
  Rig test(Straight(40.0f));
  EXPECT_TRUE(test.Holds(12.0f, 0.0f));
  EXPECT_FALSE(test.Holds(14.0f, 0.0f));
}

TEST(Corridor, NothingThatIsNotANumberIsInIt) {
  Rig test(Straight(11.0f));
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_FALSE(test.Holds(bad, 0.0f));
    EXPECT_FALSE(test.Holds(3.0f, bad));
    EXPECT_FALSE(test.Holds(bad, bad));
  }
  EXPECT_FALSE(test.Holds(3.0e38f, 0.0f));
  EXPECT_FALSE(test.corridor->has_obstacle());
}

TEST(Corridor, OfSeveralTheFirstAlongThePathCounts) {
  Rig test(Straight(11.0f));
  EXPECT_TRUE(test.corridor->File({8.0f, 0.0f}, false));
  EXPECT_TRUE(test.corridor->File({4.0f, 0.2f}, true));
  EXPECT_TRUE(test.corridor->File({6.0f, 0.0f}, false));
  EXPECT_TRUE(test.corridor->File({4.0f, 0.2f}, true));  // twice
  EXPECT_NEAR(test.corridor->obstacle_along_m(), 4.0f, 1e-3f);
  EXPECT_TRUE(test.corridor->is_person());
}

TEST(Corridor, IsAPersonWhereOneIsAmongTheFirstReturns) {
  Rig test(Straight(11.0f));
  EXPECT_TRUE(test.corridor->File({6.0f, 0.0f}, false));
  EXPECT_FALSE(test.corridor->is_person());
  EXPECT_TRUE(test.corridor->File({7.0f, 0.0f}, true));  // behind it
  EXPECT_FALSE(test.corridor->is_person());
  EXPECT_TRUE(test.corridor->File({6.3f, 0.0f}, true));  // labels of the same come later
  EXPECT_TRUE(test.corridor->is_person());
  EXPECT_NEAR(test.corridor->obstacle_along_m(), 6.0f, 1e-3f);
  EXPECT_TRUE(test.corridor->File({5.9f, 0.0f}, false));
  EXPECT_TRUE(test.corridor->is_person());
  EXPECT_TRUE(test.corridor->File({3.0f, 0.0f}, false));  // something else before
  EXPECT_FALSE(test.corridor->is_person());
}

TEST(Corridor, RefusesPathsThatAreNoneAndHasNoCorridorThen) {
  Rig test(Straight(11.0f));
  EXPECT_EQ(test.corridor->Build(PathOf({{0, 0, 0}}), 0.0f, kSize, 0), Status::kPathTooShort);
  EXPECT_FALSE(test.corridor->has_corridor());
  EXPECT_FALSE(test.Holds(1.0f, 0.0f));
  EXPECT_EQ(test.corridor->Build({}, 0.0f, kSize, 0), Status::kPathTooShort);
  EXPECT_EQ(test.corridor->Build(PathOf({{0, 0, 0}, {kNaN, 0, 0}}), 0.0f, kSize, 0),
            Status::kNotFinite);
  EXPECT_EQ(test.corridor->Build(Straight(3.0f), kNaN, kSize, 0), Status::kNotFinite);
  CorridorSize size = kSize;
  size.half_width_m = kNaN;
  EXPECT_EQ(test.corridor->Build(Straight(3.0f), 0.0f, size, 0), Status::kInvalidArgument);
  size = kSize;
  size.reach_m = 1.0e9f;
  EXPECT_EQ(test.corridor->Build(Straight(3.0f), 0.0f, size, 0), Status::kInvalidArgument);
  EXPECT_FALSE(test.corridor->has_corridor());
}

// At the end of its path nothing is in its way any more.
TEST(Corridor, HasNoneBehindTheEnd) {
  Rig test(Straight(3.0f, 0.25f), 3.5f);
  EXPECT_FALSE(test.corridor->has_corridor());
  EXPECT_FALSE(test.Holds(3.1f, 0.0f));
}

TEST(Corridor, OfATurnOnTheSpotIsADisc) {
  const WorldPath path = PathOf({{0, 0, 0}, {1, 0, 0}, {1, 0, 1.5f}, {1, 1, 1.5f}});
  Rig test(path);
  EXPECT_TRUE(test.Holds(2.05f, 0.0f));
  EXPECT_TRUE(test.Holds(1.0f, -1.07f));
  EXPECT_FALSE(test.Holds(2.1f, 0.0f));
  EXPECT_FALSE(test.Holds(1.0f, -1.09f));
  const WorldPath turn = PathOf({{1, 0, 0}, {1, 0, 1.5f}});
  Rig alone(turn);
  EXPECT_TRUE(alone.corridor->has_corridor());
  EXPECT_TRUE(alone.Holds(0.0f, 0.0f));
  EXPECT_FALSE(alone.Holds(-0.1f, 0.0f));
}

// Where a path crosses itself, the return stands in its way at the first crossing.
//        ____
//   >---/-+  |
//       |____|
TEST(Corridor, OfALoopTakesTheFirstCrossing) {
  WorldPath path;
  for (int i = 0; i <= 60; ++i) {
    const float angle = 0.13f * static_cast<float>(i);
    EXPECT_EQ(path.PushBack({2.0f * std::sin(angle), 2.0f - 2.0f * std::cos(angle), angle}),
              Status::kOk);
  }
  Rig test(path, 1.0f);
  EXPECT_TRUE(test.Holds(0.0f, 4.0f));
  EXPECT_NEAR(test.corridor->obstacle_along_m(), 6.28f, 0.15f);
  EXPECT_FALSE(test.Holds(0.0f, 2.0f));
  EXPECT_FALSE(test.Holds(0.0f, 4.8f));
  EXPECT_TRUE(test.Holds(std::sin(0.7f) * 2.0f, 2.0f - 2.0f * std::cos(0.7f)));
  EXPECT_NEAR(test.corridor->obstacle_along_m(), 1.4f, 0.1f);
}

double DistanceTo(const WorldPath& path, double from_m, double to_m, Vec2 point) {
  double nearest = 1e9;
  double before = 0.0;
  for (int k = 0; k + 1 < path.size(); ++k) {
    const double ax = path[k].x_m;
    const double ay = path[k].y_m;
    const double dx = double{path[k + 1].x_m} - ax;
    const double dy = double{path[k + 1].y_m} - ay;
    const double length = std::hypot(dx, dy);
    for (double on = 0.0; on <= length; on += 0.002) {
      const double along = before + on;
      if (along < from_m || along > to_m) continue;
      const double x = ax + dx * on / length;
      const double y = ay + dy * on / length;
      nearest = std::min(nearest, std::hypot(double{point.x_m} - x, double{point.y_m} - y));
    }
    before += length;
  }
  return nearest;
}

// Any path, any point: against the distance by brute force. Fine paths are taken together in
// chords, which moves the edge by millimetres.
// SR-COR01
TEST(Corridor, AgreesWithBruteForceOnRandomPaths) {
  constexpr uint32_t kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  int inside = 0;
  for (int scene = 0; scene < 40; ++scene) {
    const float step_m = scene % 3 == 0 ? 0.06f : 0.275f;
    Pose2 pose = {100.0f * unit(random), 100.0f * unit(random), 3.0f * unit(random)};
    WorldPath path;
    float curvature = 0.0f;
    while (!path.full()) {
      ASSERT_EQ(path.PushBack(pose), Status::kOk);
      curvature = std::clamp(curvature + 0.1f * unit(random), -0.5f, 0.5f);
      pose = {pose.x_m + step_m * std::cos(pose.theta_rad),
              pose.y_m + step_m * std::sin(pose.theta_rad), pose.theta_rad + step_m * curvature};
    }
    Rig test(path, 0.3f);
    for (int i = 0; i < 60; ++i) {
      const int near = static_cast<int>(random() % 60u);
      const Vec2 point = {path[near].x_m + 1.5f * unit(random),
                          path[near].y_m + 1.5f * unit(random)};
      // The edge itself, the two ends and what is just behind the vehicle are others' tests.
      const double off_m = DistanceTo(path, 0.3, 12.0, point);
      const double near_start = std::hypot(double{point.x_m} - double{path[1].x_m},
                                           double{point.y_m} - double{path[1].y_m});
      if (std::abs(off_m - 0.74) < 0.02 || near_start < 1.2) continue;
      if (DistanceTo(path, 11.5, 13.5, point) < 1.2) continue;
      ASSERT_EQ(test.corridor->File(point, false), off_m < 0.74)
          << "scene " << scene << " point " << i << " at " << off_m;
      inside += off_m < 0.74 ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 200);
}

// A plan that was made on an older map is held against what has come since, by its cell.
// SR-COR02
TEST(Corridor, HoldsANewPathAgainstWhatCameSinceItsMapWasBegun) {
  Rig test(Straight(11.0f, 0.275f, {0.0f, 5.0f}));
  Corridor& corridor = *test.corridor;
  corridor.Advance({0.0f, 0.0f}, 20);
  EXPECT_FALSE(corridor.File({4.0f, 0.0f}, true));  // not in the way of the old path
  corridor.Advance({0.0f, 0.0f}, 22);
  ASSERT_EQ(corridor.Build(Straight(11.0f), 0.0f, kSize, 19), Status::kOk);
  EXPECT_TRUE(corridor.has_obstacle());
  EXPECT_TRUE(corridor.is_person());
  EXPECT_NEAR(corridor.obstacle_along_m(), 4.0f, 0.2f);
  // Of a map that was begun in that tick or later it is a part.
  ASSERT_EQ(corridor.Build(Straight(11.0f), 0.0f, kSize, 20), Status::kOk);
  EXPECT_FALSE(corridor.has_obstacle());
}

// Path and cells lie so that the edges of the two rows beside the path are 0.7 m and 0.9 m off it.
TEST(Corridor, HoldsANewPathAgainstTheNearerEdgeOfACell) {
  const Vec2 start = {0.1f, 0.1f};
  for (const bool along_x : {true, false}) {
    const Pose2 end = along_x ? Pose2{9.1f, 0.1f, 0.0f} : Pose2{0.1f, 9.1f, kHalfPi};
    const WorldPath path = PathOf({{start.x_m, start.y_m, end.theta_rad}, end});
    for (const float aside_m : {0.8f, -0.8f, 1.0f, -1.0f}) {
      Rig test(Straight(11.0f, 0.275f, {0.0f, 50.0f}));
      test.corridor->Advance(start, 2);
      EXPECT_FALSE(along_x ? test.Holds(4.1f, 0.1f + aside_m) : test.Holds(0.1f + aside_m, 4.1f));
      ASSERT_EQ(test.corridor->Build(path, 0.0f, kSize, 1), Status::kOk);
      EXPECT_EQ(test.corridor->has_obstacle(), std::fabs(aside_m) < 0.9f) << along_x << aside_m;
    }
  }
}

// SR-COR02
TEST(Corridor, TakesNoCellForAnotherAndForgetsInTime) {
  Rig test(Straight(11.0f));
  Corridor& corridor = *test.corridor;
  corridor.Advance({0.0f, 0.0f}, 100);
  EXPECT_FALSE(corridor.File({-10.0f, 0.0f}, false));  // behind it
  // 15.6 m on, the cell's place is that of one in front.
  corridor.Advance({15.6f, 0.0f}, 120);
  ASSERT_EQ(corridor.Build(Straight(11.0f, 0.275f, {15.6f, 0.0f}), 0.0f, kSize, 90), Status::kOk);
  EXPECT_FALSE(corridor.has_obstacle());
  // And back at the old place it still is what it was.
  corridor.Advance({-14.0f, 0.0f}, 140);
  ASSERT_EQ(corridor.Build(Straight(11.0f, 0.275f, {-14.0f, 0.0f}), 0.0f, kSize, 90), Status::kOk);
  EXPECT_TRUE(corridor.has_obstacle());
  for (uint32_t tick = 141; tick < 141 + Corridor::kMemory_ticks + 200; ++tick) {
    corridor.Advance({-14.0f, 0.0f}, tick);
  }
  ASSERT_EQ(corridor.Build(Straight(11.0f, 0.275f, {-14.0f, 0.0f}), 0.0f, kSize, 90), Status::kOk);
  EXPECT_FALSE(corridor.has_obstacle());
}

// Each tick another row of the memory is gone through: none loses what is not too old.
// SR-COR02
TEST(Corridor, RemembersEveryRowAsLongAsItPromises) {
  Rig test(Straight(11.0f, 0.275f, {0.0f, 50.0f}));
  Corridor& corridor = *test.corridor;
  const uint32_t filed = 100;
  corridor.Advance({0.0f, 0.0f}, filed);
  EXPECT_FALSE(corridor.File({4.0f, 0.0f}, false));  // not in the way of the old path
  for (uint32_t tick = filed + 1; tick <= filed + Corridor::kMemory_ticks; ++tick) {
    corridor.Advance({0.0f, 0.0f}, tick);
  }
  ASSERT_EQ(corridor.Build(Straight(11.0f), 0.0f, kSize, filed - 1), Status::kOk);
  EXPECT_TRUE(corridor.has_obstacle());
}

// As long as it may be: a cell of the coarse grid is 8 m, and the vehicle stands in the first one.
TEST(Corridor, LooksIntoTheFirstCellOfItsCoarseGrid) {
  CorridorSize size = kSize;
  size.reach_m = Corridor::kMaxReach_m;
  Rig test(Straight(11.0f));
  ASSERT_EQ(test.corridor->Build(PathOf({{0, 0, 0}, {500, 0, 0}}), 0.0f, size, 1), Status::kOk);
  EXPECT_TRUE(test.Holds(1.0f, 0.0f));
  EXPECT_FALSE(test.Holds(1.0f, 1.0f));
}

//  /\/\/\/\/\   Up and down, so that each chord reaches into most rows of the coarse grid: more
//  than
//  \/\/\/\/\/   are marked, so every chord is looked at for every return.
TEST(Corridor, OfAPathThatFillsItsCoarseGridIsTheSame) {
  constexpr float kHalf_m = 0.03f;
  WorldPath path;
  for (int i = 0; i <= 55; ++i) {
    const float y_m = i % 2 == 0 ? 0.0f : 4.0f;
    ASSERT_EQ(path.PushBack({0.1f * static_cast<float>(i), y_m, 0.0f}), Status::kOk);
  }
  const CorridorSize size = {.half_width_m = kHalf_m, .pivot_radius_m = kHalf_m, .reach_m = 230.0f};
  Rig test(path);
  Corridor& corridor = *test.corridor;
  int inside = 0;
  for (float x_m = 0.5f; x_m < 5.0f; x_m += 0.337f) {
    for (float y_m = 0.3f; y_m < 3.7f; y_m += 0.41f) {
      ASSERT_EQ(corridor.Build(path, 0.0f, size, 1), Status::kOk);
      const double off_m = DistanceTo(path, 0.0, 230.0, {x_m, y_m});
      if (std::abs(off_m - double{kHalf_m}) < 0.005) continue;
      ASSERT_EQ(corridor.File({x_m, y_m}, false), off_m < double{kHalf_m}) << x_m << " " << y_m;
      inside += off_m < double{kHalf_m} ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 20);
}

// Beside the corridor, but in a cell of the coarse grid that the only chord reaches into: each
// return there is one test. The last test that is allowed is still made.
// SR-COR03, SR-DET03
TEST(Corridor, TakesReturnsForAnObstacleOnlyOnceAllTestsOfATickAreUsedUp) {
  Rig test(PathOf({{0, 0, 0}, {10, 0, 0}}));
  Corridor& corridor = *test.corridor;
  const Vec2 beside = {5.0f, 0.8f};
  for (uint32_t tick = 2; tick < 4; ++tick) {
    corridor.Advance({0.0f, 0.0f}, tick);
    int inside = 0;
    for (int i = 0; i < Corridor::kMaxTests; ++i) inside += corridor.File(beside, true) ? 1 : 0;
    EXPECT_EQ(inside, 0);
    EXPECT_EQ(corridor.has_obstacle(), tick > 2);
    EXPECT_TRUE(corridor.File(beside, true));
    EXPECT_TRUE(corridor.has_obstacle());
    EXPECT_EQ(corridor.obstacle_along_m(), 0.0f);
    EXPECT_FALSE(corridor.is_person());
  }
}

TEST(Corridor, WorksFarFromTheOriginAndBelowZero) {
  const Vec2 far = {-2000.0f, -3000.0f};
  Rig test(Straight(11.0f, 0.25f, far));
  Corridor& corridor = *test.corridor;
  EXPECT_TRUE(test.Holds(far.x_m + 5.0f, far.y_m + 0.72f));
  EXPECT_FALSE(test.Holds(far.x_m + 5.0f, far.y_m + 0.76f));
  corridor.Advance(far, 3);
  EXPECT_TRUE(test.Holds(far.x_m + 4.0f, far.y_m));
  ASSERT_EQ(corridor.Build(Straight(11.0f, 0.25f, far), 0.0f, kSize, 2), Status::kOk);
  ASSERT_TRUE(corridor.has_obstacle());
  EXPECT_NEAR(corridor.obstacle_along_m(), 4.0f, 0.3f);
  corridor.Advance({kNaN, 0.0f}, 4);  // changes nothing
  EXPECT_TRUE(corridor.has_obstacle());
}

// The counter of the ticks wraps within the memory's words.
TEST(Corridor, RemembersAcrossTheWrapOfTheTick) {
  for (const uint32_t tick : {0xfffffu, 0x100000u, 0xffffffffu, 0u}) {
    Rig test(Straight(11.0f));
    Corridor& corridor = *test.corridor;
    corridor.Advance({0.05f, 0.05f}, tick);
    EXPECT_TRUE(test.Holds(4.0f, 0.0f));
    corridor.Advance({0.05f, 0.05f}, tick + 5u);
    ASSERT_EQ(corridor.Build(Straight(11.0f), 0.0f, kSize, tick - 1u), Status::kOk);
    EXPECT_TRUE(corridor.has_obstacle()) << tick;
    ASSERT_EQ(corridor.Build(Straight(11.0f), 0.0f, kSize, tick), Status::kOk);
    EXPECT_FALSE(corridor.has_obstacle()) << tick;
  }
}

//   [>]------- gap ------|x|
// SR-COR01
TEST(Corridor, SaysWhenToBrakeAndWhenLimitsDoNotDo) {
  const SpeedParams speed;
  const VehicleParams vehicle;
  Rig test(Straight(11.8f));
  const auto ahead = [&](float along_m, float v, float told) {
    return test.corridor->Ahead(speed, vehicle, along_m, v, told);
  };
  EXPECT_EQ(ahead(0.0f, 5.0f, 5.0f), WayAhead::kClear);
  EXPECT_EQ(ahead(0.0f, kNaN, 5.0f), WayAhead::kClear);
  ASSERT_TRUE(test.Holds(10.0f, 0.0f));
  const float gap_m = 10.0f - 0.5f * vehicle.length_m;
  const float cap_mps = ReactionSpeedCap(speed, gap_m);
  EXPECT_EQ(ahead(0.0f, 0.99f * cap_mps, 0.99f * cap_mps), WayAhead::kClear);
  EXPECT_EQ(ahead(0.0f, 1.01f * cap_mps, 1.01f * cap_mps), WayAhead::kObstacle);
  EXPECT_EQ(ahead(0.0f, 5.0f, 5.0f), WayAhead::kTooNear);
  EXPECT_EQ(ahead(9.0f, 1.0f, 1.0f), WayAhead::kTooNear);
  EXPECT_EQ(ahead(9.25f, 0.0f, 0.0f), WayAhead::kTooNear);  // it stands at it
  EXPECT_EQ(ahead(8.0f, 0.0f, 0.0f), WayAhead::kClear);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(ahead(bad, 1.0f, 1.0f), WayAhead::kTooNear);
    EXPECT_EQ(ahead(0.0f, bad, 1.0f), WayAhead::kTooNear);
    EXPECT_EQ(ahead(0.0f, 1.0f, bad), WayAhead::kTooNear);
  }
}

// In reverse the gap begins at the rear.
// SR-STA05
TEST(Corridor, InReverseTheRearGoesFirst) {
  const SpeedParams speed;
  VehicleParams vehicle;
  vehicle.axle_offset_m = 0.4f;
  Rig test(Straight(11.8f));
  ASSERT_TRUE(test.Holds(5.0f, 0.0f));
  const float half_m = 0.5f * vehicle.length_m;
  const auto nearest = [&](bool reverse) {
    float along_m = 0.0f;
    while (test.corridor->Ahead(speed, vehicle, along_m, 0.0f, 0.0f, reverse) !=
           WayAhead::kTooNear) {
      along_m += 0.01f;
    }
    return along_m;
  };
  EXPECT_NEAR(nearest(false), 5.0f - (half_m - 0.4f), 0.02f);
  EXPECT_NEAR(nearest(true), 5.0f - (half_m + 0.4f), 0.02f);
}

// A vehicle that brakes along the path when it is told to, with dead time and lag, is not told in
// the middle of it that this does not do; and it stands before the return.
// SR-COR01
TEST(Corridor, BrakesOnceAndStandsBeforeIt) {
  const SpeedParams speed;
  const VehicleParams vehicle;
  const float dt = 0.01f;
  for (const float start_mps : {1.0f, 3.0f, 5.0f}) {
    Rig test(Straight(30.0f));
    ASSERT_TRUE(test.Holds(11.9f, 0.0f));
    const float front_m = 11.9f - 0.5f * vehicle.length_m;
    float x_m = front_m - StoppingDistance(speed, start_mps) - 0.05f;
    float v = start_mps;
    float told = start_mps;
    std::vector<float> sent(20, start_mps);  // on its way through the dead time
    for (int tick = 0; tick < 2000; ++tick) {
      const WayAhead ahead = test.corridor->Ahead(speed, vehicle, x_m, v, told);
      ASSERT_NE(ahead, WayAhead::kTooNear) << "at " << front_m - x_m << " with " << v;
      if (ahead != WayAhead::kClear || told < start_mps) {
        told = std::max(0.0f, told - speed.max_deceleration_mps2 * dt);
      }
      sent.push_back(told);
      v += (sent[sent.size() - 20] - v) / speed.stopping_lag_s * dt;
      x_m += v * dt;
    }
    EXPECT_LT(x_m, front_m);
    EXPECT_LT(v, 0.01f);
  }
}

}  // namespace
}  // namespace hardpack
