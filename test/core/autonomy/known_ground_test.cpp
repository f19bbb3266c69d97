// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/known_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

namespace hardpack {
namespace {

constexpr float kLidar_m = 1.1f;

using Height = std::function<double(double x_m, double y_m)>;

// Ground as far as 15 m around the origin, where `height` is a number.
std::unique_ptr<HeightGrid> Ground(const Height& height) {
  auto grid = std::make_unique<HeightGrid>();
  for (double x_m = -15.0; x_m < 15.0; x_m += 0.1) {
    for (double y_m = -15.0; y_m < 15.0; y_m += 0.1) {
      const auto z_m = static_cast<float>(height(x_m, y_m));
      if (!std::isfinite(z_m)) continue;
      EXPECT_EQ(grid->Insert({static_cast<float>(x_m), static_cast<float>(y_m), z_m},
                             ReturnClass::kGround),
                Status::kOk);
    }
  }
  return grid;
}

// Of a vehicle that stands on a plane that rises by `slope` along its heading, at the origin.
float FallOn(const HeightGrid& grid, double slope, double yaw_rad, Vec2 direction = {1.0f, 0.0f}) {
  const Transform3 pose = TransformFromRollPitchYaw(0.0f, static_cast<float>(-std::atan(slope)),
                                                    static_cast<float>(yaw_rad), {});
  return LeastFallToKnown(grid, pose, {0.0f, 0.0f, kLidar_m}, direction);
}

// As on level ground, whatever the plane and the heading.
TEST(KnownGround, OnAPlaneAllBeamsThatFallMeetItWithinReach) {
  for (const double slope : {0.0, 0.2, -0.2}) {
    for (const double yaw_rad : {0.0, 0.7, 3.0}) {
      const auto grid = Ground([&](double x_m, double y_m) {
        return slope * (std::cos(yaw_rad) * x_m + std::sin(yaw_rad) * y_m);
      });
      for (const double aside_rad : {0.0, 1.0, 2.5}) {
        const Vec2 direction = {static_cast<float>(std::cos(aside_rad)),
                                static_cast<float>(std::sin(aside_rad))};
        EXPECT_NEAR(FallOn(*grid, slope, yaw_rad, direction), kLidar_m / 10.0, 0.012)
            << slope << ' ' << yaw_rad << ' ' << aside_rad;
      }
    }
  }
}

TEST(KnownGround, WhatIsNotKnownIsNotMet) {
  const auto grid = Ground([](double x_m, double) { return x_m < 5.0 ? 0.0 : NAN; });
  EXPECT_NEAR(FallOn(*grid, 0.0, 0.0), kLidar_m / 4.9, 0.02);
  EXPECT_NEAR(FallOn(*grid, 0.0, 0.0, {-1.0f, 0.0f}), kLidar_m / 10.0, 0.012);
  const HeightGrid empty;
  EXPECT_EQ(FallOn(empty, 0.0, 0.0), kNoFall);
}

// A slope of 15 degrees begins 3 m ahead: only what falls more steeply than it, and gets there.
TEST(KnownGround, BehindAnEdgeOnlyTheSteepBeamsMeetTheGround) {
  const double down = std::tan(0.26);
  const auto grid =
      Ground([&](double x_m, double) { return x_m < 3.0 ? 0.0 : down * (3.0 - x_m); });
  EXPECT_NEAR(FallOn(*grid, 0.0, 0.0), (kLidar_m + 7.0 * down) / 10.0, 0.015);
}

TEST(KnownGround, WhatStandsOnTheGroundIsMet) {
  const auto grid = Ground([](double x_m, double) { return x_m < 4.0 ? 0.0 : NAN; });
  for (float y_m = -1.0f; y_m < 1.0f; y_m += 0.1f) {
    ASSERT_EQ(grid->Insert({8.05f, y_m, 0.3f}, ReturnClass::kHard), Status::kOk);
    ASSERT_EQ(grid->Insert({8.05f, y_m, 0.7f}, ReturnClass::kHard), Status::kOk);
  }
  EXPECT_NEAR(FallOn(*grid, 0.0, 0.0), (kLidar_m - 0.7) / 8.0, 0.01);
}

TEST(KnownGround, AVehicleOnItsSideSeesNoGround) {
  const auto grid = Ground([](double, double) { return 0.0; });
  const Transform3 pose = TransformFromRollPitchYaw(0.0f, 1.57f, 0.0f, {});
  EXPECT_EQ(LeastFallToKnown(*grid, pose, {0.0f, 0.0f, kLidar_m}, {1.0f, 0.0f}), kNoFall);
}

}  // namespace
}  // namespace hardpack
