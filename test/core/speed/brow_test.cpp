// SPDX-License-Identifier: Apache-2.0
#include "core/speed/brow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "test/core/costmap/ground_of_heights.h"

namespace hardpack {
namespace {

using Ground = testing::GroundOfHeights;

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
constexpr float kClimb = 0.15f;
constexpr Vec2 kAlongX = {kClimb, 0.0f};
constexpr double kTop_m = 5.0;
constexpr float kMaxUnseen_m = 0.6f;

// From x = -3, straight on along x.
WorldPath Straight(float length_m, float heading_rad = 0.0f) {
  WorldPath path;
  for (float at_m = 0.0f; at_m <= length_m; at_m += 0.25f) {
    EXPECT_EQ(path.PushBack({-3.0f + at_m, 0.1f, heading_rad}), Status::kOk);
  }
  return path;
}

// On a track beside the path; the other ones lie on the path itself.
Brow Find(const Ground& ground, const WorldPath& path, float aside_m = 0.0f, Vec2 climb = kAlongX) {
  std::vector<float> x_m;
  std::vector<float> y_m;
  std::vector<float> along_m;
  bool reversed[kMaxPathPoints] = {};
  for (int k = 0; k < path.size(); ++k) {
    x_m.push_back(path[k].x_m);
    y_m.push_back(path[k].y_m);
    const Vec2 step_m =
        k == 0 ? Vec2{} : Vec2{path[k].x_m - path[k - 1].x_m, path[k].y_m - path[k - 1].y_m};
    along_m.push_back(k == 0 ? 0.0f : along_m.back() + std::hypot(step_m.x_m, step_m.y_m));
    if (k > 0) {
      reversed[k - 1] =
          step_m.x_m * std::cos(path[k].theta_rad) + step_m.y_m * std::sin(path[k].theta_rad) <
          -1e-3f;
    }
  }
  const PathChords chords = {x_m.data(), y_m.data(), along_m.data(), reversed, path.size()};
  const float asides_m[BrowFinder::kTracks] = {0.0f, 0.0f, 0.0f, 0.0f, aside_m};
  BrowFinder finder;
  finder.Begin(climb, kMaxUnseen_m);
  int units = 0;
  while (!finder.is_done()) {
    finder.Step(ground.map(), ground.terrain(), chords, asides_m);
    EXPECT_LE(++units, BrowFinder::kMaxUnits);
  }
  return finder.brow(BrowFinder::kTracks - 1);
}

// Up to kTop_m; behind it, up to `again_m`, unseen, then on with `slope`.
Ground Hill(double again_m, double slope) {
  return Ground([=](double x_m, double /*y_m*/) {
    if (x_m < kTop_m) return double{kClimb} * x_m;
    return x_m < again_m ? kUnseen : double{kClimb} * kTop_m + slope * (x_m - kTop_m);
  });
}

// SR-SPD09
TEST(Brow, IsWhereAClimbEndsAndNothingIsSeenBehindIt) {
  const Brow brow = Find(Hill(100.0, 0.0), Straight(16.0f));
  EXPECT_NEAR(brow.from_m, 8.0f, 0.25f);
  EXPECT_EQ(brow.to_m, Brow::kFar_m);
  EXPECT_FALSE(brow.Hides(7.0f));
  EXPECT_TRUE(brow.Hides(9.0f));
}

TEST(Brow, LeadsToWhereTheGroundIsSeenAgain) {
  for (const double slope : {-0.3, -0.1, 0.0}) {
    const Brow brow = Find(Hill(7.0, slope), Straight(16.0f));
    EXPECT_NEAR(brow.from_m, 8.0f, 0.25f) << slope;
    EXPECT_NEAR(brow.to_m, 10.0f, 0.65f) << slope;  // a plane is told of three rows
  }
}

// The far edge of a ditch is as high as the slope that leads to it.
// SR-SPD09
TEST(Brow, ADitchAcrossASlopeIsNone) {
  for (const double wide_m : {0.9, 1.5, 3.0}) {
    const Brow brow = Find(Hill(kTop_m + wide_m, double{kClimb}), Straight(16.0f));
    EXPECT_FALSE(brow.Hides(8.5f)) << wide_m;
  }
}

// A ditch down a slope, and a way along the side of it: it rises nowhere.
// SR-SPD09
TEST(Brow, ADitchDownASlopeIsNone) {
  const Ground ground([](double x_m, double y_m) {
    return y_m > 1.0 && y_m < 2.5 ? kUnseen : double{kClimb} * x_m;
  });
  for (const float heading_rad : {0.5f, 1.0f, 1.5707963f}) {
    WorldPath path;
    for (float at_m = 0.0f; at_m <= 10.0f; at_m += 0.25f) {
      const Pose2 pose = {at_m * std::cos(heading_rad), -2.0f + at_m * std::sin(heading_rad),
                          heading_rad};
      ASSERT_EQ(path.PushBack(pose), Status::kOk);
    }
    EXPECT_EQ(Find(ground, path).from_m, Brow::kFar_m) << heading_rad;
  }
}

// Along the top for 3 m, and then down, with a turn on the spot between.
// SR-SPD09
TEST(Brow, IsFoundBehindATurnOnTheSpot) {
  WorldPath path;
  for (float y_m = -2.9f; y_m < 0.2f; y_m += 0.25f) {
    ASSERT_EQ(path.PushBack({4.5f, y_m, 1.5707963f}), Status::kOk);
  }
  const float turns_m = path[path.size() - 1].y_m + 2.9f;
  for (float on_m = 0.0f; on_m <= 8.0f; on_m += 0.25f) {
    ASSERT_EQ(path.PushBack({4.5f + on_m, path[12].y_m, 0.0f}), Status::kOk);
  }
  const Brow brow = Find(Hill(7.0, -0.1), path);
  EXPECT_NEAR(brow.from_m, turns_m + 0.5f, 0.25f);
  EXPECT_NEAR(brow.to_m, turns_m + 2.5f, 0.65f);
}

// SR-SPD09
TEST(Brow, ADitchBehindOneIsNotHidden) {
  const Ground ground([](double x_m, double /*y_m*/) {
    if (x_m < 1.0) return double{kClimb} * x_m;
    if (x_m < 2.5 || (x_m > 5.0 && x_m < 6.5)) return kUnseen;
    return x_m <= 5.0 ? double{kClimb} : double{kClimb} * (1.0 + x_m - 5.0);
  });
  const Brow brow = Find(ground, Straight(16.0f));
  EXPECT_TRUE(brow.Hides(4.5f)) << "the level top is less steep than the climb";
  EXPECT_FALSE(brow.Hides(8.6f)) << "what is behind it is as steep";
}

TEST(Brow, WhatIsShortIsNone) {
  EXPECT_EQ(Find(Hill(kTop_m + 0.4, 0.0), Straight(16.0f)).from_m, Brow::kFar_m) << "a bridged gap";
  EXPECT_EQ(Find(Hill(100.0, 0.0), Straight(11.0f)).from_m, Brow::kFar_m)
      << "the path ends 3 m behind what is seen: a ditch may be there";
}

TEST(Brow, OnATrackBesideThePathItIsWhereThatTrackPassesIt) {
  const Ground ground(
      [](double x_m, double y_m) { return x_m + y_m < kTop_m ? double{kClimb} * x_m : kUnseen; });
  EXPECT_NEAR(Find(ground, Straight(16.0f), 1.0f).from_m, 7.0f, 0.35f);
  EXPECT_NEAR(Find(ground, Straight(16.0f), 3.0f).from_m, 5.0f, 0.35f);
}

TEST(Brow, WithoutAClimbThereIsNone) {
  EXPECT_EQ(Find(Hill(100.0, 0.0), Straight(16.0f), 0.0f, {}).from_m, Brow::kFar_m);
}

TEST(Brow, InReverseThereIsNone) {
  const WorldPath path = Straight(16.0f, 3.1415927f);
  EXPECT_EQ(Find(Hill(100.0, 0.0), path).from_m, Brow::kFar_m);
}

TEST(Brow, WithoutAPathThereIsNone) {
  EXPECT_EQ(Find(Hill(100.0, 0.0), WorldPath()).from_m, Brow::kFar_m);
  EXPECT_EQ(Find(Hill(100.0, 0.0), Straight(0.0f)).from_m, Brow::kFar_m);
}

}  // namespace
}  // namespace hardpack
