// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/drive_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/core/tracking/bench.h"

namespace hardpack::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kStart_ns = 5'000'000'000;

TEST(Tanh, IsWithinItsErrorAndNeverBeyondOne) {
  for (int i = -80000; i <= 80000; ++i) {
    const float x = 1e-4f * static_cast<float>(i);
    const float value = Tanh(x);
    ASSERT_NEAR(value, std::tanh(static_cast<double>(x)), kTanhMaxError) << x;
    ASSERT_LE(std::fabs(value), 1.0f) << x;
    ASSERT_EQ(value, -Tanh(-x)) << x;
  }
  EXPECT_EQ(Tanh(kInf), 1.0f);
  EXPECT_EQ(Tanh(-kInf), -1.0f);
}

TEST(DifferentialCommand, IsTheInverseOfTheSettledSpeed) {
  const DynamicsParams params;
  EXPECT_EQ(DifferentialCommand(params, 0.0f), 0.0f);
  const float most = kMaxLimitShare * params.differential_limit_radps;
  for (int i = -740; i <= 740; ++i) {
    const float wanted = 0.01f * static_cast<float>(i);
    const float command = DifferentialCommand(params, wanted);
    ASSERT_NEAR(SettledDifferential(params, command), wanted, 2e-3f);
  }
  // Beyond what it can reach it stays finite.
  EXPECT_EQ(DifferentialCommand(params, 1e9f), DifferentialCommand(params, most * 1.01f));
  EXPECT_LT(DifferentialCommand(params, kInf), 20.0f);
  // The recorded spin: 13.5 rad/s reaches about 6.8 to 7.2.
  EXPECT_NEAR(SettledDifferential(params, 13.5f), 7.2f, 0.3f);
}

DriveModel MakeModel(const DynamicsParams& params = {}) {
  DriveModel model;
  EXPECT_EQ(model.Configure({}, {}, params), Status::kOk);
  EXPECT_EQ(model.Advance(kStart_ns, {}), Status::kStale);
  return model;
}

// Not driven by feedback, it stays with a vehicle that is as it thinks, through the dead time.
TEST(DriveModel, PredictsWhereTheVehicleWillBe) {
  DriveModel model = MakeModel();
  VehicleBench bench{TrueVehicle{}};
  VehicleBench ahead{TrueVehicle{}};
  std::vector<Pose2> promised;
  const auto command_at = [](int tick) {
    const double t = 0.01 * tick;
    return WheelParts{static_cast<float>(9.0 + 5.0 * std::sin(1.3 * t)),
                      static_cast<float>(3.0 * std::sin(2.1 * t))};
  };
  constexpr int kDead = 17;
  for (int tick = 0; tick < 600; ++tick) {
    const WheelParts command = command_at(tick);
    model.SetCommand(command);
    for (int ms = 0; ms < 10; ++ms) {
      bench.Step_ms({command.common_radps - command.differential_radps,
                     command.common_radps + command.differential_radps});
    }
    const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick + 1) * kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}), Status::kOk);
    const TruePose& pose = bench.pose();
    const Pose2 now = {static_cast<float>(pose.x_m), static_cast<float>(pose.y_m),
                       WrapAngle(static_cast<float>(pose.theta_rad))};
    promised.push_back(model.Predict(now).pose);
    if (tick < kDead) continue;
    const Pose2& then = promised[static_cast<size_t>(tick - kDead)];
    ASSERT_NEAR(now.x_m, then.x_m, 0.02) << tick;
    ASSERT_NEAR(now.y_m, then.y_m, 0.02) << tick;
    ASSERT_NEAR(WrapAngle(now.theta_rad - then.theta_rad), 0.0f, 0.01) << tick;
  }
  EXPECT_NEAR(model.wheels().common_radps, 0.5 * (bench.left_radps() + bench.right_radps()), 0.1);
}

// A gain that is a quarter less than what it knows: the measured speeds teach it.
TEST(DriveModel, LearnsWhatItsGainDoesNotKnow) {
  TrueVehicle weak;
  weak.differential_gain *= 0.75;
  DriveModel model = MakeModel();
  VehicleBench bench(weak);
  model.SetCommand({8.0f, 3.0f});
  for (int tick = 1; tick <= 500; ++tick) {
    for (int ms = 0; ms < 10; ++ms) bench.Step_ms({5.0f, 11.0f});
    const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick) * kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, tick % 2 == 0 ? FeedbackOf(bench, now_ns) : WheelFeedback{}),
              Status::kOk);
  }
  const float differential = 0.5f * static_cast<float>(bench.right_radps() - bench.left_radps());
  EXPECT_NEAR(model.wheels().differential_radps, differential, 0.02f);
  EXPECT_NEAR(model.Predict({}).wheels.differential_radps, differential, 0.05f);
  EXPECT_LT(model.bias().differential_radps, -0.4f);
  EXPECT_GE(model.bias().differential_radps, -DriveModel::kMaxBias_radps);
}

// Drives that turn twice as quickly, and ones that are slower than the fit: the first turns tell.
TEST(DriveModel, LearnsHowQuicklyTheVehicleTurns) {
  for (const double lag_s : {0.48, 0.91, 1.15}) {
    TrueVehicle other;
    other.differential_lag_s = lag_s;
    DriveModel model = MakeModel();
    VehicleBench bench(other);
    for (int tick = 1; tick <= 600; ++tick) {
      const float turn = tick % 120 < 60 ? 4.0f : -4.0f;
      model.SetCommand({8.0f, turn});
      for (int ms = 0; ms < 10; ++ms) bench.Step_ms({8.0f - turn, 8.0f + turn});
      const uint64_t now_ns = kStart_ns + static_cast<uint64_t>(tick) * kTick_ns;
      ASSERT_EQ(model.Advance(now_ns, tick % 2 == 0 ? FeedbackOf(bench, now_ns) : WheelFeedback{}),
                Status::kOk);
      ASSERT_GE(model.quickness(), DriveModel::kMinQuickness);
      ASSERT_LE(model.quickness(), DriveModel::kMaxQuickness);
    }
    EXPECT_NEAR(model.DifferentialLag_s(), lag_s, 0.2 * lag_s);
  }
}

TEST(DriveModel, TakesNoFeedbackThatIsNoneOrOldOrTheSameTwice) {
  DriveModel model = MakeModel();
  model.SetCommand({5.0f, 0.0f});
  uint64_t now_ns = kStart_ns;
  for (int tick = 0; tick < 100; ++tick) {
    now_ns += kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}), Status::kOk);
  }
  const float before = model.wheels().common_radps;
  const WheelFeedback bad[] = {
      {.valid = true, .time_ns = now_ns, .left_radps = kNan, .right_radps = 1.0f},
      {.valid = true, .time_ns = now_ns, .left_radps = 1.0f, .right_radps = kInf},
      {.valid = true, .time_ns = now_ns, .left_radps = 1e9f, .right_radps = 0.0f},
      {.valid = false, .time_ns = now_ns, .left_radps = 1.0f, .right_radps = 1.0f},
      {.valid = true, .time_ns = now_ns - 400'000'000, .left_radps = 1.0f, .right_radps = 1.0f}};
  for (const WheelFeedback& feedback : bad) {
    ASSERT_EQ(model.Advance(now_ns, feedback), Status::kOk);
    ASSERT_EQ(model.wheels().common_radps, before);
  }
  const WheelFeedback good = {
      .valid = true, .time_ns = now_ns, .left_radps = 3.0f, .right_radps = 3.0f};
  ASSERT_EQ(model.Advance(now_ns, good), Status::kOk);
  const float after = model.wheels().common_radps;
  EXPECT_LT(after, before);
  ASSERT_EQ(model.Advance(now_ns, good), Status::kOk);
  EXPECT_EQ(model.wheels().common_radps, after);
}

TEST(DriveModel, ForgetsItsCommandsAfterAGap) {
  DriveModel model = MakeModel();
  model.SetCommand({10.0f, 2.0f});
  uint64_t now_ns = kStart_ns;
  for (int tick = 0; tick < 100; ++tick) {
    now_ns += kTick_ns;
    ASSERT_EQ(model.Advance(now_ns, {}), Status::kOk);
  }
  // A late tick is made up for ...
  now_ns += 15 * kTick_ns;
  ASSERT_EQ(model.Advance(now_ns, {}), Status::kOk);
  EXPECT_GT(model.wheels().common_radps, 8.0f);
  // ... a pause is not: the wheels are what they are measured to be.
  now_ns += 200 * kTick_ns;
  const WheelFeedback slow = {
      .valid = true, .time_ns = now_ns, .left_radps = 1.0f, .right_radps = 1.0f};
  EXPECT_EQ(model.Advance(now_ns, slow), Status::kStale);
  EXPECT_EQ(model.wheels().common_radps, 1.0f);
  EXPECT_EQ(model.bias().common_radps, 0.0f);
  EXPECT_LT(model.Predict({}).wheels.common_radps, 1.0f);
  EXPECT_EQ(model.Advance(now_ns - 1, slow), Status::kInvalidArgument);
  // However long: up to the end of time.
  EXPECT_EQ(model.Advance(std::numeric_limits<uint64_t>::max(), {}), Status::kStale);
}

TEST(DriveModel, GivesBackAPoseThatIsNone) {
  DriveModel model = MakeModel();
  model.SetCommand({5.0f, 1.0f});
  ASSERT_EQ(model.Advance(kStart_ns + kTick_ns, {}), Status::kOk);
  EXPECT_TRUE(std::isnan(model.Predict({kNan, 0.0f, 0.0f}).pose.x_m));
  EXPECT_TRUE(std::isinf(model.Predict({0.0f, 0.0f, kInf}).pose.theta_rad));
  EXPECT_TRUE(std::isfinite(model.Predict({0.0f, 0.0f, 1e30f}).pose.theta_rad));
}

TEST(DriveModel, TakesTheEndsOfItsParameters) {
  for (const float dead_s : {0.0f, 0.004f, 0.5f}) {
    DynamicsParams params;
    params.dead_time_s = dead_s;
    params.common_lag_s = 0.05f;
    params.differential_lag_s = 0.05f;
    DriveModel model = MakeModel(params);
    model.SetCommand({5.0f, 1.0f});
    for (int tick = 1; tick <= 200; ++tick) {
      ASSERT_EQ(model.Advance(kStart_ns + static_cast<uint64_t>(tick) * kTick_ns, {}), Status::kOk);
    }
    EXPECT_NEAR(model.wheels().common_radps, 5.0f, 0.01f);
    EXPECT_NEAR(model.Predict({}).pose.x_m, 5.0f * model.RimWay_m() * dead_s, 0.02f);
  }
  DynamicsParams params;
  params.common_lag_s = 0.0f;
  DriveModel model;
  EXPECT_EQ(model.Configure({}, {}, params), Status::kParameterOutOfRange);
  EXPECT_EQ(model.Advance(kStart_ns, {}), Status::kNotStarted);
}

}  // namespace
}  // namespace hardpack::testing
