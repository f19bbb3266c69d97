// SPDX-License-Identifier: Apache-2.0
#include "core/path/path_smoother.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hardpack {
namespace {

//            ____
//   ____ ___/        a step of one cell, as A* makes them
WorldPath Staircase() {
  WorldPath path;
  for (int i = 0; i < 60; ++i) {
    const float x_m = 0.25f * static_cast<float>(i);
    EXPECT_EQ(path.PushBack({x_m, i < 30 ? 0.0f : 0.2f, 0.0f}), Status::kOk);
  }
  SetHeadingsFromChords(path);
  return path;
}

float LargestTurn(const WorldPath& path) {
  float largest_rad = 0.0f;
  for (int i = 1; i + 1 < path.size(); ++i) {
    largest_rad = std::max(largest_rad, std::abs(path[i].theta_rad - path[i - 1].theta_rad));
  }
  return largest_rad;
}

WorldPath Smoothed(const WorldPath& path, int passes, int units_at_once) {
  PathSmoother smoother;
  EXPECT_EQ(smoother.Begin(path, passes), Status::kOk);
  for (int step = 0; step <= passes; ++step) {
    if (smoother.Step(units_at_once) == Progress::kDone) return smoother.result();
  }
  ADD_FAILURE() << "more units than passes";
  return path;
}

void ExpectSame(const WorldPath& a, const WorldPath& b) {
  ASSERT_EQ(a.size(), b.size());
  for (int i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].x_m, b[i].x_m);
    EXPECT_EQ(a[i].y_m, b[i].y_m);
    EXPECT_EQ(a[i].theta_rad, b[i].theta_rad);
  }
}

TEST(PathSmoother, SpreadsAStepOfOneCell) {
  const WorldPath path = Staircase();
  const WorldPath smooth = Smoothed(path, 40, 40);
  EXPECT_LT(LargestTurn(smooth), 0.1f * LargestTurn(path));
}

TEST(PathSmoother, KeepsEndsAndMovesNoPointFar) {
  const WorldPath path = Staircase();
  const WorldPath smooth = Smoothed(path, 40, 40);
  ASSERT_EQ(smooth.size(), path.size());
  EXPECT_EQ(smooth[0].y_m, path[0].y_m);
  EXPECT_EQ(smooth.back().x_m, path.back().x_m);
  EXPECT_EQ(smooth.back().y_m, path.back().y_m);
  for (int i = 0; i < path.size(); ++i) {
    EXPECT_NEAR(smooth[i].y_m, path[i].y_m, 0.11f) << "point " << i;
  }
}

TEST(PathSmoother, LeavesAStraightLineStraight) {
  WorldPath line;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(line.PushBack({0.25f * static_cast<float>(i), 1.0f, 0.0f}), Status::kOk);
  }
  ExpectSame(Smoothed(line, 100, 7), line);
}

TEST(PathSmoother, DoesNothingInNoPasses) {
  ExpectSame(Smoothed(Staircase(), 0, 1), Staircase());
}

TEST(PathSmoother, GivesTheSameInAnySplitOfUnits) {
  const WorldPath path = Staircase();
  ExpectSame(Smoothed(path, 40, 1), Smoothed(path, 40, 40));
}

TEST(PathSmoother, RefusesWhatItCannotSmooth) {
  PathSmoother smoother;
  WorldPath path;
  EXPECT_EQ(smoother.Begin(path, 1), Status::kPathTooShort);
  path = Staircase();
  EXPECT_EQ(smoother.Begin(path, -1), Status::kParameterOutOfRange);
  EXPECT_EQ(smoother.Begin(path, PathSmoother::kMaxPasses + 1), Status::kParameterOutOfRange);
  EXPECT_EQ(smoother.Step(1), Progress::kDone);
}

}  // namespace
}  // namespace hardpack
