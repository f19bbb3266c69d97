// SPDX-License-Identifier: Apache-2.0
#include "hal/twist_drive/twist_drive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/kinematics/kinematics.h"
#include "test/hal/twist_drive/controller.h"

namespace hardpack::twist_drive {
namespace {

constexpr DriveDemand kAhead = {true, false, {5.0f, 5.0f}};  // 1.5 m/s
constexpr DriveDemand kEnabled = {true, false, {}};

VehicleParams Ackermann() {
  VehicleParams vehicle;
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.wheelbase_m = 1.5f;
  vehicle.max_steering_rad = 0.45f;
  return vehicle;
}

TEST(TwistDrive, TellsABodySpeedAndAYawRate) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  ASSERT_TRUE(bench.State().enabled);
  bench.Tick({true, false, {4.0f, 6.0f}});
  EXPECT_EQ(bench.Sent().speed, 1500);  // 0.3 m * 5 rad/s
  EXPECT_EQ(bench.Sent().turn, std::lround(0.3 * 2.0 / 1.87 * 1000.0));
  EXPECT_EQ(bench.Sent().turn_kind, TurnKind::kYawRate);
}

TEST(TwistDrive, MeasuresBodySpeedAndYawRateAsWheels) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  bench.Ticks(200, {true, false, {4.0f, 6.0f}});
  EXPECT_NEAR(bench.State().wheels.left_radps, 4.0f, 0.01f);
  EXPECT_NEAR(bench.State().wheels.right_radps, 6.0f, 0.01f);
  EXPECT_TRUE(bench.State().wheels.valid);
  EXPECT_FALSE(bench.State().standstill);
}

TEST(TwistDrive, TellsAndMeasuresASteeringAngle) {
  TwistDriveParams params;
  params.turn = TwistDriveParams::kSteering;
  const VehicleParams vehicle = Ackermann();
  Bench bench(vehicle, params, TurnKind::kSteering);
  bench.Ticks(30, kEnabled);
  // v = 1.5 m/s and kappa = 0.2 / m: delta = atan(0.3), w = 0.3 rad/s
  const float side_radps = 0.5f * 0.3f * vehicle.skid_baseline_m / vehicle.wheel_radius_m;
  const DriveDemand bend = {true, false, {5.0f - side_radps, 5.0f + side_radps}};
  bench.Ticks(200, bend);
  EXPECT_EQ(bench.Sent().turn_kind, TurnKind::kSteering);
  EXPECT_NEAR(bench.Sent().turn, std::atan(0.3) * 10000.0, 1.0);
  EXPECT_NEAR(bench.drive.report().yaw_rate_radps, 0.3f, 0.001f);
  EXPECT_NEAR(bench.State().wheels.right_radps - bench.State().wheels.left_radps, 2.0f * side_radps,
              0.01f);
  // Told to stop it brakes along its way.
  bench.Ticks(5, kEnabled);
  EXPECT_EQ(bench.Sent().speed, 0);
  EXPECT_NEAR(bench.Sent().turn, std::atan(0.3) * 10000.0, 1.0);
}

// SR-PLN05 SR-PLN06
TEST(TwistDrive, SteersNoFurtherThanTheVehicleCanAndDoesNotTurnWhereItStands) {
  Bench bench(Ackermann());
  bench.Ticks(30, kEnabled);
  bench.Tick({true, false, {-5.0f, 5.0f}});
  EXPECT_EQ(bench.Sent().speed, 0);
  EXPECT_EQ(bench.Sent().turn, 0);
  bench.Tick({true, false, {2.0f, 8.0f}});
  EXPECT_NEAR(bench.Sent().turn, 1500.0 * double{MostCurvature(Ackermann())}, 1.0);
}

TEST(TwistDrive, DrivesOnlyOneThatFollows) {
  Bench bench;
  bench.controller.may_follow = false;
  bench.Ticks(100, kAhead);
  EXPECT_TRUE(bench.State().ready);
  EXPECT_FALSE(bench.State().enabled);
  EXPECT_TRUE(bench.Sent().enable);
  EXPECT_EQ(bench.Sent().speed, 0);
  bench.Ticks(300, kAhead);
  EXPECT_EQ(bench.drive.report().fault, Fault::kEnableTimeout);
  bench.Ticks(600, kAhead);
  EXPECT_FALSE(bench.Sent().enable);
}

TEST(TwistDrive, StopsFirstAndDisablesThen) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  bench.Ticks(200, kAhead);
  bench.Tick({});
  EXPECT_TRUE(bench.Sent().enable);
  EXPECT_EQ(bench.Sent().speed, 0);
  EXPECT_FALSE(bench.drive.AreOff(bench.now_ns));
  int ticks = 0;
  while (bench.Sent().enable && ++ticks < 1000) bench.Tick({});
  EXPECT_TRUE(bench.State().standstill);
  EXPECT_GT(ticks, 73 + 49) << "1.5 to 0.03 m/s at 2 m/s^2, and the delay";
  EXPECT_LT(ticks, 75 + 60);
  bench.Ticks(3, {});
  EXPECT_TRUE(bench.drive.AreOff(bench.now_ns));
}

TEST(TwistDrive, TellsApartWhatIsWrong) {
  const auto fault_after = [](auto&& breaks) {
    Bench bench;
    bench.Ticks(30, kEnabled);
    bench.Ticks(50, kAhead);
    EXPECT_EQ(bench.drive.report().fault, Fault::kNone);
    breaks(bench);
    bench.Ticks(30, kAhead);
    EXPECT_TRUE(bench.State().faulty);
    EXPECT_FALSE(bench.State().ready || bench.State().enabled);
    EXPECT_EQ(bench.Sent().speed, 0);
    return bench.drive.report().fault;
  };
  EXPECT_EQ(fault_after([](Bench& bench) { bench.speaks = false; }), Fault::kSilent);
  EXPECT_EQ(fault_after([](Bench& bench) { bench.controller.hears = false; }), Fault::kNotHeard);
  EXPECT_EQ(fault_after([](Bench& bench) { bench.controller.fault = true; }), Fault::kController);
  EXPECT_EQ(fault_after([](Bench& bench) { bench.controller.may_follow = false; }),
            Fault::kDropped);
  EXPECT_EQ(fault_after([](Bench& bench) { bench.controller.version = 2; }), Fault::kWrongVersion);
}

TEST(TwistDrive, AControllerThatMeasuresAnotherTurnIsNotDriven) {
  Bench bench({}, {}, TurnKind::kSteering);
  bench.Ticks(100, kAhead);
  EXPECT_EQ(bench.drive.report().fault, Fault::kWrongTurn);
  EXPECT_FALSE(bench.Sent().enable);
}

TEST(TwistDrive, ForgetsAFaultWhenItIsTold) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  bench.controller.fault = true;
  bench.Ticks(700, kAhead);
  EXPECT_TRUE(bench.State().faulty);
  EXPECT_FALSE(bench.Sent().enable);
  bench.Ticks(20, {false, true, {}});
  EXPECT_FALSE(bench.controller.fault) << "it was not told";
  EXPECT_TRUE(bench.State().ready);
  bench.Ticks(50, kEnabled);
  EXPECT_TRUE(bench.State().enabled);
}

TEST(TwistDrive, AFaultThatStaysComesAgain) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  bench.controller.fault = true;
  bench.controller.hears = false;
  bench.Ticks(700, {});
  bench.Ticks(90, {false, true, {}});
  EXPECT_FALSE(bench.State().faulty) << "it is given a second";
  EXPECT_FALSE(bench.State().ready);
  bench.Ticks(30, {});
  EXPECT_TRUE(bench.State().faulty);
}

TEST(TwistDrive, ARepeatedReportIsNoNews) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  const CanFrame same = bench.controller.FeedbackFrame();
  bench.speaks = false;
  for (int tick = 0; tick < 20; ++tick) {
    bench.drive.TakeFrame(same, bench.now_ns);
    bench.Tick(kAhead);
  }
  EXPECT_EQ(bench.drive.report().fault, Fault::kSilent);
  EXPECT_EQ(bench.drive.counters().frames_repeated, 20u);
}

TEST(TwistDrive, CountsReportsThatAreMissing) {
  Bench bench;
  bench.Ticks(20, kEnabled);
  EXPECT_EQ(bench.drive.counters().frames_missed, 0u);
  bench.speaks = false;
  bench.Ticks(3, kEnabled);
  bench.speaks = true;
  bench.Ticks(5, kEnabled);
  EXPECT_EQ(bench.drive.counters().frames_missed, 3u);
  EXPECT_FALSE(bench.State().faulty);
}

// A frame that waited in a queue is as old as it is.
TEST(TwistDrive, AnOldReportIsStale) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  CanFrame old = bench.controller.FeedbackFrame();
  bench.controller.Step();
  old = bench.controller.FeedbackFrame();
  old.received_ns = bench.now_ns - 400'000'000;
  bench.drive.TakeFrame(old, bench.now_ns);
  EXPECT_FALSE(bench.State().wheels.valid);
  EXPECT_FALSE(bench.State().standstill);
}

TEST(TwistDrive, SomebodyElsesCommandsAreTold) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  EXPECT_FALSE(bench.State().foreign_sender);
  bench.drive.TakeFrame(Encode(0x210, Command{}), bench.now_ns);
  EXPECT_TRUE(bench.State().foreign_sender);
  bench.Ticks(190, {});
  EXPECT_TRUE(bench.State().foreign_sender);
  bench.Ticks(20, {});
  EXPECT_FALSE(bench.State().foreign_sender);
}

TEST(TwistDrive, MalformedFramesAndThoseOfOthersAreCounted) {
  Bench bench;
  CanFrame bad = Encode(0x211, Feedback{});
  bad.data[7] ^= 1;
  bench.drive.TakeFrame(bad, bench.now_ns);
  CanFrame status = Encode(0x212, ControllerStatus{});
  status.size = 3;
  bench.drive.TakeFrame(status, bench.now_ns);
  CanFrame other;
  other.id = 0x100;
  bench.drive.TakeFrame(other, bench.now_ns);
  other.id = 0x211;
  other.extended = true;
  bench.drive.TakeFrame(other, bench.now_ns);
  EXPECT_EQ(bench.drive.counters().frames_malformed, 2u);
  EXPECT_EQ(bench.drive.counters().frames_ignored, 2u);
  EXPECT_EQ(bench.drive.report().feedback_ns, 0u);
}

TEST(TwistDrive, WhatIsNoNumberIsZero) {
  Bench bench;
  bench.Ticks(30, kEnabled);
  bench.Ticks(50, kAhead);
  for (const float wrong :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    bench.Tick({true, false, {wrong, 5.0f}});
    EXPECT_EQ(bench.Sent().speed, 0);
    EXPECT_EQ(bench.Sent().turn, 0);
  }
}

TEST(TwistDrive, RefusesParametersThatDoNotGoTogether) {
  TwistDrive drive;
  TwistDriveParams params;
  params.feedback_id = params.command_id;
  EXPECT_EQ(drive.Configure({}, params), Status::kInvalidArgument);
  params = {};
  params.turn = TwistDriveParams::kSteering;
  EXPECT_EQ(drive.Configure({}, params), Status::kInvalidArgument) << "it has no steering";
  EXPECT_EQ(drive.Configure(Ackermann(), params), Status::kOk);
  params = {};
  params.echo_timeout_ms = 5;
  EXPECT_EQ(drive.Configure({}, params), Status::kParameterOutOfRange);
  CanBatch out;
  drive.Tick(1'000'000'000, kAhead, out);
  EXPECT_TRUE(out.empty());
}

}  // namespace
}  // namespace hardpack::twist_drive
