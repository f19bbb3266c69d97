// SPDX-License-Identifier: Apache-2.0
#include "core/safety/ground_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hardpack {
namespace {

constexpr float kStep_m = 0.002f;

// The tilt of a body whose wheel of 0.3 m rolls over an edge, by the way of its axle beyond it.
float TiltBeyond(float way_m) {
  const float x_m = std::fmin(std::fmax(way_m, 0.0f), 0.3f);
  return 0.3f - std::sqrt(0.09f - x_m * x_m);
}

// How far beyond an edge a wheel's axle gets before it is told; `sign` of the tilt.
float ToldBeyond(float sign, bool is_roll, float level_rad) {
  GroundWatch watch;
  for (int step = -2000; step < 1000; ++step) {
    const float beyond_m = kStep_m * static_cast<float>(step);
    const float tilt_rad = level_rad + sign * TiltBeyond(beyond_m);
    const float driven_m = 100.0f + kStep_m * static_cast<float>(step + 2000);
    const bool drops =
        watch.Judge(is_roll ? 0.01f : tilt_rad, is_roll ? tilt_rad : -0.02f, 0.7f, driven_m);
    if (drops) return beyond_m;
  }
  return 1.0f;
}

// SR-SPD07
TEST(GroundWatch, TellsOfAWheelThatDropsWithinHalfItsRadius) {
  for (const float sign : {-1.0f, 1.0f}) {
    for (const bool is_roll : {false, true}) {
      for (const float level_rad : {0.0f, 0.2f, -0.15f}) {
        const float told_m = ToldBeyond(sign, is_roll, level_rad);
        EXPECT_GT(told_m, 0.05f);
        EXPECT_LE(told_m, 0.16f);
      }
    }
  }
}

// The front wheels of a Warthog (0.92 m from the rear ones) roll over the edge of a slope: the body
// tilts until the rear ones are over it, too.
// SR-SPD09
TEST(GroundWatch, ASlopeBehindAnEdgeIsNone) {
  constexpr float kWheelbase_m = 0.92f;
  for (const float step_m : {kStep_m, 0.007f, 0.02f, 0.05f}) {
    for (const float slope : {0.1f, -0.1f, 0.32f, -0.32f}) {
      GroundWatch watch;
      for (int step = 0; step_m * static_cast<float>(step) < 4.0f; ++step) {
        const float driven_m = step_m * static_cast<float>(step);
        const float beyond_m = std::fmin(std::fmax(driven_m - 1.0f, 0.0f), kWheelbase_m);
        const float tilt_rad = std::atan(slope * beyond_m / kWheelbase_m);
        EXPECT_FALSE(watch.Judge(tilt_rad, 0.02f, -2.0f, driven_m)) << slope << " at " << driven_m;
      }
    }
  }
}

// A slope of 0.25 that rises along x: what was pitch becomes roll.
TEST(GroundWatch, ATurnOnASlopeIsNone) {
  for (const float direction : {-1.0f, 1.0f}) {
    GroundWatch watch;
    for (int step = 0; step < 1000; ++step) {
      const float yaw_rad = direction * 0.003f * static_cast<float>(step);
      const float driven_m = 0.1f * kStep_m * static_cast<float>(step);
      const float pitch_rad = -0.25f * std::cos(yaw_rad);
      const float roll_rad = -0.25f * std::sin(yaw_rad);
      EXPECT_FALSE(watch.Judge(pitch_rad, roll_rad, yaw_rad, driven_m)) << step;
    }
  }
}

TEST(GroundWatch, ATiltThatCameWhileItWasNotWatchedIsNone) {
  GroundWatch watch;
  EXPECT_FALSE(watch.Judge(0.0f, 0.0f, 0.0f, 1.0f));
  EXPECT_TRUE(watch.Judge(0.1f, 0.0f, 0.0f, 1.05f));
  watch.Reset();
  EXPECT_FALSE(watch.Judge(0.1f, 0.0f, 0.0f, 1.1f));
}

TEST(GroundWatch, WhatIsNotANumberIsADrop) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  GroundWatch watch;
  EXPECT_FALSE(watch.Judge(0.0f, 0.0f, 0.0f, 1.0f));
  EXPECT_TRUE(watch.Judge(nan, 0.0f, 0.0f, 1.0f));
  EXPECT_TRUE(watch.Judge(0.0f, nan, 0.0f, 1.0f));
  watch.Reset();
  EXPECT_TRUE(watch.Judge(nan, 0.0f, 0.0f, 1.0f));
}

}  // namespace
}  // namespace hardpack
