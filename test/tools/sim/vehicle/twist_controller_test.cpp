// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/twist_controller.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "hal/twist_drive/twist_frames.h"

namespace hardpack::sim {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kTwistStart_ns = 3'000'000'000;

// The controller, and somebody who commands it every 10 ms.
class Bench {
 public:
  explicit Bench(const TwistControllerSettings& settings = {})
      : settings_(settings), controller(settings, kTwistStart_ns) {}

  void Tick(bool enable, double speed_mps, double turn = 0.0) {
    now_ns += kTick_ns;
    twist_drive::Command command;
    command.counter = ++counter_;
    command.enable = enable;
    command.reset_faults = resets;
    command.turn_kind =
        settings_.steers ? twist_drive::TurnKind::kSteering : twist_drive::TurnKind::kYawRate;
    command.speed = twist_drive::ToInteger(static_cast<float>(speed_mps), twist_drive::kPerMetre);
    command.turn = twist_drive::ToInteger(static_cast<float>(turn), settings_.steers
                                                                        ? twist_drive::kPerSteering
                                                                        : twist_drive::kPerYawRate);
    controller.TakeFrame(twist_drive::Encode(settings_.command_id, command), now_ns);
    Pass();
  }
  void Wait(double seconds) {
    for (int i = 0; i < static_cast<int>(100.0 * seconds); ++i) {
      now_ns += kTick_ns;
      Pass();
    }
  }
  // Ready: it has booted.
  void Boot() {
    Wait(settings_.boot_s + 0.02);
    ASSERT_EQ(controller.state(), TwistState::kReady);
  }

  uint64_t now_ns = kTwistStart_ns;
  bool resets = false;
  std::vector<CanFrame> sent;  // since the last tick or wait
  twist_drive::Feedback feedback;
  int bad_frames = 0;

 private:
  void Pass() {
    sent.clear();
    controller.Advance(now_ns, sent);
    for (const CanFrame& frame : sent) {
      if (frame.id != settings_.feedback_id) continue;
      if (!IsUsable(twist_drive::Decode(frame, feedback))) ++bad_frames;
    }
  }

  TwistControllerSettings settings_;
  uint8_t counter_ = 250;

 public:
  TwistController controller;
};

TEST(SimTwistController, SaysNothingUntilItHasBooted) {
  Bench bench;
  bench.Wait(1.4);
  EXPECT_EQ(bench.controller.state(), TwistState::kStarting);
  EXPECT_TRUE(bench.sent.empty());
  bench.Wait(0.2);
  EXPECT_EQ(bench.controller.state(), TwistState::kReady);
  EXPECT_FALSE(bench.sent.empty());
  EXPECT_EQ(bench.feedback.state, twist_drive::ControllerState::kReady);
  EXPECT_TRUE(bench.feedback.timed_out);
}

TEST(SimTwistController, FollowsWhileItIsEnabled) {
  Bench bench;
  bench.Boot();
  bench.Tick(false, 1.0);
  EXPECT_FALSE(bench.controller.motion().driven) << "not enabled";
  bench.Tick(true, 1.5, -0.2);
  const TwistController::Motion motion = bench.controller.motion();
  EXPECT_TRUE(motion.driven);
  EXPECT_NEAR(motion.speed_mps, 1.5, 1.0e-9);
  EXPECT_NEAR(motion.turn, -0.2, 1.0e-9);
  EXPECT_EQ(bench.feedback.echo, 252) << "the newest command";
  bench.controller.SetMeasured(1.25, -0.125);
  bench.Tick(true, 1.5, -0.2);
  EXPECT_EQ(bench.feedback.speed, 1250);
  EXPECT_EQ(bench.feedback.turn, -125);
  bench.Tick(false, 0.0);
  EXPECT_EQ(bench.controller.state(), TwistState::kStopping) << "it still moves";
  bench.controller.SetMeasured(0.0, 0.0);
  bench.Tick(false, 0.0);
  EXPECT_EQ(bench.controller.state(), TwistState::kReady);
  EXPECT_FALSE(bench.controller.motion().driven);
}

TEST(SimTwistController, BrakesByItselfWhenNothingComes) {
  Bench bench;
  bench.Boot();
  bench.Tick(true, 2.0);
  bench.controller.SetMeasured(2.0, 0.0);
  bench.Wait(0.19);
  EXPECT_EQ(bench.controller.state(), TwistState::kFollowing);
  bench.Wait(0.03);
  EXPECT_EQ(bench.controller.state(), TwistState::kStopping);
  EXPECT_TRUE(bench.feedback.timed_out);
  EXPECT_EQ(bench.controller.motion().speed_mps, 0.0);
}

TEST(SimTwistController, KeepsItsSteeringAngleWhileItBrakes) {
  TwistControllerSettings settings;
  settings.steers = true;
  Bench bench(settings);
  bench.Boot();
  bench.Tick(true, 2.0, 0.3);
  bench.controller.SetMeasured(2.0, 0.3);
  bench.Tick(true, 0.0, -0.1);
  EXPECT_NEAR(bench.controller.motion().turn, 0.3, 1.0e-9) << "a turn at speed 0";
  bench.Wait(0.3);
  EXPECT_EQ(bench.controller.state(), TwistState::kStopping);
  EXPECT_NEAR(bench.controller.motion().turn, 0.3, 1.0e-9);
  EXPECT_EQ(bench.feedback.turn_kind, twist_drive::TurnKind::kSteering);
}

TEST(SimTwistController, TakesNoFrameThatIsNotAsItShouldBe) {
  Bench bench;
  bench.Boot();
  twist_drive::Command command;
  command.counter = 7;
  command.enable = true;
  command.speed = 1000;
  const CanFrame good = twist_drive::Encode(0x210, command);
  const auto follows = [&bench](const CanFrame& frame) {
    bench.controller.TakeFrame(frame, bench.now_ns);
    bench.Wait(0.01);
    return bench.controller.state() == TwistState::kFollowing;
  };
  for (int byte = 0; byte < 8; ++byte) {
    CanFrame bad = good;
    bad.data[byte] = static_cast<uint8_t>(bad.data[byte] ^ 0x10u);
    EXPECT_FALSE(follows(bad)) << byte;
  }
  CanFrame shorter = good;
  shorter.size = 7;
  EXPECT_FALSE(follows(shorter));
  command.turn_kind = twist_drive::TurnKind::kSteering;
  EXPECT_FALSE(follows(twist_drive::Encode(0x210, command))) << "of the other kind";
  EXPECT_TRUE(follows(good));
  bench.Wait(0.3);
  EXPECT_FALSE(follows(good)) << "the same once more";
}

TEST(SimTwistController, HasFaultsUntilTheyAreReset) {
  Bench bench;
  bench.Boot();
  bench.Tick(true, 1.0);
  bench.controller.RaiseFault(0x8001);
  bench.Tick(true, 1.0);
  EXPECT_EQ(bench.controller.state(), TwistState::kFault);
  EXPECT_FALSE(bench.controller.motion().driven);
  twist_drive::ControllerStatus status;
  ASSERT_EQ(bench.sent.size(), 2u) << "a fault is told at once";
  ASSERT_TRUE(IsUsable(twist_drive::Decode(bench.sent[1], status)));
  EXPECT_EQ(status.faults, 0x8001);
  EXPECT_EQ(status.version, twist_drive::kVersion);
  bench.resets = true;
  bench.Tick(false, 0.0);
  EXPECT_EQ(bench.controller.state(), TwistState::kReady);
}

TEST(SimTwistController, CanBeMadeToMisbehave) {
  Bench bench;
  bench.Boot();
  bench.controller.SetMeasured(1.0, 0.0);
  bench.controller.faults().frozen = true;
  bench.Tick(true, 1.0);
  EXPECT_EQ(bench.feedback.speed, 0);
  bench.controller.faults().frozen = false;
  bench.controller.faults().bad_crc = true;
  bench.Tick(true, 1.0);
  EXPECT_EQ(bench.bad_frames, 1);
  bench.controller.faults() = {.silent = true};
  bench.Tick(true, 1.0);
  EXPECT_TRUE(bench.sent.empty());
  bench.controller.faults() = {.refuses = true};
  bench.Tick(true, 1.0);
  EXPECT_NE(bench.controller.state(), TwistState::kFollowing);
}

}  // namespace
}  // namespace hardpack::sim
