// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "hal/onboard/flight_log/flight_log.h"
#include "hal/recorder.h"

// Ticks with made-up inputs and outputs, to be logged: nothing decides anything here.

namespace hardpack::fakes {

struct MadeUpTick {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  std::vector<std::vector<uint8_t>> payloads;
  std::vector<TickDatagram> datagrams;
  std::vector<flight_log::Arrival> arrivals;
  std::vector<CanFrame> frames;
  std::vector<uint8_t> command;
  TickOutput output;
  uint64_t hash = 0;
};

inline CanFrame RandomFrame(std::mt19937& random) {
  CanFrame frame;
  frame.id = random() % 0x800;
  frame.size = static_cast<uint8_t>(random() % 9);
  for (int i = 0; i < frame.size; ++i) frame.data[i] = static_cast<uint8_t>(random());
  return frame;
}

class MadeUpRun {
 public:
  static constexpr uint64_t kStateLayout = 0x5151515151515151u;
  static constexpr int64_t kWallOffset_ns = 1'795'000'000'000'000'000;

  explicit MadeUpRun(Recorder& recorder, size_t state_bytes = 300'000, uint32_t seed = 1)
      : random_(seed), state_(state_bytes), snapshot_(state_bytes), log_(recorder, snapshot_) {
    configuration_.assign(70'000, 'c');
    metadata_ = "{\"metadata\": true}";
    flight_log::FlightLogSetup setup;
    setup.version.run = 0x1122334455667788u;
    setup.version.state_layout = kStateLayout;
    std::strcpy(setup.version.vehicle, "made up");
    setup.configuration = Bytes(configuration_);
    setup.lidar_metadata = Bytes(metadata_);
    for (uint16_t source = 0; source < kInputSources; ++source) {
      setup.sender[source] = {0x0a000005u + source, static_cast<uint16_t>(7000 + source)};
      setup.receiver[source] = {0x0a000001u, static_cast<uint16_t>(7500 + source)};
    }
    setup.can_interface = 4;
    setup.wall_clock_offset_ns = kWallOffset_ns;
    started_ = log_.Start(setup);
  }

  flight_log::FlightLog& log() { return log_; }
  Status started() const { return started_; }
  const std::string& configuration() const { return configuration_; }
  const std::string& metadata() const { return metadata_; }
  const std::vector<uint8_t>& state() const { return state_; }

  // Logs one tick and changes the state a little.
  MadeUpTick Tick() {
    MadeUpTick tick = Make();
    const TickInput input = {tick.index,     tick.now_ns, CanBusState::kActive,
                             tick.datagrams, tick.frames, tick.command};
    log_.BeginTick(input, {tick.arrivals, 1000}, std::as_bytes(std::span(state_)));
    for (int i = 0; i < 1000; ++i) state_[random_() % state_.size()] = static_cast<uint8_t>(i);
    log_.EndTick({tick.index, Status::kOk, tick.hash, 123'456, 1}, tick.output);
    return tick;
  }

  static std::span<const uint8_t> Bytes(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
  }

 private:
  MadeUpTick Make() {
    MadeUpTick tick;
    index_ += random_() % 10 == 0 ? 2 : 1;
    now_ns_ += 10'000'000;
    tick.index = index_;
    tick.now_ns = now_ns_;
    constexpr size_t kSizes[kInputSources] = {84, 2000, 12'608};
    for (size_t source = 0; source < kInputSources; ++source) {
      for (uint_fast32_t i = random_() % 4; i > 0; --i) {
        std::vector<uint8_t>& payload = tick.payloads.emplace_back(kSizes[source]);
        for (uint8_t& byte : payload) byte = static_cast<uint8_t>(random_());
        tick.datagrams.push_back({static_cast<InputSource>(source), {}});
        const int64_t wall_ns = static_cast<int64_t>(now_ns_) + kWallOffset_ns;
        tick.arrivals.push_back(
            {wall_ns - 5'000'000, {0x0a000005u + static_cast<uint32_t>(source), 999}});
      }
    }
    for (size_t i = 0; i < tick.payloads.size(); ++i) tick.datagrams[i].bytes = tick.payloads[i];
    for (uint_fast32_t i = random_() % 9; i > 0; --i) {
      tick.frames.push_back(RandomFrame(random_));
      // Every other one has a time of its own.
      if (i % 2 == 0) tick.frames.back().received_ns = tick.now_ns - 7'654'321 * i;
    }
    if (random_() % 5 == 0) tick.command.assign(20 + random_() % 100, 0x5a);
    for (uint_fast32_t i = random_() % 5; i > 0; --i) {
      (void)tick.output.frames.PushBack(RandomFrame(random_));
    }
    tick.hash = static_cast<uint64_t>(random_()) << 32u | random_();
    return tick;
  }

  std::mt19937 random_;
  std::vector<uint8_t> state_;
  std::vector<uint8_t> snapshot_;
  std::string configuration_;
  std::string metadata_;
  flight_log::FlightLog log_;
  Status started_ = Status::kNotStarted;
  uint64_t index_ = 0;
  uint64_t now_ns_ = 50'000'000'000;
};

}  // namespace hardpack::fakes
