// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "hal/twist_drive/twist_drive.h"

// A motion controller as docs/twist_drive.md has it, and a bench with one at the drive.

namespace hardpack::twist_drive {

class Controller {
 public:
  explicit Controller(const TwistDriveParams& params, TurnKind turn_kind = TurnKind::kYawRate)
      : params_(params), turn_kind_(turn_kind) {}

  // What it is told, and 10 ms of its motion.
  void Take(const CanFrame& frame) {
    Command command;
    if (!hears || frame.id != static_cast<uint32_t>(params_.command_id) ||
        !IsUsable(Decode(frame, command))) {
      return;
    }
    since_command_ = 0;
    echo_ = command.counter;
    command_ = command;
    if (command.reset_faults) fault = false;
  }
  void Step() {
    ++since_command_;
    timed_out_ = since_command_ > 20;
    const bool wants = command_.enable && !timed_out_ && !fault && may_follow;
    if (fault) {
      state_ = ControllerState::kFault;
    } else if (wants) {
      state_ = ControllerState::kFollowing;
    } else if (state_ == ControllerState::kFollowing || state_ == ControllerState::kStopping) {
      state_ = speed_ == 0 ? ControllerState::kReady : ControllerState::kStopping;
    } else {
      state_ = ControllerState::kReady;
    }
    const bool follows = state_ == ControllerState::kFollowing;
    constexpr int kMostChange = 20;  // 2 m/s^2
    const int wanted = follows ? command_.speed : 0;
    speed_ += std::clamp(wanted - speed_, -kMostChange, kMostChange);
    turn_ = follows ? command_.turn : (turn_kind_ == TurnKind::kSteering ? turn_ : 0);
    ++counter_;
  }
  CanFrame FeedbackFrame() const {
    return Encode(static_cast<uint32_t>(params_.feedback_id),
                  Feedback{counter_, state_, turn_kind_, timed_out_, static_cast<int16_t>(speed_),
                           static_cast<int16_t>(turn_), echo_});
  }
  CanFrame StatusFrame() const {
    ControllerStatus status;
    status.counter = counter_;
    status.version = version;
    status.faults = fault ? 4 : 0;
    status.battery = 4800;
    return Encode(static_cast<uint32_t>(params_.status_id), status);
  }

  bool hears = true;
  bool may_follow = true;
  bool fault = false;
  uint8_t version = kVersion;

 private:
  TwistDriveParams params_;
  TurnKind turn_kind_;
  Command command_;
  ControllerState state_ = ControllerState::kReady;
  int speed_ = 0;
  int turn_ = 0;
  int since_command_ = 1000;
  bool timed_out_ = true;
  uint8_t counter_ = 250;  // soon over its end
  uint8_t echo_ = 0;
};

struct Bench {
  explicit Bench(const VehicleParams& vehicle = {}, const TwistDriveParams& params = {},
                 TurnKind turn_kind = TurnKind::kYawRate)
      : controller(params, turn_kind) {
    configured = drive.Configure(vehicle, params);
  }

  // 10 ms: what the controller sends, the drive's tick, what the controller takes.
  void Tick(const DriveDemand& demand) {
    now_ns += 10'000'000;
    controller.Step();
    if (speaks) {
      drive.TakeFrame(controller.FeedbackFrame(), now_ns);
      if (tick % 10 == 0) drive.TakeFrame(controller.StatusFrame(), now_ns);
    }
    ++tick;
    sent.Clear();
    drive.Tick(now_ns, demand, sent);
    for (const CanFrame& frame : sent) controller.Take(frame);
  }
  void Ticks(int count, const DriveDemand& demand) {
    for (int i = 0; i < count; ++i) Tick(demand);
  }
  DriveFeedback State() const { return drive.State(now_ns); }
  Command Sent() const {
    Command command;
    EXPECT_TRUE(!sent.empty() && IsUsable(Decode(sent[0], command)));
    return command;
  }

  Status configured = Status::kNotStarted;
  TwistDrive drive;
  Controller controller;
  CanBatch sent;
  bool speaks = true;
  uint64_t now_ns = 5'000'000'000;
  int tick = 0;
};

}  // namespace hardpack::twist_drive
