// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "hal/sevcon/sevcon.h"
#include "test/hal/sevcon/scripted_drive.h"

// Two scripted drives and the pair on one bus, in ticks of 10 ms, with what always has to hold:
// never a speed other than zero unless both drives have said that they are enabled and neither has
// a fault, and never more frames than promised.

namespace hardpack::sevcon {

inline constexpr uint64_t kTick_ns = 10'000'000;

inline DriveParams BenchParams() {
  DriveParams params;
  params.gear_ratio = 30.0f;
  return params;
}

inline int32_t SpeedOf(const CanFrame& command) {
  uint32_t number = 0;
  for (int i = 5; i >= 2; --i) number = number << 8 | command.data[i];
  return static_cast<int32_t>(number);
}
inline int ControlwordOf(const CanFrame& command) {
  return command.data[0] | command.data[1] << 8;
}

class Bench {
 public:
  explicit Bench(const DriveParams& bench_params = BenchParams())
      : params(bench_params), left(bench_params.left_node), right(bench_params.right_node) {
    EXPECT_EQ(pair.Configure(params), Status::kOk);
  }
  // Drives that need no setting.
  static Bench WithDrivesSetUp() {
    Bench bench;
    bench.left.SetUp();
    bench.right.SetUp();
    return bench;
  }

  void Tick(const DriveDemand& demand = {}) {
    now_ns += kTick_ns;
    for (ScriptedDrive* drive : {&left, &right}) {
      drive->Step(now_ns);
      for (const CanFrame& frame : drive->outbox) {
        if (!drive->powered) continue;
        CanFrame come = frame;
        come.received_ns = age_ns == 0 ? 0 : now_ns - age_ns;
        Receive(come);
        if (drive->doubled && frame.id == 0x180u + static_cast<uint32_t>(drive->node))
          Receive(come);
      }
      drive->outbox.clear();
    }
    for (const CanFrame& frame : foreign) pair.TakeFrame(frame, now_ns);
    foreign.clear();
    CanBatch out;
    pair.Tick(now_ns, demand, out);
    sent.assign(out.begin(), out.end());
    history.insert(history.end(), sent.begin(), sent.end());
    CheckInvariants();
    for (const CanFrame& frame : sent) {
      left.Take(frame, now_ns);
      right.Take(frame, now_ns);
    }
  }
  void Run(int ticks, const DriveDemand& demand = {}) {
    for (int i = 0; i < ticks; ++i) Tick(demand);
  }
  // Until it holds; false after so many ticks.
  bool RunUntil(const std::function<bool()>& holds, const DriveDemand& demand = {},
                int ticks = 500) {
    for (int i = 0; i < ticks; ++i) {
      if (holds()) return true;
      Tick(demand);
    }
    return holds();
  }
  bool BringUp() {
    return RunUntil([&] { return pair.ready(); });
  }
  bool Drive(float left_radps, float right_radps) {
    return RunUntil([&] { return pair.enabled(); }, {true, false, {}}) &&
           RunUntil(
               [&] { return std::abs(left.speed_rpm) > 100 && std::abs(right.speed_rpm) > 100; },
               Wheels(left_radps, right_radps));
  }
  static DriveDemand Wheels(float left_radps, float right_radps) {
    return {true, false, {left_radps, right_radps}};
  }

  // The last command to a side in this tick; null: none.
  const CanFrame* CommandTo(Side side) const {
    const auto id = 0x200u + static_cast<uint32_t>(NodeOf(side));
    for (auto frame = sent.rbegin(); frame != sent.rend(); ++frame) {
      if (frame->id == id) return &*frame;
    }
    return nullptr;
  }
  bool ZeroWentToBoth() const {
    const CanFrame* a = CommandTo(Side::kLeft);
    const CanFrame* b = CommandTo(Side::kRight);
    return a != nullptr && b != nullptr && SpeedOf(*a) == 0 && SpeedOf(*b) == 0;
  }
  DriveFault FaultOf(Side side) const { return pair.report(side).fault; }
  DriveState StateOf(Side side) const { return pair.report(side).state; }
  int NodeOf(Side side) const { return side == Side::kLeft ? params.left_node : params.right_node; }
  int CountSent(uint32_t id) const {
    int count = 0;
    for (const CanFrame& frame : history) count += frame.id == id;
    return count;
  }

  DriveParams params;
  DrivePair pair;
  ScriptedDrive left, right;
  uint64_t now_ns = 1'000'000'000'000;
  uint64_t age_ns = 0;            // of what the drives send, by its stamp; 0: it has none
  std::vector<CanFrame> foreign;  // come in the next tick
  std::vector<CanFrame> sent;     // in the last tick
  std::vector<CanFrame> history;

 private:
  void Receive(const CanFrame& frame) {
    if (frame.id == 0x180u + static_cast<uint32_t>(params.left_node)) {
      left_enabled_ = (frame.data[0] & 0x6f) == 0x27;
    }
    if (frame.id == 0x180u + static_cast<uint32_t>(params.right_node)) {
      right_enabled_ = (frame.data[0] & 0x6f) == 0x27;
    }
    pair.TakeFrame(frame, now_ns);
  }
  void CheckInvariants() {
    EXPECT_LE(sent.size(), static_cast<size_t>(DrivePair::kMaxFramesPerTick));
    const bool has_fault =
        FaultOf(Side::kLeft) != DriveFault::kNone || FaultOf(Side::kRight) != DriveFault::kNone;
    for (const CanFrame& frame : sent) {
      EXPECT_TRUE(IsValid(frame));
      if (frame.id != 0x200u + static_cast<uint32_t>(params.left_node) &&
          frame.id != 0x200u + static_cast<uint32_t>(params.right_node)) {
        continue;
      }
      EXPECT_EQ(frame.size, 8);
      if (SpeedOf(frame) == 0) continue;
      EXPECT_TRUE(left_enabled_ && right_enabled_ && !has_fault);
    }
  }

  bool left_enabled_ = false;
  bool right_enabled_ = false;
};

}  // namespace hardpack::sevcon
