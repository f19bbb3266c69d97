// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/prediction_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kAhead_ns = 150'000'000;

struct Bench {
  PredictionError error;
  uint64_t now_ns = 1'000'000'000;

  // What is said of the body one dead time ahead, and what is measured now.
  void Tick(float said_mps, float said_radps, const BodyMotion& body) {
    now_ns += kTick_ns;
    DriveState predicted;
    predicted.speed_mps = said_mps;
    predicted.yaw_rate_radps = said_radps;
    error.Advance(now_ns, kAhead_ns, predicted, body);
  }
};

// A speed that grows by 2 m/s^2 and a turn that grows by 1 rad/s^2: of a vehicle that does all of
// it 0.1 s later than the model says, and of one that does what it says.
// SR-MOV04
TEST(PredictionError, IsWhatALaterVehicleHasNotDoneYet) {
  for (const float late_s : {0.0f, 0.1f}) {
    Bench bench;
    for (int i = 0; i < 200; ++i) {
      const float now_s = 0.01f * static_cast<float>(i);
      const float then_s = now_s + 0.15f;
      const float real_s = std::fmax(0.0f, now_s - late_s);
      bench.Tick(2.0f * then_s, then_s, {true, 2.0f * real_s, real_s});
    }
    EXPECT_NEAR(bench.error.lately().speed_mps, 2.0f * late_s, 0.025f) << late_s;
    EXPECT_NEAR(bench.error.lately().yaw_rate_radps, late_s, 0.015f) << late_s;
  }
}

// SR-MOV04
TEST(PredictionError, TheLargestCountsAndFadesInTenSeconds) {
  Bench bench;
  for (int i = 0; i < 100; ++i) bench.Tick(1.0f, 0.0f, {true, 1.0f, 0.0f});
  bench.Tick(1.0f, 0.0f, {true, 0.5f, -0.3f});
  EXPECT_NEAR(bench.error.lately().speed_mps, 0.5f, 1e-6f);
  EXPECT_NEAR(bench.error.lately().yaw_rate_radps, 0.3f, 1e-6f);
  for (int i = 0; i < 1000; ++i) bench.Tick(1.0f, 0.0f, {true, 1.0f, 0.0f});
  EXPECT_NEAR(bench.error.lately().speed_mps, 0.5f / std::exp(1.0f), 0.01f);
  EXPECT_NEAR(bench.error.lately().yaw_rate_radps, 0.3f / std::exp(1.0f), 0.01f);
}

TEST(PredictionError, WhatIsNotMeasuredOrComesAgainSaysNothing) {
  Bench bench;
  for (int i = 0; i < 100; ++i) bench.Tick(1.0f, 0.0f, {true, 1.0f, 0.0f});
  for (int i = 0; i < 100; ++i) bench.Tick(1.0f, 0.0f, {false, 9.0f, 9.0f});
  bench.error.Advance(bench.now_ns, kAhead_ns, {}, {true, 9.0f, 9.0f});
  bench.error.Advance(bench.now_ns - kTick_ns, kAhead_ns, {}, {true, 9.0f, 9.0f});
  EXPECT_EQ(bench.error.lately().speed_mps, 0.0f);
  EXPECT_EQ(bench.error.lately().yaw_rate_radps, 0.0f);
  bench.Tick(1.0f, 0.0f, {true, 9.0f, 9.0f});
  EXPECT_GT(bench.error.lately().speed_mps, 7.0f);
  bench.error.Reset();
  EXPECT_EQ(bench.error.lately().speed_mps, 0.0f);
}

// With nothing due for a second the oldest is forgotten; what is kept is compared with its time.
TEST(PredictionError, MoreThanItRemembersOverwritesTheOldest) {
  PredictionError error;
  uint64_t now_ns = 0;
  for (int i = 0; i < 3 * PredictionError::kHistory; ++i) {
    now_ns += kTick_ns;
    error.Advance(now_ns, 1'000'000'000, {}, {true, 9.0f, 9.0f});
  }
  EXPECT_EQ(error.lately().speed_mps, 0.0f) << "none was ever due";
  error.Advance(now_ns + 2'000'000'000, 0, {}, {true, 0.5f, 0.0f});
  EXPECT_NEAR(error.lately().speed_mps, 0.5f, 1e-6f);
}

}  // namespace
}  // namespace hardpack
