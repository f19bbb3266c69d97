// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/tracking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hardpack {
namespace {

constexpr float kTick_s = 0.01f;
constexpr float kRim_m = 0.30f * 0.962f;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Tracker MakeTracker(const VehicleParams& vehicle = {}) {
  Tracker tracker;
  EXPECT_EQ(tracker.Configure(vehicle, {}, {}, {}), Status::kOk);
  return tracker;
}

TrackingInput Aim(float x_m, float y_m, float limit_mps) {
  TrackingInput input;
  input.aim.pose = {x_m, y_m, 0.0f};
  input.speed_limit_mps = limit_mps;
  return input;
}

TEST(Tracker, SpeedsUpAndSlowsDownWithinThePlansLimits) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  for (int i = 1; i <= 50; ++i) {
    ASSERT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 5.0f), kTick_s, output), Status::kOk);
    ASSERT_NEAR(output.speed_mps, 2.0f * kTick_s * static_cast<float>(i), 1e-4f);
  }
  ASSERT_EQ(tracker.StopAlong(Aim(2.0f, 0.0f, 5.0f), kTick_s, output), Status::kOk);
  EXPECT_NEAR(output.speed_mps, 1.0f - 2.0f * kTick_s, 1e-4f);
  EXPECT_NEAR(output.wheels.left_radps, output.speed_mps / kRim_m, 1e-4f);
  EXPECT_EQ(output.wheels.left_radps, output.wheels.right_radps);
}

//   aim at (x, y):  the arc through it has curvature 2 y / (x^2 + y^2)
TEST(Tracker, AimsAlongTheArcThroughThePoint) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  TrackingInput input = Aim(2.0f, 0.5f, 1.0f);
  for (int i = 0; i < 60; ++i) ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
  EXPECT_NEAR(output.curvature_per_m, 2.0f * 0.5f / 4.25f, 1e-5f);
  EXPECT_NEAR(output.yaw_rate_radps, output.curvature_per_m * 1.0f, 1e-4f);
  const float difference_radps = output.wheels.right_radps - output.wheels.left_radps;
  EXPECT_NEAR(difference_radps, output.yaw_rate_radps * 1.87f / kRim_m, 1e-3f);
  input.aim.pose.y_m = -0.5f;
  ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
  EXPECT_LT(output.yaw_rate_radps, 0.0f);
}

TEST(Tracker, ComesBackToALineFromBesideIt) {
  Tracker tracker = MakeTracker();
  Pose2 pose = {0.0f, 0.8f, 0.3f};
  TrackingOutput output;
  for (int i = 0; i < 1500; ++i) {
    TrackingInput input = Aim(pose.x_m + 1.5f, 0.0f, 2.0f);
    input.pose = pose;
    ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
    pose.theta_rad += output.yaw_rate_radps * kTick_s;
    pose.x_m += output.speed_mps * kTick_s * std::cos(pose.theta_rad);
    pose.y_m += output.speed_mps * kTick_s * std::sin(pose.theta_rad);
  }
  EXPECT_NEAR(pose.y_m, 0.0f, 0.02f);
  EXPECT_NEAR(pose.theta_rad, 0.0f, 0.02f);
}

TEST(Tracker, KeepsTheTurnAndGivesUpSpeedWhenAWheelWouldBeTooFast) {
  VehicleParams slow;
  slow.max_wheel_speed_radps = 4.0f;
  Tracker tracker = MakeTracker(slow);
  TrackingOutput output;
  const TrackingInput input = Aim(1.0f, 0.6f, 5.0f);
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
    ASSERT_LE(std::fabs(output.wheels.left_radps), 4.0f);
    ASSERT_LE(std::fabs(output.wheels.right_radps), 4.0f);
  }
  EXPECT_GT(output.wheels.right_radps, output.wheels.left_radps);
  EXPECT_GT(output.yaw_rate_radps, 0.5f);
}

TEST(Tracker, TurnsOnTheSpotTheShortWayRound) {
  Tracker tracker = MakeTracker();
  TrackingInput input;
  input.turn = true;
  input.speed_limit_mps = 1.0f;
  input.pose.theta_rad = 3.0f;
  input.aim.pose.theta_rad = -3.0f;  // 0.28 rad to the left
  TrackingOutput output;
  ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
  EXPECT_EQ(output.speed_mps, 0.0f);
  EXPECT_GT(output.wheels.right_radps, 0.0f);
  EXPECT_EQ(output.wheels.left_radps, -output.wheels.right_radps);
  // Also where the path says 0: at its end, say.
  for (const float limit_mps : {1.0f, 0.0f}) {
    input.speed_limit_mps = limit_mps;
    ASSERT_EQ(tracker.StopAlong(input, kTick_s, output), Status::kOk);
    EXPECT_EQ(output.wheels.right_radps, 0.0f);
    EXPECT_EQ(output.yaw_rate_radps, 0.0f);
  }
}

TEST(Tracker, DoesNotAimBehindItself) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  ASSERT_EQ(tracker.Follow(Aim(-1.0f, 0.3f, 1.0f), kTick_s, output), Status::kOk);
  EXPECT_EQ(output.yaw_rate_radps, 0.0f);
}

TEST(Tracker, CommandsZeroForWhatIsNoNumber) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 2.0f), kTick_s, output), Status::kOk);
  }
  EXPECT_EQ(tracker.Follow(Aim(kNan, 0.0f, 2.0f), kTick_s, output), Status::kNotFinite);
  EXPECT_EQ(output.wheels.left_radps, 0.0f);
  EXPECT_EQ(output.speed_mps, 0.0f);
  EXPECT_EQ(tracker.Follow(Aim(2.0f, 0.0f, kNan), kTick_s, output), Status::kNotFinite);
  EXPECT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 2.0f), 0.0f, output), Status::kNotFinite);
}

TEST(Tracker, ZeroIsAtOnce) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(tracker.Follow(Aim(2.0f, 0.2f, 2.0f), kTick_s, output), Status::kOk);
  }
  tracker.Zero(output);
  EXPECT_EQ(output.wheels.left_radps, 0.0f);
  EXPECT_EQ(output.wheels.right_radps, 0.0f);
  EXPECT_EQ(tracker.speed_mps(), 0.0f);
}

TEST(Tracker, RefusesParametersOutOfRangeAndDoesNothingWithoutAny) {
  Tracker tracker;
  TrackingOutput output;
  EXPECT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 2.0f), kTick_s, output), Status::kNotStarted);
  EXPECT_EQ(tracker.Configure({}, {}, {}, {.lookahead_s = -1.0f}), Status::kParameterOutOfRange);
}

}  // namespace
}  // namespace hardpack
