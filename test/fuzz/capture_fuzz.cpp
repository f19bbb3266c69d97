// SPDX-License-Identifier: Apache-2.0
// Any bytes as a capture, and as a flight log. Required: every packet is whole and lies in time
// order of its own kind's rules or is refused, the counters add up, a tick that is told is as its
// own records say, and the end is told once and for all.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "test/fuzz/accepted.h"
#include "test/fuzz/temporary_file.h"
#include "tools/capture/flight_reader.h"
#include "tools/capture/pcap_reader.h"

namespace {

using namespace hardpack;
using namespace hardpack::capture;

void Require(bool condition) {
  if (!condition) std::abort();
}

void ReadPackets(const std::string& path, bool drops_duplicates) {
  PcapReader reader;
  if (!reader.Open(path).ok()) return;
  if (drops_duplicates) reader.DropDuplicates();
  CapturedPacket packet;
  int64_t datagrams = 0;
  int64_t frames = 0;
  int64_t fragmented = 0;
  while (reader.Next(packet)) {
    const bool is_frame = packet.kind == CapturedPacket::Kind::kCanFrame;
    (is_frame ? frames : datagrams) += 1;
    if (is_frame) Require(IsValid(packet.frame));
    if (is_frame) Accepted("can");
    if (is_frame) continue;
    Accepted(reader.reassembly().completed > fragmented ? "fragments" : "datagrams");
    fragmented = reader.reassembly().completed;
    Require(packet.datagram.payload.size() <= 65507);
    uint32_t sum = 0;
    for (const uint8_t byte : packet.datagram.payload) sum += byte;
    Require(sum <= 255u * 65507u);
  }
  const CaptureCounters& counters = reader.counters();
  Require(counters.datagrams == datagrams && counters.can_frames == frames);
  Require(counters.malformed_frames + counters.other_frames + counters.cut_frames <=
          counters.frames);
  Require(!reader.Next(packet));
}

void ReadTicks(const std::string& path) {
  FlightReader reader;
  if (!reader.Open(path).ok()) return;
  const auto tick = std::make_unique<LoggedTick>();
  for (int i = 0; i < 100'000; ++i) {
    const FlightReader::Item item = reader.Next(*tick);
    if (item == FlightReader::Item::kFileEnd) return;
    if (item != FlightReader::Item::kTick) continue;
    Require(tick->begin.index == tick->end.index);
    Require(tick->frames_in.size() == tick->begin.frames);
    Require(tick->frames_out.size() == tick->end.frames);
    Require(tick->command.size() == tick->begin.command_bytes);
    size_t datagrams = 0;
    for (const uint16_t count : tick->begin.datagrams) datagrams += count;
    Require(tick->datagrams.size() == datagrams);
    Accepted("flight");
  }
  std::abort();  // a file of so few bytes has no end
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const TemporaryFile file(data + 1, size - 1);
  ReadPackets(file.path(), (data[0] & 1) != 0);
  ReadTicks(file.path());
  return 0;
}
