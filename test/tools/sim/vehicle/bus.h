// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

#include "hal/can_frame.h"
#include "tools/sim/vehicle/sevcon_drive.h"

// One simulated drive on a bus, spoken to by frames made by hand from the standards' tables.

namespace hardpack::sim::test {

inline CanFrame MakeFrame(uint32_t id, std::initializer_list<int> bytes) {
  CanFrame frame;
  frame.id = id;
  for (const int byte : bytes) frame.data[frame.size++] = static_cast<uint8_t>(byte);
  return frame;
}

class Bus {
 public:
  explicit Bus(const DriveSettings& settings = {}) : drive_(settings, 0) {}

  SevconDrive& drive() { return drive_; }
  const std::vector<CanFrame>& log() const { return log_; }
  double now_s() const { return 1.0e-9 * static_cast<double>(now_ns_); }

  void Run(double seconds) {
    now_ns_ += static_cast<uint64_t>(seconds * 1.0e9 + 0.5);
    drive_.Advance(now_ns_, log_);
  }
  void RunMs(int milliseconds) { Run(1.0e-3 * milliseconds); }

  void Send(const CanFrame& frame) {
    drive_.TakeFrame(frame, now_ns_);
    drive_.Advance(now_ns_, log_);
  }

  // The newest frame with this identifier since `from` in the log, or nothing.
  std::optional<CanFrame> Newest(uint32_t id, size_t from = 0) const {
    for (size_t i = log_.size(); i > from; --i) {
      if (log_[i - 1].id == id) return log_[i - 1];
    }
    return std::nullopt;
  }
  int Count(uint32_t id, size_t from = 0) const {
    return static_cast<int>(std::count_if(log_.begin() + static_cast<ptrdiff_t>(from), log_.end(),
                                          [id](const CanFrame& frame) { return frame.id == id; }));
  }

  // The answer to an SDO request to node 2.
  std::optional<CanFrame> Ask(const CanFrame& request) {
    const size_t from = log_.size();
    Send(request);
    return Newest(0x582, from);
  }

  std::optional<CanFrame> AskRead(int index, int sub) {
    return Ask(MakeFrame(0x602, {0x40, index & 0xff, index >> 8, sub, 0, 0, 0, 0}));
  }

  // 0: written; else the abort code. No answer at all: 1.
  uint32_t Write(int index, int sub, int64_t value, int bytes) {
    const int command = 0x23 | (4 - bytes) << 2;
    const auto byte = [&](int i) {
      return i < bytes ? static_cast<int>(value >> (8 * i) & 0xff) : 0;
    };
    const auto answer = Ask(MakeFrame(
        0x602, {command, index & 0xff, index >> 8, sub, byte(0), byte(1), byte(2), byte(3)}));
    if (!answer) return 1;
    if (answer->data[0] == 0x60) return 0;
    return Abort(*answer);
  }

  // The value without its sign; 2^32 and more: aborted or not answered.
  uint64_t Read(int index, int sub) {
    const auto answer = AskRead(index, sub);
    if (!answer || (answer->data[0] & 0xe3) != 0x43) return uint64_t{1} << 32;
    return Word(*answer);
  }

  static uint32_t Abort(const CanFrame& answer) {
    return answer.data[0] == 0x80 ? Word(answer) : 2;
  }
  static uint32_t Word(const CanFrame& frame) {
    uint32_t word = 0;
    for (int i = 7; i >= 4; --i) word = word << 8 | frame.data[i];
    return word;
  }

  // Boots, logs in, profile velocity mode, RPDO time-out, and starts node 2.
  void Start(int severity = 2) {
    Run(0.5);
    Write(0x5000, 3, 1, 2);
    Write(0x5000, 2, 0x1234, 2);
    Write(0x6060, 0, 3, 1);
    Write(0x6080, 0, 6000, 4);
    Write(0x5902, 0, severity, 1);
    Send(MakeFrame(0x000, {1, 2}));
  }

  // RPDO and SYNC every 10 ms: controlword, target velocity [rpm], torque limit.
  void Command(int controlword, int32_t rpm, double seconds) {
    const auto bits = static_cast<uint32_t>(rpm);
    for (int i = 0; i < static_cast<int>(100.0 * seconds + 0.5); ++i) {
      Send(
          MakeFrame(0x202, {controlword & 0xff, controlword >> 8, static_cast<int>(bits & 0xff),
                            static_cast<int>(bits >> 8 & 0xff), static_cast<int>(bits >> 16 & 0xff),
                            static_cast<int>(bits >> 24), 0xe8, 0x03}));
      Send(MakeFrame(0x080, {}));
      RunMs(10);
    }
  }

  void Enable() {
    Command(0x06, 0, 0.1);
    Command(0x07, 0, 0.1);
    Command(0x0f, 0, 0.1);
  }

 private:
  SevconDrive drive_;
  uint64_t now_ns_ = 0;
  std::vector<CanFrame> log_;
};

}  // namespace hardpack::sim::test
