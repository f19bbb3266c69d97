// SPDX-License-Identifier: Apache-2.0
#pragma once

// The whole tick with any interleaving of bytes and time. A simulated vehicle has driven for some
// seconds (tick_recording.h); what came in the ticks behind that is recorded, and each input is a
// script that plays the recording to a copy of the state: it loses, repeats, heaps up, reorders,
// cuts and changes datagrams and frames, adds its own bytes, lets time pass or stand, changes the
// bus and gives commands.
//   byte 0  bit 0: driving, else standing; bit 1: the second copy is given a flight log; bit 2,
//   where
//           it drives: something stands too near ahead
//
// Required of every tick (tick_checks.h): what is sent are frames a bus can carry, and what a drive
// reads there is within the wheels' limits, and zero where the mode does not permit to move;
// nothing is followed on inputs that are too old, and no path at all on what is far too old, nor
// after zero speed at once before the wheels stand; a safe stop ends in time; the state is finite;
// everything that came is counted, and no more is taken than a tick may take; a tick that cannot be
// changes nothing but a counter. And a second copy that is given the same, or what a flight log of
// it says, decides the same.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "test/fuzz/accepted.h"
#include "test/fuzz/fuzzed_vehicle.h"
#include "test/fuzz/mapper_script.h"
#include "test/fuzz/tick_checks.h"
#include "test/fuzz/tick_log.h"
#include "test/fuzz/tick_recording.h"

namespace hardpack {

inline constexpr int kMostTicks = 48;

class Play {
 public:
  Play(const uint8_t* data, size_t size)
      : script_(data, size), choice_(script_.Byte()), recording_(RecordingOf(scene())) {
    std::memcpy(static_cast<void*>(loop_.get()), recording_.state.data(), sizeof(FuzzedLoop));
    std::memcpy(static_cast<void*>(twin_.get()), recording_.state.data(), sizeof(FuzzedLoop));
    index_ = recording_.index;
    now_ns_ = recording_.now_ns;
    checks_.Begin();
    if ((choice_ & 2) != 0) log_.emplace();
  }

  void Run() {
    for (int i = 0; i < kMostTicks && !script_.ended(); ++i) Tick();
    if (log_.has_value()) log_->DoAgain(*twin_);
    Accepted(log_.has_value() ? "log" : "twin");
    Accepted(followed_ ? "driving" : scene() == Scene::kBlocked ? "blocked" : "standing");
  }

 private:
  Scene scene() const {
    if ((choice_ & 1) == 0) return Scene::kStanding;
    return (choice_ & 4) == 0 ? Scene::kDriving : Scene::kBlocked;
  }

  void Tick() {
    Take();
    command_.clear();
    const uint8_t changes = script_.Byte() % 4u;
    for (uint8_t i = 0; i < changes; ++i) Change();
    std::vector<TickDatagram> datagrams;
    for (size_t i = 0; i < tick_.bytes.size(); ++i) {
      datagrams.push_back({tick_.sources[i], tick_.bytes[i]});
    }
    now_ns_ += step_ns_;
    step_ns_ = kTick_ns;
    const TickInput input = {++index_, now_ns_, bus_, datagrams, tick_.frames, command_};
    if (log_.has_value()) log_->BeginTick(input, *loop_);
    checks_.Before(input);
    const Status status = loop_->Tick(input, output_);
    if (log_.has_value()) {
      log_->EndTick(input, status, *loop_, output_);
    } else {
      Require(twin_->Tick(input, twin_output_) == status);
      Require(loop_->decision_hash() == twin_->decision_hash());
    }
    checks_.After(input, status, output_);
    followed_ = followed_ || loop_->permission().motion == Motion::kFollow;
  }

  void Take() { tick_ = recording_.ticks[next_++ % recording_.ticks.size()]; }

  void Change() {
    const uint8_t what = script_.Byte();
    const size_t count = tick_.bytes.size();
    const size_t which = count == 0 ? 0 : script_.Byte() % count;
    switch (what % 16) {
      case 0:  // lost
        if (count > 0) Drop(which);
        return;
      case 1:  // all of one source
        DropAll(static_cast<InputSource>(script_.Byte() % 3u));
        return;
      case 2:  // twice
        if (count > 0) Add(tick_.sources[which], tick_.bytes[which]);
        return;
      case 3:  // out of order
        if (count > 1) std::swap(tick_.bytes[which], tick_.bytes[count - 1]);
        if (count > 1) std::swap(tick_.sources[which], tick_.sources[count - 1]);
        return;
      case 4:  // cut
        if (count > 0) tick_.bytes[which].resize(script_.Two() % (tick_.bytes[which].size() + 1));
        return;
      case 5:  // those of the ticks behind come with it, as after a late one
        return HeapUp();
      case 6:  // changed: a byte, or several in a row
      case 7:
        if (count > 0) Corrupt(tick_.bytes[which]);
        return;
      case 8:  // somebody else's
        AddOwn();
        return;
      case 9:
        step_ns_ = script_.Four();
        return;
      case 10:
        step_ns_ = script_.Byte() == 0 ? 0 : step_ns_ + uint64_t{script_.Byte()} * kTick_ns;
        return;
      case 11:
        // One that there is not, too; but a log refuses that one.
        bus_ = static_cast<CanBusState>(script_.Byte() % (kCanBusStates + (log_ ? 0u : 1u)));
        return;
      case 12:
        tick_.frames.resize(tick_.frames.size() / 2);
        return;
      case 13:
        ChangeFrame();
        return;
      case 14:
        Command();
        return;
      default:  // a jump of the recording, a missed tick
        next_ += script_.Byte();
        index_ += script_.Byte() % 4u;
        return;
    }
  }

  void Drop(size_t which) {
    tick_.bytes.erase(tick_.bytes.begin() + static_cast<std::ptrdiff_t>(which));
    tick_.sources.erase(tick_.sources.begin() + static_cast<std::ptrdiff_t>(which));
  }

  void DropAll(InputSource source) {
    for (size_t i = tick_.bytes.size(); i > 0; --i) {
      if (tick_.sources[i - 1] == source) Drop(i - 1);
    }
  }

  void HeapUp() {
    const uint8_t ticks = script_.Byte() % 8u;
    for (uint8_t i = 0; i < ticks; ++i) {
      const RecordedTick& next = recording_.ticks[next_++ % recording_.ticks.size()];
      for (size_t k = 0; k < next.bytes.size(); ++k) Add(next.sources[k], next.bytes[k]);
    }
  }

  // At most one more than a tick takes, which is refused; a log is not given such.
  void Add(InputSource source, std::vector<uint8_t> bytes) {
    const size_t most = FuzzedLoop::kMaxDatagramsPerTick + (log_ ? 0u : 1u);
    if (tick_.bytes.size() >= most) return;
    tick_.sources.push_back(source);
    tick_.bytes.push_back(std::move(bytes));
  }

  void Corrupt(std::vector<uint8_t>& bytes) {
    if (bytes.empty()) return;
    const size_t at = script_.Two() % bytes.size();
    const uint8_t length = script_.Byte() % 16u + 1u;
    for (size_t i = at; i < bytes.size() && i < at + length; ++i) bytes[i] = script_.Byte();
  }

  void AddOwn() {
    std::vector<uint8_t> bytes(script_.Two() % 2048u);
    for (uint8_t& byte : bytes) byte = script_.Byte();
    const auto source = static_cast<InputSource>(script_.Byte() % 3u);
    Add(source, std::move(bytes));
  }

  void ChangeFrame() {
    CanFrame frame;
    const bool known = !tick_.frames.empty() && (script_.Byte() & 1) != 0;
    if (known) {
      frame = tick_.frames[script_.Byte() % tick_.frames.size()];
      frame.data[script_.Byte() % 8u] = script_.Byte();
    } else {
      frame.id = script_.Two() % 0x800u;
      frame.size = script_.Byte() % 9u;
      for (uint8_t& byte : frame.data) byte = script_.Byte();
    }
    tick_.frames.push_back(frame);
  }

  void Command() {
    control::OperatorCommand command;
    command.kind = static_cast<control::Kind>(script_.Byte() % 16u);
    command.sequence = script_.Byte();
    command.waypoints = script_.Byte() % 3u;
    for (int32_t i = 0; i < command.waypoints; ++i) {
      command.waypoint[i].frame = static_cast<control::GoalFrame>(script_.Byte() % 4u);
      command.waypoint[i].position_m = {script_.Any(), script_.Any()};
    }
    uint8_t bytes[control::kMaxMessageBytes];
    int size = 0;
    if (!IsUsable(control::Encode(command, bytes, size))) return;
    command_.assign(bytes, bytes + size);
    if (script_.Byte() % 8u == 0) Corrupt(command_);
  }

  Script script_;
  uint8_t choice_;
  const Recording& recording_;
  std::unique_ptr<FuzzedLoop> loop_ = std::make_unique<FuzzedLoop>();
  std::unique_ptr<FuzzedLoop> twin_ = std::make_unique<FuzzedLoop>();
  uint64_t index_ = 0;
  uint64_t now_ns_ = 0;
  uint64_t step_ns_ = kTick_ns;
  bool followed_ = false;  // a path, in one of the ticks
  size_t next_ = 0;
  CanBusState bus_ = CanBusState::kActive;
  RecordedTick tick_;
  std::vector<uint8_t> command_;
  TickOutput output_;
  TickOutput twin_output_;
  TickChecks checks_{*loop_};
  std::optional<TickLog> log_;
};

}  // namespace hardpack
