// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "port_linux/configuration.h"
#include "port_linux/ouster_metadata.h"
#include "test/bare_metal/tape.h"
#include "tools/capture/flight_reader.h"
#include "tools/replay/replay.h"

// Writes the first ticks of a flight log, the first file of its run, as a tape.

namespace hardpack {
namespace {

using capture::FlightReader;
using capture::LoggedTick;

std::string_view TextOf(const capture::Assembled& assembled) {
  return {reinterpret_cast<const char*>(assembled.bytes.data()), assembled.bytes.size()};
}

template <typename T>
std::span<const uint8_t> BytesOf(std::span<T> things) {
  return {reinterpret_cast<const uint8_t*>(things.data()), things.size_bytes()};
}

void Append(std::vector<uint8_t>& bytes, std::span<const uint8_t> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

template <typename T>
void AppendOne(std::vector<uint8_t>& bytes, const T& thing) {
  Append(bytes, BytesOf(std::span(&thing, 1)));
}

void AppendTick(std::vector<uint8_t>& tape, const LoggedTick& logged) {
  std::vector<uint8_t> payload;
  for (const capture::LoggedDatagram& datagram : logged.datagrams) {
    AppendOne(payload, TapeDatagram{static_cast<uint32_t>(datagram.source),
                                    static_cast<uint32_t>(datagram.bytes.size())});
    Append(payload, datagram.bytes);
  }
  Append(payload, BytesOf(std::span(logged.frames_in)));
  Append(payload, logged.command);
  Append(payload, BytesOf(std::span(logged.frames_out)));
  AppendOne(tape, TapeTick{.index = logged.begin.index,
                           .now_ns = logged.begin.now_ns,
                           .decision_hash = logged.end.decision_hash,
                           .bus = static_cast<uint16_t>(logged.begin.bus),
                           .status = static_cast<uint16_t>(logged.end.status),
                           .datagrams = static_cast<uint16_t>(logged.datagrams.size()),
                           .frames_in = static_cast<uint16_t>(logged.frames_in.size()),
                           .frames_out = static_cast<uint16_t>(logged.frames_out.size()),
                           .command_bytes = static_cast<uint16_t>(logged.command.size()),
                           .payload_bytes = static_cast<uint32_t>(payload.size())});
  Append(tape, payload);
}

ReadOutcome ReadConfig(const FlightReader& reader, const std::string& path, VehicleConfig& config) {
  if (!reader.configuration().whole || !reader.lidar_metadata().whole) {
    return {Status::kTruncated, path + ": its configuration is not whole"};
  }
  const auto configuration = std::make_unique<Configuration>();
  const ReadOutcome parsed =
      ParseConfiguration(TextOf(reader.configuration()), path, *configuration);
  if (!parsed.ok()) return parsed;
  const auto lidar = std::make_unique<ouster::Metadata>();
  const ReadOutcome read = ouster::ParseMetadata(TextOf(reader.lidar_metadata()), path, *lidar);
  if (read.ok()) config = replay::ConfigOf(*configuration, *lidar);
  return read;
}

ReadOutcome WriteTape(const std::string& log, uint32_t most_ticks, const std::string& path) {
  FlightReader reader;
  const ReadOutcome opened = reader.Open(log);
  if (!opened.ok()) return opened;
  TapeHead head;
  std::vector<uint8_t> ticks;
  const auto tick = std::make_unique<LoggedTick>();
  while (head.ticks < most_ticks && reader.Next(*tick) == FlightReader::Item::kTick) {
    AppendTick(ticks, *tick);
    ++head.ticks;
  }
  if (head.ticks == 0 || reader.version().next_tick != 0) {
    return {Status::kInvalidArgument, log + ": is not the first file of a run"};
  }
  const auto config = std::make_unique<VehicleConfig>();
  const ReadOutcome read = ReadConfig(reader, log, *config);
  if (!read.ok()) return read;
  std::vector<uint8_t> opening;
  AppendOne(opening, head);
  AppendOne(opening, *config);
  std::ofstream file(path, std::ios::binary);
  for (const std::vector<uint8_t>* part : {&opening, &ticks}) {
    file.write(reinterpret_cast<const char*>(part->data()),
               static_cast<std::streamsize>(part->size()));
  }
  file.close();
  if (!file) return {Status::kInvalidArgument, path + ": cannot be written"};
  std::printf("%u ticks\n", head.ticks);
  return {};
}

}  // namespace
}  // namespace hardpack

int main(int argc, char** argv) {
  uint32_t most_ticks = 0;
  const std::string_view number = argc == 4 ? argv[2] : "";
  const char* const end = number.data() + number.size();
  if (std::from_chars(number.data(), end, most_ticks).ptr != end || most_ticks == 0) {
    std::fputs("usage: write_tape LOG TICKS TAPE\nWrites the first ticks of LOG to TAPE.\n",
               stderr);
    return 2;
  }
  const hardpack::ReadOutcome written = hardpack::WriteTape(argv[1], most_ticks, argv[3]);
  if (written.ok()) return 0;
  std::fprintf(stderr, "%s\n", written.message.c_str());
  return 2;
}
