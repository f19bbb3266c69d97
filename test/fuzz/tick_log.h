// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "hal/onboard/flight_log/flight_log.h"
#include "test/fakes/memory_recorder.h"
#include "test/fuzz/fuzzed_vehicle.h"
#include "test/fuzz/mapper_script.h"
#include "test/fuzz/temporary_file.h"
#include "tools/capture/flight_reader.h"

namespace hardpack {

// A flight log of the ticks, and what is decided when they are done again from its bytes alone, as
// `hardpack replay` does it.
class TickLog {
 public:
  TickLog() { Require(log_.Start({}) == Status::kOk); }

  void BeginTick(const TickInput& input, const FuzzedLoop& loop) {
    // The port collects the sources in this order.
    std::vector<TickDatagram> datagrams(input.datagrams.begin(), input.datagrams.end());
    std::stable_sort(
        datagrams.begin(), datagrams.end(),
        [](const TickDatagram& a, const TickDatagram& b) { return a.source < b.source; });
    TickInput logged = input;
    logged.datagrams = datagrams;
    log_.BeginTick(logged, {}, std::as_bytes(std::span(&loop, 1)));
  }

  void EndTick(const TickInput& input, Status status, const FuzzedLoop& loop,
               const TickOutput& output) {
    log_.EndTick({input.index, status, loop.decision_hash(), 0, 0}, output);
    ++ticks_;
  }

  // `loop` is as the other one was before the first tick.
  void DoAgain(FuzzedLoop& loop) {
    log_.End();
    const std::vector<uint8_t> file = fakes::MemoryRecorder::AsPcap(recorder_.files().back());
    const TemporaryFile pcap(file.data(), file.size());
    capture::FlightReader reader;
    Require(reader.Open(pcap.path()).ok());
    const auto tick = std::make_unique<capture::LoggedTick>();
    using Item = capture::FlightReader::Item;
    for (int i = 0; i < ticks_; ++i) {
      Require(reader.Next(*tick) == Item::kTick);
      DoAgain(*tick, loop);
    }
    Require(reader.Next(*tick) == Item::kEnd);
  }

 private:
  void DoAgain(const capture::LoggedTick& tick, FuzzedLoop& loop) {
    std::vector<TickDatagram> datagrams;
    for (const capture::LoggedDatagram& datagram : tick.datagrams) {
      datagrams.push_back({datagram.source, datagram.bytes});
    }
    const TickInput input = {tick.begin.index, tick.begin.now_ns, tick.begin.bus,
                             datagrams,        tick.frames_in,    tick.command};
    Require(loop.Tick(input, output_) == tick.end.status);
    Require(loop.decision_hash() == tick.end.decision_hash);
    Require(static_cast<size_t>(output_.frames.size()) == tick.frames_out.size());
    for (size_t i = 0; i < tick.frames_out.size(); ++i) {
      const CanFrame& frame = output_.frames[static_cast<int>(i)];
      Require(frame.id == tick.frames_out[i].id && frame.size == tick.frames_out[i].size &&
              std::equal(std::begin(frame.data), std::end(frame.data),
                         std::begin(tick.frames_out[i].data)));
    }
  }

  fakes::MemoryRecorder recorder_;
  flight_log::FlightLog log_{recorder_, {}};
  int ticks_ = 0;
  TickOutput output_;
};

}  // namespace hardpack
