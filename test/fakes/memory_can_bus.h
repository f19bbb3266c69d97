// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "hal/can_bus.h"
#include "port_linux/can_send_queue.h"

namespace hardpack::fakes {

class MemoryCanBus;

// The wire that MemoryCanBus ends are on. A frame reaches the others within the Send that gave it.
class MemoryCanWire {
 public:
  // Nobody acknowledges: what is handed over stays in the controllers until this ends.
  void Stall();
  void Resume();
  bool stalled() const { return stalled_; }

  // What a sender that is no end puts on the wire.
  void Put(const CanFrame& frame) { Carry(frame, nullptr); }
  // What no bus can carry, and a virtual one does.
  void PutMalformed();

 private:
  friend class MemoryCanBus;
  void Carry(const CanFrame& frame, const MemoryCanBus* from);

  std::vector<MemoryCanBus*> ends_;
  bool stalled_ = false;
};

// One end of an in-memory bus, with the faults of a real one on request. Goes by the time that
// Advance is given, and by nothing else: the same script gives the same frames.
//
//   MemoryCanWire wire;
//   MemoryCanBus vehicle(wire), drives(wire);
//   vehicle.Advance(now_ns);
//   vehicle.Send(frame, now_ns + 20'000'000);   // drives.Receive gives it
class MemoryCanBus final : public CanBus {
 public:
  // From bus-off to the bus; as SocketCanBus's first.
  static constexpr uint64_t kRecovery_ns = 100'000'000;
  // Frames that nobody takes, of the others.
  static constexpr size_t kReceiveCapacity = 1024;

  explicit MemoryCanBus(MemoryCanWire& wire) : wire_(wire) { wire_.ends_.push_back(this); }
  MemoryCanBus(const MemoryCanBus&) = delete;
  MemoryCanBus& operator=(const MemoryCanBus&) = delete;
  ~MemoryCanBus() { std::erase(wire_.ends_, this); }

  // --- the script ---
  void TakeDown() {
    if (up_) ++counters_.went_down;
    up_ = false;
    bus_off_ = false;
    error_state_ = CanBusState::kActive;
    DropAll();
  }
  void BringUp() { up_ = true; }
  // Whether bus-off is recovered from, and old frames are dropped, by a restart; else bus-off
  // stays.
  void PermitRestart(bool permitted) { may_restart_ = permitted; }
  void EnterBusOff() {
    ++counters_.error_frames;
    ++counters_.bus_offs;
    bus_off_ = true;
    recovered_ns_ = now_ns_ + kRecovery_ns;
    DropAll();
  }
  // kActive, kWarning or kPassive.
  void SetErrorState(CanBusState state) {
    ++counters_.error_frames;
    error_state_ = state;
  }
  // The next Send gives kSystemError.
  void FailOnce() { fails_ = true; }

  // --- CanBus ---
  void Advance(uint64_t now_ns) override {
    now_ns_ = std::max(now_ns_, now_ns);
    if (bus_off_ && may_restart_ && now_ns_ >= recovered_ns_) Restart();
    Expire(queue_.DropExpired(now_ns_));
    if (may_restart_ && queue_.IsStale(now_ns_)) Restart();
    HandOver();
  }

  Status Send(const CanFrame& frame, uint64_t deadline_ns) override {
    const Status status = Accept(frame, deadline_ns);
    ++(IsUsable(status) ? counters_.accepted : counters_.refused);
    if (IsUsable(status)) HandOver();
    return status;
  }

  Status Receive(CanFrame& frame) override {
    if (received_.empty()) return Status::kEmpty;
    frame = received_.front();
    received_.pop_front();
    ++counters_.received;
    return Status::kOk;
  }

  CanBusState state() const override {
    if (!up_) return CanBusState::kDown;
    return bus_off_ ? CanBusState::kBusOff : error_state_;
  }
  const CanBusCounters& counters() const override { return counters_; }

 private:
  friend class MemoryCanWire;

  bool hears() const { return up_ && !bus_off_; }

  Status Accept(const CanFrame& frame, uint64_t deadline_ns) {
    if (!IsValid(frame)) return Status::kInvalidArgument;
    if (!up_) return Status::kInterfaceDown;
    if (bus_off_) return Status::kBusOff;
    if (deadline_ns <= now_ns_) return Status::kExpired;
    if (std::exchange(fails_, false)) {
      ++counters_.system_errors;
      return Status::kSystemError;
    }
    return queue_.Add(frame, deadline_ns);
  }

  void HandOver() {
    while (hears() && queue_.CanHandOver()) {
      outstanding_.push_back(queue_.next());
      queue_.HandedOver();
      if (!wire_.stalled()) Transmit();
    }
  }

  // What was handed over goes.
  void Transmit() {
    while (!outstanding_.empty()) {
      const CanFrame frame = outstanding_.front();
      outstanding_.pop_front();
      if (queue_.Confirm(frame)) ++counters_.confirmed;
      wire_.Carry(frame, this);
    }
  }

  void Hear(const CanFrame& frame) {
    if (!hears()) return;
    if (received_.size() >= kReceiveCapacity) {
      ++counters_.lost;
    } else {
      received_.push_back(frame);
    }
  }

  void Restart() {
    ++counters_.restarts;
    bus_off_ = false;
    error_state_ = CanBusState::kActive;
    Expire(queue_.ForgetUnconfirmed());
    outstanding_.clear();
  }

  void DropAll() {
    Expire(queue_.DropWaiting());
    Expire(queue_.ForgetUnconfirmed());
    outstanding_.clear();
  }

  void Expire(int frames) { counters_.expired += static_cast<uint64_t>(frames); }

  MemoryCanWire& wire_;
  CanSendQueue queue_;
  CanBusCounters counters_;
  std::deque<CanFrame> outstanding_;  // handed over, not yet on the wire
  std::deque<CanFrame> received_;
  CanBusState error_state_ = CanBusState::kActive;
  bool up_ = true;
  bool bus_off_ = false;
  bool may_restart_ = true;
  bool fails_ = false;
  uint64_t now_ns_ = 0;
  uint64_t recovered_ns_ = 0;
};

inline void MemoryCanWire::Stall() {
  stalled_ = true;
}

inline void MemoryCanWire::Resume() {
  stalled_ = false;
  for (MemoryCanBus* end : ends_) end->Transmit();
}

inline void MemoryCanWire::Carry(const CanFrame& frame, const MemoryCanBus* from) {
  for (MemoryCanBus* end : ends_) {
    if (end != from) end->Hear(frame);
  }
}

inline void MemoryCanWire::PutMalformed() {
  for (MemoryCanBus* end : ends_) {
    if (end->hears()) ++end->counters_.malformed;
  }
}

}  // namespace hardpack::fakes
