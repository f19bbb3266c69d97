// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "port_linux/chosen_vehicle.h"
#include "test/bare_metal/tape_writer.h"
#include "tools/capture/flight_reader.h"

// Writes the first ticks of a flight log, the first file of its run, as a tape.

namespace hardpack {
namespace {

using capture::FlightReader;
using capture::LoggedTick;

std::string_view TextOf(const capture::Assembled& assembled) {
  return {reinterpret_cast<const char*>(assembled.bytes.data()), assembled.bytes.size()};
}

void AddTick(const LoggedTick& logged, TapeWriter& tape) {
  std::vector<TickDatagram> datagrams;
  for (const capture::LoggedDatagram& datagram : logged.datagrams) {
    datagrams.push_back({datagram.source, datagram.bytes});
  }
  const TickInput input = {logged.begin.index, logged.begin.now_ns, logged.begin.bus,
                           datagrams,          logged.frames_in,    logged.command};
  tape.Add(input, logged.end.status, logged.frames_out, logged.end.decision_hash);
}

ReadOutcome ReadConfig(const FlightReader& reader, const std::string& path, VehicleConfig& config) {
  if (!reader.configuration().whole || !reader.lidar_metadata().whole) {
    return {Status::kTruncated, path + ": its configuration is not whole"};
  }
  const auto configuration = std::make_unique<Configuration>();
  const ReadOutcome parsed =
      ParseConfiguration(TextOf(reader.configuration()), path, *configuration);
  if (!parsed.ok()) return parsed;
  const auto lidars = std::make_unique<LidarConfigs>();
  const ReadOutcome read =
      ParseLidar(*configuration, TextOf(reader.lidar_metadata()), path, *lidars);
  if (read.ok()) config = ConfigOf<Warthog>(*configuration, *lidars);
  return read;
}

ReadOutcome WriteTape(const std::string& log, uint32_t most_ticks, const std::string& path) {
  FlightReader reader;
  const ReadOutcome opened = reader.Open(log);
  if (!opened.ok()) return opened;
  TapeWriter tape;
  const auto tick = std::make_unique<LoggedTick>();
  while (tape.ticks() < most_ticks && reader.Next(*tick) == FlightReader::Item::kTick) {
    AddTick(*tick, tape);
  }
  if (tape.ticks() == 0 || reader.version().next_tick != 0) {
    return {Status::kInvalidArgument, log + ": is not the first file of a run"};
  }
  const auto config = std::make_unique<VehicleConfig>();
  const ReadOutcome read = ReadConfig(reader, log, *config);
  if (!read.ok()) return read;
  if (!tape.WriteTo(path, *config)) {
    return {Status::kInvalidArgument, path + ": cannot be written"};
  }
  std::printf("%u ticks\n", tape.ticks());
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
