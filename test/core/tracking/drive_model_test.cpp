// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/drive_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/core/tracking/bench.h"
#include "test/not_finite.h"

namespace hardpack::testing {
namespace {

using testing::kInfinity;
using testing::kNaN;
constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kStart_ns = 5'000'000'000;

TEST(DifferentialCommand, IsTheInverseOfWhatIsReached) {
  const DynamicsParams params;
  for (const float common_radps : {0.0f, 5.0f, -14.0f}) {
    const float limit_radps =
        params.differential_limit_radps - params.differential_limit_slope * std::fabs(common_radps);
    EXPECT_EQ(DifferentialCommand(params, 0.0f, common_radps), 0.0f);
    const int most = static_cast<int>(100.0f * kMaxLimitShare * limit_radps);
    for (int i = -most; i <= most; ++i) {
      const float wanted = 0.01f * static_cast<float>(i);
      const float command = DifferentialCommand(params, wanted, common_radps);
      ASSERT_NEAR(ReachableDifferential(params, command, common_radps), wanted, 1e-4f);
      ASSERT_EQ(command, -DifferentialCommand(params, -wanted, common_radps));
    }
    // Beyond what it can reach it stays finite, and little above.
    const float largest = DifferentialCommand(params, kInfinity, common_radps);
    EXPECT_EQ(DifferentialCommand(params, 1e9f, common_radps), largest);
    EXPECT_LT(largest, 1.1f * limit_radps);
    EXPECT_EQ(ReachableDifferential(params, kInfinity, common_radps), limit_radps);
    EXPECT_EQ(ReachableDifferential(params, -1e30f, common_radps), -limit_radps);
  }
}

TEST(ScrubOf, GrowsToItsMostAndIsOdd) {
  const DynamicsParams params;
  EXPECT_EQ(ScrubOf(params, 0.0f), 0.0f);
  EXPECT_NEAR(ScrubOf(params, params.scrub_width_radps), 0.7071f * params.scrub_radps, 1e-4f);
  EXPECT_NEAR(ScrubOf(params, -50.0f), -params.scrub_radps, 1e-3f);
}

DriveModel MakeModel(const DynamicsParams& params = {}) {
  DriveModel model;
  EXPECT_EQ(model.Configure({}, {}, params), Status::kOk);
  EXPECT_EQ(model.Advance(kStart_ns, {}, {}), Status::kStale);
  return model;
}

// The fit with one dead time, without what the model leaves out.
TrueVehicle AsModelled() {
  TrueVehicle vehicle = Typical();
  const DynamicsParams dynamics;
  sim::VehicleModelParams& fit = vehicle.fitted;
  fit.dead_time_common_s = fit.dead_time_differential_s = double{dynamics.dead_time_s};
  fit.common_turn_loss = 0.0;
  fit.turn_slip = 0.0;
  fit.skid_baseline_m = double{VehicleParams{}.skid_baseline_m} / fit.ground_per_wheel;
  return vehicle;
}

WheelCommand WheelsOf(const WheelParts& command) {
  return {command.common_radps - command.differential_radps,
          command.common_radps + command.differential_radps};
}

// Not driven by feedback, it stays with a vehicle that is as it thinks, through the dead time.
TEST(DriveModel, PredictsWhereTheVehicleWillBe) {
  DriveModel model = MakeModel();
  VehicleBench bench{AsModelled()};
  std::vector<DriveState> promised;
  constexpr int kDead = 14;
  for (int tick = 0; tick < 600; ++tick) {
    const double t = 0.01 * tick;
    const WheelParts command = {static_cast<float>(9.0 + 5.0 * std::sin(1.3 * t)),
                                static_cast<float>(3.5 * std::sin(1.1 * t))};
    model.SetCommand(command);
    for (int ms = 0; ms < 10; ++ms) bench.Step_ms(WheelsOf(command));
    const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick + 1) * kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}, {}), Status::kOk);
    const TruePose& pose = bench.pose();
    const Pose2 now = {static_cast<float>(pose.x_m), static_cast<float>(pose.y_m),
                       WrapAngle(static_cast<float>(pose.theta_rad))};
    promised.push_back(model.Predict(now));
    if (tick < kDead) continue;
    const DriveState& then = promised[static_cast<size_t>(tick - kDead)];
    ASSERT_NEAR(now.x_m, then.pose.x_m, 0.03) << tick;
    ASSERT_NEAR(now.y_m, then.pose.y_m, 0.03) << tick;
    ASSERT_NEAR(WrapAngle(now.theta_rad - then.pose.theta_rad), 0.0f, 0.01) << tick;
    ASSERT_NEAR(bench.speed_mps(), then.speed_mps, 0.1) << tick;
    ASSERT_NEAR(bench.yaw_rate_radps(), then.yaw_rate_radps, 0.05) << tick;
  }
  EXPECT_NEAR(model.wheels().common_radps, 0.5 * (bench.left_radps() + bench.right_radps()), 0.1);
}

// Tyres that scrub half as much, and half again: the measured wheel speeds teach it.
TEST(DriveModel, LearnsWhatScrubbingTakes) {
  for (const double factor : {0.5, 1.5}) {
    TrueVehicle other = AsModelled();
    other.fitted.scrub_radps *= factor;
    DriveModel model = MakeModel();
    VehicleBench bench(other);
    const WheelParts command = {8.0f, 4.0f};
    model.SetCommand(command);
    for (int tick = 1; tick <= 300; ++tick) {
      for (int ms = 0; ms < 10; ++ms) bench.Step_ms(WheelsOf(command));
      const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick) * kTick_ns;
      const WheelFeedback feedback = tick % 2 == 0 ? FeedbackOf(bench, now_ns) : WheelFeedback{};
      ASSERT_EQ(model.Advance(now_ns, feedback, {}), Status::kOk);
    }
    const float differential = 0.5f * static_cast<float>(bench.right_radps() - bench.left_radps());
    EXPECT_NEAR(model.wheels().differential_radps, differential, 0.03f) << factor;
    EXPECT_NEAR(model.Predict({}).wheels.differential_radps, differential, 0.08f) << factor;
  }
}

// Drives that turn more quickly than the fit, or more slowly: the first turns tell.
TEST(DriveModel, LearnsHowQuicklyTheVehicleTurns) {
  float slower = 0.0f;
  for (const double lag_s : {0.7, 0.43, 0.25}) {
    TrueVehicle other = AsModelled();
    other.fitted.time_constant_differential_s = lag_s;
    other.fitted.slew_differential_radps2 *= 0.43 / lag_s;
    DriveModel model = MakeModel();
    VehicleBench bench(other);
    for (int tick = 1; tick <= 900; ++tick) {
      const WheelParts command = {8.0f, tick % 120 < 60 ? 4.0f : -4.0f};
      model.SetCommand(command);
      for (int ms = 0; ms < 10; ++ms) bench.Step_ms(WheelsOf(command));
      const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick) * kTick_ns;
      const WheelFeedback feedback = tick % 2 == 0 ? FeedbackOf(bench, now_ns) : WheelFeedback{};
      ASSERT_EQ(model.Advance(now_ns, feedback, {}), Status::kOk);
      ASSERT_GE(model.quickness(), DriveModel::kMinQuickness);
      ASSERT_LE(model.quickness(), DriveModel::kMaxQuickness);
    }
    EXPECT_NEAR(model.DifferentialLag_s(), lag_s, 0.25 * lag_s);
    EXPECT_GT(model.quickness(), slower);
    slower = model.quickness();
  }
}

// Ground on which the vehicle turns and drives less than the wheels say: odometry's motion tells.
TEST(DriveModel, LearnsWhatAWheelDoesOnThisGround) {
  TrueVehicle other = AsModelled();
  other.fitted.ground_per_wheel *= 0.9;
  other.fitted.skid_baseline_m *= 1.15;
  DriveModel model = MakeModel();
  VehicleBench bench(other);
  const float rim_m = model.RimWay_m();
  const float per_turn = model.PerTurn();
  const WheelParts command = {8.0f, 4.0f};
  model.SetCommand(command);
  for (int tick = 1; tick <= 1500; ++tick) {
    for (int ms = 0; ms < 10; ++ms) bench.Step_ms(WheelsOf(command));
    const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick) * kTick_ns;
    const BodyMotion body = {.valid = true,
                             .speed_mps = static_cast<float>(bench.speed_mps()),
                             .yaw_rate_radps = static_cast<float>(bench.yaw_rate_radps())};
    ASSERT_EQ(model.Advance(now_ns, FeedbackOf(bench, now_ns), body), Status::kOk);
  }
  EXPECT_NEAR(model.RimWay_m() / rim_m, 0.9f, 0.03f);
  EXPECT_NEAR(model.PerTurn() / per_turn, 1.15f, 0.04f);
}

// Ticks come when they come: a report of the tick lies ahead of the model's last step.
TEST(DriveModel, LearnsWhatAWheelLacksWhateverTheTicksAreOffBy) {
  constexpr float kLacks_radps = 1.0f;
  for (const uint64_t jitter_ns : {uint64_t{0}, uint64_t{50'000}, uint64_t{5'000'000}}) {
    DynamicsParams params;
    DriveModel model = MakeModel(params);
    model.SetCommand({8.0f, 0.0f});
    for (uint64_t tick = 1; tick <= 2000; ++tick) {
      const uint64_t off_ns = jitter_ns == 0 ? 0 : tick * 7919 * 1000 % jitter_ns;
      const uint64_t now_ns = kStart_ns + tick * kTick_ns + off_ns;
      WheelFeedback feedback;
      if (tick % 2 == 0) {
        feedback = {.valid = true,
                    .time_ns = now_ns,
                    .left_radps = 8.0f + kLacks_radps,
                    .right_radps = 8.0f + kLacks_radps};
      }
      ASSERT_EQ(model.Advance(now_ns, feedback, {}), Status::kOk);
    }
    EXPECT_NEAR(model.common_bias_radps(), kLacks_radps, 0.05f) << jitter_ns;
  }
}

// The body's motion is taken as it is told, and what is none is not.
TEST(DriveModel, FollowsTheMeasuredMotionOfTheBody) {
  DriveModel model = MakeModel();
  uint64_t now_ns = kStart_ns;
  for (int tick = 0; tick < 100; ++tick) {
    now_ns += kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}, {true, 1.0f, 0.4f}), Status::kOk);
  }
  EXPECT_GT(model.speed_mps(), 0.85f);
  EXPECT_GT(model.yaw_rate_radps(), 0.3f);
  const float before_mps = model.speed_mps();
  for (const BodyMotion& body : {BodyMotion{true, kNaN, 0.1f}, BodyMotion{true, 0.1f, kInfinity},
                                 BodyMotion{true, 1e9f, 0.0f}, BodyMotion{false, 0.0f, 0.0f}}) {
    ASSERT_EQ(model.Advance(now_ns, {}, body), Status::kOk);
    ASSERT_EQ(model.speed_mps(), before_mps);
  }
}

TEST(DriveModel, TakesNoFeedbackThatIsNoneOrOldOrTheSameTwice) {
  DriveModel model = MakeModel();
  model.SetCommand({5.0f, 0.0f});
  uint64_t now_ns = kStart_ns;
  for (int tick = 0; tick < 100; ++tick) {
    now_ns += kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}, {}), Status::kOk);
  }
  const float before = model.wheels().common_radps;
  const WheelFeedback bad[] = {
      {.valid = true, .time_ns = now_ns, .left_radps = kNaN, .right_radps = 1.0f},
      {.valid = true, .time_ns = now_ns, .left_radps = 1.0f, .right_radps = kInfinity},
      {.valid = true, .time_ns = now_ns, .left_radps = 1e9f, .right_radps = 0.0f},
      {.valid = false, .time_ns = now_ns, .left_radps = 1.0f, .right_radps = 1.0f},
      {.valid = true, .time_ns = now_ns - 400'000'000, .left_radps = 1.0f, .right_radps = 1.0f}};
  for (const WheelFeedback& feedback : bad) {
    ASSERT_EQ(model.Advance(now_ns, feedback, {}), Status::kOk);
    ASSERT_EQ(model.wheels().common_radps, before);
  }
  const WheelFeedback good = {
      .valid = true, .time_ns = now_ns, .left_radps = 3.0f, .right_radps = 3.0f};
  ASSERT_EQ(model.Advance(now_ns, good, {}), Status::kOk);
  const float after = model.wheels().common_radps;
  EXPECT_LT(after, before);
  ASSERT_EQ(model.Advance(now_ns, good, {}), Status::kOk);
  EXPECT_EQ(model.wheels().common_radps, after);
}

TEST(DriveModel, StandsUntilItIsToldOtherwise) {
  DriveModel model;
  ASSERT_EQ(model.Configure({}, {}, {}), Status::kOk);
  for (const bool began : {false, true}) {
    if (began) {
      ASSERT_EQ(model.Advance(kStart_ns, {}, {}), Status::kStale);
    }
    const DriveState state = model.Predict({1.0f, 2.0f, 0.5f});
    EXPECT_EQ(state.speed_mps, 0.0f);
    EXPECT_EQ(state.yaw_rate_radps, 0.0f);
    EXPECT_EQ(state.wheels.common_radps, 0.0f);
    EXPECT_EQ(state.wheels.differential_radps, 0.0f);
    EXPECT_EQ(state.pose.x_m, 1.0f);
    EXPECT_EQ(state.pose.y_m, 2.0f);
    EXPECT_EQ(state.pose.theta_rad, 0.5f);
  }
}

// The integral is for what is driven: told to stand, it goes back to none.
TEST(DriveModel, IsToldToStandBelowATwentiethOfARadianPerSecond) {
  DriveModel turning = MakeModel();
  uint64_t now_ns = kStart_ns;
  for (int tick = 0; tick < 100; ++tick) {
    turning.SetCommand({8.0f, 4.0f});
    now_ns += kTick_ns;
    ASSERT_EQ(turning.Advance(now_ns, {}, {}), Status::kOk);
  }
  ASSERT_GT(turning.integral_radps(), 0.2f);
  const float least_radps = 0.05f;
  const auto integral_after = [&](const WheelParts& command) {
    DriveModel model = turning;
    for (int tick = 1; tick <= 200; ++tick) {
      model.SetCommand(command);
      EXPECT_EQ(model.Advance(now_ns + static_cast<uint64_t>(tick) * kTick_ns, {}, {}),
                Status::kOk);
    }
    return model.integral_radps();
  };
  const float stands = std::nextafter(least_radps, 0.0f);
  EXPECT_NEAR(integral_after({stands, -stands}), 0.0f, 0.02f);
  EXPECT_GT(std::abs(integral_after({least_radps, stands})), 0.05f);
  EXPECT_GT(std::abs(integral_after({stands, least_radps})), 0.05f);
}

// Of the ground only what turns quicker than that tells anything.
TEST(DriveModel, LearnsTheGroundOfTurnsThatAreQuickEnough) {
  const float least_radps = 0.15f;
  const float per_turn = MakeModel().PerTurn();
  float differential_radps = least_radps * per_turn;
  while (differential_radps / per_turn > least_radps) {
    differential_radps = std::nextafter(differential_radps, 0.0f);
  }
  ASSERT_EQ(differential_radps / per_turn, least_radps);
  for (const bool quicker : {false, true}) {
    DriveModel model = MakeModel();
    // After a gap its wheels are what they are measured to be.
    const uint64_t now_ns = kStart_ns + 200 * kTick_ns;
    const float wheel_radps = quicker ? 1.001f * differential_radps : differential_radps;
    const WheelFeedback wheels = {
        .valid = true, .time_ns = now_ns, .left_radps = -wheel_radps, .right_radps = wheel_radps};
    ASSERT_EQ(model.Advance(now_ns, wheels, {}), Status::kStale);
    ASSERT_EQ(model.wheels().differential_radps, wheel_radps);
    const BodyMotion body = {.valid = true, .speed_mps = 0.0f, .yaw_rate_radps = 0.5f};
    ASSERT_EQ(model.Advance(now_ns, {}, body), Status::kOk);
    EXPECT_EQ(model.PerTurn() != per_turn, quicker);
  }
}

TEST(DriveModel, ForgetsItsCommandsAfterAGap) {
  DriveModel model = MakeModel();
  model.SetCommand({10.0f, 2.0f});
  uint64_t now_ns = kStart_ns;
  for (int tick = 0; tick < 100; ++tick) {
    now_ns += kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}, {}), Status::kOk);
  }
  // A late tick is made up for ...
  now_ns += 15 * kTick_ns;
  ASSERT_EQ(model.Advance(now_ns, {}, {}), Status::kOk);
  EXPECT_GT(model.wheels().common_radps, 8.0f);
  // ... a pause is not: the wheels are what they are measured to be.
  now_ns += 200 * kTick_ns;
  const WheelFeedback slow = {
      .valid = true, .time_ns = now_ns, .left_radps = 1.0f, .right_radps = 1.0f};
  EXPECT_EQ(model.Advance(now_ns, slow, {}), Status::kStale);
  EXPECT_EQ(model.wheels().common_radps, 1.0f);
  EXPECT_EQ(model.common_bias_radps(), 0.0f);
  EXPECT_EQ(model.integral_radps(), 0.0f);
  EXPECT_LT(model.Predict({}).wheels.common_radps, 1.0f);
  EXPECT_EQ(model.Advance(now_ns - 1, slow, {}), Status::kInvalidArgument);
  // However long: up to the end of time.
  EXPECT_EQ(model.Advance(std::numeric_limits<uint64_t>::max(), {}, {}), Status::kStale);
}

TEST(DriveModel, GivesBackAPoseThatIsNone) {
  DriveModel model = MakeModel();
  model.SetCommand({5.0f, 1.0f});
  ASSERT_EQ(model.Advance(kStart_ns + kTick_ns, {}, {}), Status::kOk);
  EXPECT_TRUE(std::isnan(model.Predict({kNaN, 0.0f, 0.0f}).pose.x_m));
  EXPECT_TRUE(std::isinf(model.Predict({0.0f, 0.0f, kInfinity}).pose.theta_rad));
  EXPECT_TRUE(std::isfinite(model.Predict({0.0f, 0.0f, 1e30f}).pose.theta_rad));
}

TEST(DriveModel, TakesTheEndsOfItsParameters) {
  for (const float dead_s : {0.0f, 0.004f, 0.5f}) {
    DynamicsParams params;
    params.dead_time_s = dead_s;
    params.common_lag_s = 0.05f;
    params.differential_lag_s = 0.05f;
    params.speed_lag_s = 0.0f;
    params.yaw_rate_lag_s = 0.05f;
    DriveModel model = MakeModel(params);
    model.SetCommand({5.0f, 1.0f});
    for (int tick = 1; tick <= 200; ++tick) {
      ASSERT_EQ(model.Advance(kStart_ns + static_cast<uint64_t>(tick) * kTick_ns, {}, {}),
                Status::kOk);
    }
    EXPECT_NEAR(model.wheels().common_radps, 5.0f, 0.01f);
    EXPECT_NEAR(model.Predict({}).pose.x_m, 5.0f * model.RimWay_m() * dead_s, 0.02f);
  }
  DynamicsParams params;
  params.common_lag_s = 0.0f;
  DriveModel model;
  EXPECT_EQ(model.Configure({}, {}, params), Status::kParameterOutOfRange);
  EXPECT_EQ(model.Advance(kStart_ns, {}, {}), Status::kNotStarted);
}

}  // namespace
}  // namespace hardpack::testing
