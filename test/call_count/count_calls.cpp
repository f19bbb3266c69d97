// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "test/bare_metal/tape.h"
#include "test/call_count/call_counter.h"

// Decides the ticks of tapes again, and counts meanwhile (call_counter.h).
//   count_calls TAPE...   standard input: lines `calls|rounds WITHIN OF`
// Exit code 1: decided otherwise; 2: no tape, or what is to be counted is not understood.

namespace hardpack::timing {
namespace {

[[noreturn]] void GiveUp(const std::string& why) {
  std::cerr << why << '\n';
  std::exit(2);
}

template <typename T>
T Taken(const uint8_t*& at) {
  T thing;
  std::memcpy(&thing, at, sizeof(thing));
  at += sizeof(thing);
  return thing;
}

void ReadFacts() {
  std::string what;
  std::string within;
  std::string of;
  while (std::cin >> what >> within >> of) {
    if (what != "calls" && what != "rounds") GiveUp("to be counted: " + what + "?");
    Count(what == "calls" ? Counted::kCalls : Counted::kRounds, within, of);
  }
}

// True: decided as on the tape.
bool DecideTick(const TapeTick& tick, const std::vector<uint8_t>& payload, VehicleLoop& loop) {
  const uint8_t* at = payload.data();
  std::vector<TickDatagram> datagrams;
  for (int i = 0; i < tick.datagrams; ++i) {
    const auto head = Taken<TapeDatagram>(at);
    datagrams.push_back({static_cast<InputSource>(head.source), {at, head.bytes}});
    at += head.bytes;
  }
  std::vector<CanFrame> frames;
  for (int i = 0; i < tick.frames_in; ++i) frames.push_back(Taken<CanFrame>(at));
  static TickOutput output;
  const Status status = loop.Tick({tick.index,
                                   tick.now_ns,
                                   static_cast<CanBusState>(tick.bus),
                                   datagrams,
                                   frames,
                                   {at, tick.command_bytes}},
                                  output);
  return static_cast<uint16_t>(status) == tick.status && loop.decision_hash() == tick.decision_hash;
}

void DecideTape(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const auto read = [&](void* to, size_t bytes) {
    file.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
    if (!file) GiveUp(path + ": ends too early");
  };
  TapeHead head;
  read(&head, sizeof(head));
  if (head.magic != kTapeMagic) GiveUp(path + ": no tape");
  const auto config = std::make_unique<VehicleConfig>();
  read(config.get(), sizeof(VehicleConfig));
  const auto loop = std::make_unique<VehicleLoop>();
  if (!IsUsable(loop->Configure(*config))) GiveUp(path + ": its configuration is refused");
  for (uint32_t i = 0; i < head.ticks; ++i) {
    TapeTick tick;
    read(&tick, sizeof(tick));
    std::vector<uint8_t> payload(tick.payload_bytes);
    read(payload.data(), payload.size());
    if (DecideTick(tick, payload, *loop)) continue;
    std::cerr << path << ": decided otherwise, tick " << tick.index << '\n';
    std::exit(1);
  }
}

}  // namespace
}  // namespace hardpack::timing

int main(int argc, char** argv) {
  hardpack::timing::ReadFacts();
  for (int i = 1; i < argc; ++i) hardpack::timing::DecideTape(argv[i]);
  hardpack::timing::PrintCounts();
  return 0;
}
