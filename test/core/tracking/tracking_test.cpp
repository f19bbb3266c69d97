// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/tracking.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/base/math.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

constexpr float kTick_s = 0.01f;
constexpr float kRim_m = 0.30f * 0.962f;
using testing::kNaN;

// Pure pursuit.
Tracker MakeTracker(const VehicleParams& vehicle = {}) {
  Tracker tracker;
  EXPECT_EQ(tracker.Configure(vehicle, {}, {}, {}, {.method = TrackingParams::kPurePursuit}),
            Status::kOk);
  return tracker;
}

TrackingInput Aim(float x_m, float y_m, float limit_mps) {
  TrackingInput input;
  input.aim.pose = {x_m, y_m, 0.0f};
  input.speed_limit_mps = limit_mps;
  return input;
}

TEST(PurePursuit, SpeedsUpAndSlowsDownWithinThePlansLimits) {
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
TEST(PurePursuit, AimsAlongTheArcThroughThePoint) {
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

TEST(PurePursuit, ComesBackToALineFromBesideIt) {
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

// By either method.
// SR-STA06
TEST(Tracker, DrivesTheOtherWayOnlyOnceItsReferenceIsZero) {
  for (const auto method : {TrackingParams::kPurePursuit, TrackingParams{}.method}) {
    for (const bool reverse : {false, true}) {
      Tracker tracker;
      ASSERT_EQ(tracker.Configure({}, {}, {}, {}, {.method = method}), Status::kOk);
      const float sign = reverse ? -1.0f : 1.0f;
      TrackingInput input = Aim(sign * 5.0f, 0.0f, 2.0f);
      input.left_m = 10.0f;
      input.reverse = reverse;
      TrackingOutput output;
      for (int i = 0; i < 40; ++i) ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
      ASSERT_GT(sign * output.speed_mps, 0.3f);
      EXPECT_EQ(tracker.reverse(), reverse);
      input = Aim(-sign * 5.0f, 0.0f, 2.0f);
      input.left_m = 10.0f;
      input.reverse = !reverse;
      float before_mps = output.speed_mps;
      bool was_zero = false;
      for (int i = 0; i < 200; ++i) {
        ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
        EXPECT_LE(std::fabs(output.speed_mps - before_mps), 2.0f * kTick_s + 1e-4f) << i;
        was_zero |= output.speed_mps == 0.0f;
        if (!was_zero) {
          EXPECT_GE(sign * output.speed_mps, 0.0f) << i;
        }
        before_mps = output.speed_mps;
      }
      EXPECT_TRUE(was_zero);
      EXPECT_LT(sign * output.speed_mps, -0.1f);
    }
  }
}

// A turn on the spot that is given up dies out before the vehicle drives off.
// SR-STA06
TEST(Tracker, DoesNotSetOutWhileItStillTurns) {
  Tracker tracker;
  ASSERT_EQ(tracker.Configure({}, {}, {}, {}, {}), Status::kOk);
  TrackingOutput output;
  uint64_t now_ns = 1'000'000'000;
  const auto tick = [&](const TrackingInput& input) {
    now_ns += 10'000'000;
    static_cast<void>(tracker.Predict(now_ns, {}, {}, {}));
    ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
  };
  TrackingInput turn;
  turn.turn = true;
  turn.aim.pose.theta_rad = 3.0f;
  for (int i = 0; i < 150; ++i) tick(turn);
  ASSERT_GT(tracker.predicted().yaw_rate_radps, 0.5f);
  TrackingInput straight = Aim(5.0f, 0.0f, 2.0f);
  straight.left_m = 10.0f;
  int waited = 0;
  for (; waited < 200; ++waited) {
    tick(straight);
    if (output.speed_mps > 0.0f) break;
    EXPECT_EQ(output.yaw_rate_radps, 0.0f);
  }
  EXPECT_GT(waited, 10);
  EXPECT_LT(waited, 150);
  EXPECT_LE(tracker.predicted().yaw_rate_radps, Tracker::kStillTurns_radps);
}

TEST(PurePursuit, KeepsTheTurnAndGivesUpSpeedWhenAWheelWouldBeTooFast) {
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

TEST(PurePursuit, TurnsOnTheSpotTheShortWayRound) {
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

TEST(PurePursuit, DoesNotAimBehindItself) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  ASSERT_EQ(tracker.Follow(Aim(-1.0f, 0.3f, 1.0f), kTick_s, output), Status::kOk);
  EXPECT_EQ(output.yaw_rate_radps, 0.0f);
}

// SR-CMD03
TEST(PurePursuit, CommandsZeroForWhatIsNoNumber) {
  Tracker tracker = MakeTracker();
  TrackingOutput output;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 2.0f), kTick_s, output), Status::kOk);
  }
  EXPECT_EQ(tracker.Follow(Aim(kNaN, 0.0f, 2.0f), kTick_s, output), Status::kNotFinite);
  EXPECT_EQ(output.wheels.left_radps, 0.0f);
  EXPECT_EQ(output.speed_mps, 0.0f);
  EXPECT_EQ(tracker.Follow(Aim(2.0f, 0.0f, kNaN), kTick_s, output), Status::kNotFinite);
  EXPECT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 2.0f), 0.0f, output), Status::kNotFinite);
}

TEST(PurePursuit, ZeroIsAtOnce) {
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

TEST(PurePursuit, RefusesParametersOutOfRangeAndDoesNothingWithoutAny) {
  Tracker tracker;
  TrackingOutput output;
  EXPECT_EQ(tracker.Follow(Aim(2.0f, 0.0f, 2.0f), kTick_s, output), Status::kNotStarted);
  EXPECT_EQ(tracker.Configure({}, {}, {}, {}, {.lookahead_s = -1.0f}),
            Status::kParameterOutOfRange);
}

Tracker MakeLagAware(const VehicleParams& vehicle = {}) {
  Tracker tracker;
  EXPECT_EQ(tracker.Configure(vehicle, {}, {}, {}, {}), Status::kOk);
  return tracker;
}

TrackingInput Along(float cross_track_m, float limit_mps) {
  TrackingInput input;
  input.pose = {0.0f, cross_track_m, 0.0f};
  input.speed_limit_mps = limit_mps;
  input.left_m = 50.0f;
  return input;
}

TEST(Tracker, BeginsOverSomeTicks) {
  Tracker tracker = MakeLagAware();
  TrackingOutput output;
  float before_radps = 0.0f;
  uint64_t now_ns = 1'000'000'000;
  for (int tick = 0; tick < 100; ++tick) {
    now_ns += 10'000'000;
    static_cast<void>(tracker.Predict(now_ns, {}, {}, {}));
    ASSERT_EQ(tracker.Follow(Along(0.0f, 5.0f), kTick_s, output), Status::kOk);
    ASSERT_LE(output.wheels.left_radps - before_radps,
              1.01f * Tracker::kMaxCommandChange_radps2 * kTick_s)
        << tick;
    before_radps = output.wheels.left_radps;
  }
  // More than the speed itself asks for: the lag is undone.
  EXPECT_GT(before_radps, 1.2f * output.speed_mps / kRim_m);
}

TEST(Tracker, SpeedsUpWithinThePlansLimitsWhateverThePathSays) {
  Tracker tracker = MakeLagAware();
  TrackingOutput output;
  TrackingInput input = Along(0.0f, 5.0f);
  uint64_t now_ns = 1'000'000'000;
  float before_mps = 0.0f;
  for (int tick = 0; tick < 400; ++tick) {
    input.acceleration_mps2 = tick % 3 == 0 ? 1e6f : -1e6f;
    input.speed_limit_mps = tick % 50 < 30 ? 1e9f : 0.0f;
    const WheelFeedback feedback = {
        .valid = true, .time_ns = now_ns, .left_radps = 10.0f, .right_radps = 10.0f};
    now_ns += 10'000'000;
    static_cast<void>(tracker.Predict(now_ns, {}, feedback, {}));
    ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
    ASSERT_LE(std::fabs(output.speed_mps - before_mps), 2.001f * kTick_s);
    ASSERT_GE(output.speed_mps, 0.0f);
    before_mps = output.speed_mps;
  }
}

// SR-PLN04
TEST(Tracker, StopsWhereItIsTooFarFromItsPathAndSaysSo) {
  Tracker tracker = MakeLagAware();
  TrackingOutput output;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(tracker.Follow(Along(0.5f, 5.0f), kTick_s, output), Status::kOk);
  }
  const float before_mps = output.speed_mps;
  EXPECT_GT(before_mps, 0.4f);
  for (const float off_m : {2.1f, -3.0f, 1e3f, -1e6f, 1e18f, 3e38f}) {
    ASSERT_EQ(tracker.Follow(Along(off_m, 5.0f), kTick_s, output), Status::kOffPath) << off_m;
    EXPECT_LE(std::fabs(output.wheels.left_radps), 17.5f);
    EXPECT_LE(std::fabs(output.wheels.right_radps), 17.5f);
    EXPECT_LE(std::fabs(output.yaw_rate_radps), 1.1f);
  }
  EXPECT_LT(output.speed_mps, before_mps);
}

// SR-CMD03
TEST(Tracker, CommandsZeroForWhatIsNoNumber) {
  const auto spoilt = [](float TrackingInput::*member, float value) {
    TrackingInput input = Along(0.1f, 2.0f);
    input.*member = value;
    return input;
  };
  std::vector<TrackingInput> bad = {spoilt(&TrackingInput::acceleration_mps2, kNaN),
                                    spoilt(&TrackingInput::turn_curvature_per_m, kNaN),
                                    spoilt(&TrackingInput::wheel_curvature_per_m, kNaN),
                                    spoilt(&TrackingInput::curvature_rate_per_m2, kNaN),
                                    spoilt(&TrackingInput::left_m, kNaN),
                                    spoilt(&TrackingInput::speed_limit_mps, kNaN)};
  bad.push_back(Along(kNaN, 2.0f));
  bad.push_back(Along(0.0f, 2.0f));
  bad.back().path.theta_rad = kNaN;
  for (const TrackingInput& input : bad) {
    Tracker tracker = MakeLagAware();
    TrackingOutput output;
    for (int i = 0; i < 20; ++i) {
      ASSERT_EQ(tracker.Follow(Along(0.1f, 2.0f), kTick_s, output), Status::kOk);
    }
    ASSERT_NE(output.wheels.left_radps, 0.0f);
    EXPECT_EQ(tracker.Follow(input, kTick_s, output), Status::kNotFinite);
    EXPECT_EQ(output.wheels.left_radps, 0.0f);
    EXPECT_EQ(output.wheels.right_radps, 0.0f);
    EXPECT_EQ(tracker.speed_mps(), 0.0f);
  }
}

// Huge, but numbers: nothing beyond the limits comes of them.
TEST(Tracker, StaysWithinItsLimitsWhateverItIsTold) {
  std::mt19937 random(4);
  const auto any = [&] {
    const float magnitude = std::pow(10.0f, std::uniform_real_distribution<float>(-3, 18)(random));
    return random() % 2 == 0 ? magnitude : -magnitude;
  };
  Tracker tracker = MakeLagAware();
  TrackingOutput output;
  uint64_t now_ns = 1'000'000'000;
  for (int i = 0; i < 20000; ++i) {
    now_ns += random() % 100 == 0 ? random() : 10'000'000;
    const WheelFeedback feedback = {.valid = random() % 2 == 0,
                                    .time_ns = now_ns - random() % 100'000'000,
                                    .left_radps = any(),
                                    .right_radps = any()};
    const BodyMotion body = {
        .valid = random() % 2 == 0, .speed_mps = any(), .yaw_rate_radps = any()};
    static_cast<void>(tracker.Predict(now_ns, {any(), any(), any()}, feedback, body));
    TrackingInput input;
    input.pose = {any(), any(), WrapAngle(any())};
    input.path = {any(), any(), WrapAngle(any())};
    if (random() % 2 == 0) input.path = {input.pose.x_m, input.pose.y_m, 0.0f};
    input.turn = random() % 16 == 0;
    input.reverse = random() % 2 == 0;
    input.speed_limit_mps = any();
    input.acceleration_mps2 = any();
    input.turn_curvature_per_m = any();
    input.wheel_curvature_per_m = any();
    input.curvature_rate_per_m2 = any();
    input.left_m = any();
    const Status status = random() % 4 == 0 ? tracker.StopAlong(input, kTick_s, output)
                                            : tracker.Follow(input, kTick_s, output);
    ASSERT_TRUE(IsUsable(status));
    ASSERT_LE(std::fabs(output.wheels.left_radps), 17.51f) << i;
    ASSERT_LE(std::fabs(output.wheels.right_radps), 17.51f) << i;
    ASSERT_LE(std::fabs(output.speed_mps), 5.01f) << i;
    ASSERT_LE(std::fabs(output.yaw_rate_radps), 1.11f) << i;
    ASSERT_LE(std::fabs(output.curvature_per_m), 20.01f) << i;  // an arc of 5 cm
  }
}

// It slides round: its wheels turn it by 29 rad/s, and drive it with less than 0.9 m/s.
TEST(Tracker, TellsNoArcTighterThanOneOfFiveCentimetres) {
  for (const float side : {1.0f, -1.0f}) {
    Tracker tracker = MakeLagAware();
    const uint64_t now_ns = 1'000'000'000;
    const WheelFeedback feedback = {.valid = true,
                                    .time_ns = now_ns,
                                    .left_radps = 3.0f - 95.0f * side,
                                    .right_radps = 3.0f + 95.0f * side};
    static_cast<void>(tracker.Predict(now_ns, {}, feedback, {}));
    TrackingOutput output;
    ASSERT_EQ(tracker.Follow(Along(0.0f, 2.0f), kTick_s, output), Status::kOk);
    EXPECT_FLOAT_EQ(output.curvature_per_m, side * 20.0f);
  }
}

TEST(Tracker, ComesToRestAtTheEndWithoutBeingToldBackwards) {
  Tracker tracker = MakeLagAware();
  TrackingOutput output;
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(tracker.Follow(Along(0.0f, 2.0f), kTick_s, output), Status::kOk);
  }
  TrackingInput end = Along(0.0f, 2.0f);
  end.left_m = 0.0f;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(tracker.Follow(end, kTick_s, output), Status::kOk);
    ASSERT_GE(output.wheels.left_radps, 0.0f);
  }
  EXPECT_EQ(output.speed_mps, 0.0f);
  EXPECT_EQ(output.wheels.left_radps, 0.0f);
}

TEST(Tracker, KnowsFromWhichSpeedItStops) {
  const Tracker tracker = MakeLagAware();
  EXPECT_EQ(tracker.EndSpeed(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(tracker.EndSpeed(-1.0f, 2.0f), 0.0f);
  EXPECT_EQ(tracker.EndSpeed(kNaN, 2.0f), 0.0f);
  float before_mps = 0.0f;
  for (int i = 1; i < 1000; ++i) {
    const float speed_mps = tracker.EndSpeed(0.01f * static_cast<float>(i), 2.0f);
    ASSERT_GT(speed_mps, before_mps);
    ASSERT_LT(speed_mps - before_mps, 0.05f);  // no step where its two parts meet
    before_mps = speed_mps;
  }
}

// With a sixth of its braking left it begins to stop farther away.
TEST(Tracker, StopsAtTheEndWithWhatTheGroundLeaves) {
  for (const float held_mps2 : {0.0f, 0.3f}) {
    SCOPED_TRACE(held_mps2);
    Tracker tracker = MakeLagAware();
    TrackingOutput output;
    TrackingInput input = Along(0.0f, 2.0f);
    input.deceleration_mps2 = held_mps2;
    uint64_t now_ns = 1'000'000'000;
    const auto drive = [&](float left_m) {
      input.left_m = left_m;
      for (int i = 0; i < 200; ++i) {
        now_ns += 10'000'000;
        const WheelFeedback feedback = {
            .valid = true, .time_ns = now_ns, .left_radps = 7.0f, .right_radps = 7.0f};
        static_cast<void>(tracker.Predict(now_ns, {}, feedback, {}));
        ASSERT_EQ(tracker.Follow(input, kTick_s, output), Status::kOk);
      }
    };
    drive(100.0f);
    EXPECT_NEAR(output.speed_mps, 2.0f, 0.05f);
    drive(3.0f);
    const float end_mps = tracker.EndSpeed(3.0f, held_mps2 > 0.0f ? held_mps2 : 2.0f);
    EXPECT_LT(tracker.EndSpeed(3.0f, 0.3f), 1.3f);
    EXPECT_GT(tracker.EndSpeed(3.0f, 2.0f), 2.0f);
    EXPECT_NEAR(output.speed_mps, std::min(end_mps, 2.0f), 0.1f);
  }
}

TEST(Tracker, RefusesParametersOutOfRange) {
  Tracker tracker;
  TrackingOutput output;
  EXPECT_EQ(tracker.Configure({}, {}, {}, {.dead_time_s = 2.0f}, {}), Status::kParameterOutOfRange);
  EXPECT_EQ(tracker.Configure({}, {}, {}, {}, {.bandwidth_radps = kNaN}),
            Status::kParameterOutOfRange);
  EXPECT_EQ(tracker.Follow(Along(0.0f, 2.0f), kTick_s, output), Status::kNotStarted);
  EXPECT_EQ(output.wheels.left_radps, 0.0f);
}

VehicleParams Ackermann() {
  VehicleParams vehicle;
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.wheelbase_m = 1.5f;
  vehicle.max_steering_rad = 0.45f;
  return vehicle;
}

// Whatever it is asked for, the wheels' speeds are those of a curvature that it can be steered to:
// kappa = 2 d / (b c).
// SR-PLN05
TEST(Ackermann, IsNeverToldToBendMoreThanItCan) {
  const VehicleParams vehicle = Ackermann();
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (const int32_t method : {TrackingParams::kPurePursuit, TrackingParams::kLagAware}) {
    Tracker tracker;
    ASSERT_EQ(tracker.Configure(vehicle, {}, {}, {}, {.method = method}), Status::kOk);
    int at_limit = 0;
    TrackingInput input = Aim(2.0f, 0.0f, 3.0f);
    for (int tick = 1; tick <= 5000; ++tick) {
      if (tick % 50 == 1) {
        input.aim.pose = {1.0f + unit(random), 2.0f * unit(random), 0.0f};
        input.pose = {0.3f * unit(random), 0.5f * unit(random), 0.5f * unit(random)};
        input.turn_curvature_per_m = unit(random);
        input.wheel_curvature_per_m = unit(random);
        input.left_m = 10.0f;
      }
      TrackingOutput output;
      static_cast<void>(
          tracker.Predict(static_cast<uint64_t>(tick) * 10'000'000, input.pose, {}, {}));
      ASSERT_TRUE(IsUsable(tracker.Follow(input, kTick_s, output)));
      const WheelParts wheels = PartsOf(output.wheels.left_radps, output.wheels.right_radps);
      // At the speed that is told or that it has: braking, the wheels turn faster than they are
      // told.
      const float common_radps = std::max(std::abs(wheels.common_radps),
                                          std::abs(tracker.predicted().wheels.common_radps));
      const float most_radps =
          0.5f * vehicle.skid_baseline_m * (std::tan(0.45f) / 1.5f) * common_radps;
      ASSERT_LE(std::abs(wheels.differential_radps), most_radps * 1.0001f + 1e-6f) << tick;
      at_limit += std::abs(wheels.differential_radps) > 0.99f * most_radps ? 1 : 0;
    }
    EXPECT_GT(at_limit, 100) << "the limit was not tried";
  }
}

// A body that does not lag behind its wheels has its speed controlled all the same: where it rolls
// and is to stand, it is braked.
TEST(Tracker, BrakesABodyThatDoesNotLagBehindItsWheels) {
  Tracker tracker;
  DynamicsParams dynamics;
  dynamics.speed_lag_s = 0.0f;
  ASSERT_EQ(tracker.Configure({}, {}, {}, dynamics, {}), Status::kOk);
  TrackingInput input = Aim(2.0f, 0.0f, 0.0f);
  input.left_m = 0.0f;
  TrackingOutput output;
  const float rolling_radps = 1.0f;
  for (int tick = 1; tick <= 100; ++tick) {
    const WheelFeedback wheels = {true, static_cast<uint64_t>(tick) * 10'000'000, rolling_radps,
                                  rolling_radps};
    static_cast<void>(tracker.Predict(wheels.time_ns, input.pose, wheels, {}));
    ASSERT_TRUE(IsUsable(tracker.Follow(input, kTick_s, output)));
  }
  EXPECT_LT(output.wheels.left_radps + output.wheels.right_radps, rolling_radps) << "half of it";
}

// SR-PLN06
TEST(Ackermann, DoesNotTurnOnTheSpot) {
  Tracker tracker = MakeTracker(Ackermann());
  TrackingInput input = Aim(0.0f, 0.0f, 1.0f);
  input.turn = true;
  input.aim.pose.theta_rad = 1.0f;
  TrackingOutput output;
  EXPECT_EQ(tracker.Follow(input, kTick_s, output), Status::kNeedsManoeuvre);
  EXPECT_EQ(output.wheels.left_radps, 0.0f);
  EXPECT_EQ(output.wheels.right_radps, 0.0f);
}

}  // namespace
}  // namespace hardpack
