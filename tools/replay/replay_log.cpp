// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

#include "hal/onboard/flight_log/flight_log.h"
#include "tools/capture/flight_reader.h"
#include "tools/replay/replay.h"

namespace hardpack::replay {
namespace {

using capture::FlightReader;
using capture::LoggedTick;
using Item = FlightReader::Item;

std::string_view TextOf(const capture::Assembled& assembled) {
  // Characters are bytes.
  return {reinterpret_cast<const char*>(assembled.bytes.data()), assembled.bytes.size()};
}

std::string_view TextOf(std::span<const char> field) {
  return {field.data(), strnlen(field.data(), field.size())};
}

std::string HexOf(uint64_t value) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += kDigits[value >> shift & 0xfu];
  return text;
}

// As candump writes it: "202#0102030405060708".
std::string TextOf(const CanFrame& frame) {
  std::string text = HexOf(frame.id).substr(frame.extended ? 8 : 13) + "#";
  if (frame.remote) return text + "R";
  for (int i = 0; i < frame.size; ++i) text += HexOf(frame.data[i]).substr(14);
  return text;
}

// The opening records of a file, before its first tick.
struct Opening {
  std::string path;
  bool has_version = false;
  flight_log::VersionRecord version;
};

ReadOutcome ReadOpening(const std::string& path, Opening& opening) {
  FlightReader reader;
  const ReadOutcome opened = reader.Open(path);
  if (!opened.ok()) return opened;
  LoggedTick tick;
  static_cast<void>(reader.Next(tick));
  opening = {path, reader.has_version(), reader.version()};
  return {};
}

// Brings the files into the order of their run.
ReadOutcome OrderFiles(const std::vector<std::string>& files, std::vector<Opening>& openings) {
  for (const std::string& path : files) {
    const ReadOutcome read = ReadOpening(path, openings.emplace_back());
    if (!read.ok()) return read;
  }
  for (const Opening& opening : openings) {
    if (openings.size() == 1) break;
    if (!opening.has_version) {
      return {Status::kInvalidArgument, opening.path + ": does not say which run it belongs to"};
    }
    if (opening.version.run != openings.front().version.run) {
      return {Status::kInvalidArgument,
              opening.path + ": belongs to another run than " + files.front()};
    }
  }
  std::stable_sort(openings.begin(), openings.end(), [](const Opening& a, const Opening& b) {
    return a.version.file < b.version.file;
  });
  return {};
}

class LogReplay {
 public:
  LogReplay(const Request& request, ChosenVehicle& vehicle, Configuration& configuration,
            Report& report)
      : request_(request),
        vehicle_(vehicle),
        configuration_(configuration),
        report_(report),
        observer_(report) {}

  ReadOutcome Run() {
    std::vector<Opening> openings;
    const ReadOutcome ordered = OrderFiles(request_.files, openings);
    if (!ordered.ok()) return ordered;
    report_.is_flight_log = true;
    report_.version = openings.front().version;
    for (const Opening& opening : openings) report_.files.push_back(opening.path);
    for (size_t i = 0; i < openings.size() && report_.not_comparable.empty(); ++i) {
      if (i > 0 && !Follows(openings[i])) break;
      const ReadOutcome replayed = ReplayFile(openings[i], i == 0, i + 1 == openings.size());
      if (!replayed.ok()) return replayed;
    }
    if (report_.ticks == 0 && report_.not_comparable.empty()) {
      report_.not_comparable = "it contains no complete tick";
    }
    return {};
  }

 private:
  // Whether a later file begins where the previous one ended.
  bool Follows(const Opening& opening) {
    if (opening.version.next_tick == report_.last_index + 1) return true;
    return Stop(opening.path, "an earlier file is missing");
  }

  bool Stop(const std::string& path, const std::string& reason) {
    report_.not_comparable = path + ": " + reason;
    return false;
  }

  ReadOutcome ReplayFile(const Opening& opening, bool is_first, bool is_last) {
    const bool opens_run = opening.has_version && opening.version.next_tick == 0;
    const bool needs_image = !opens_run && (is_first || request_.from_image);
    if (needs_image) {
      const ReadOutcome loaded = LoadImage(opening);
      if (!loaded.ok()) return loaded;
    }
    FlightReader reader;
    const ReadOutcome opened = reader.Open(opening.path);
    if (!opened.ok()) return opened;
    const auto tick = std::make_unique<LoggedTick>();
    bool started = needs_image || !is_first;
    while (true) {
      const Item item = reader.Next(*tick);
      if (item == Item::kTick && !started) {
        const ReadOutcome configured = Configure(opening.path, reader);
        if (!configured.ok()) return configured;
        started = true;
      }
      if (item == Item::kTick) {
        ReplayTick(*tick);
      } else if (!GoesOn(item, reader, opening.path, is_last)) {
        return {};
      }
    }
  }

  // Whether to continue reading the file after an item that is not a tick.
  bool GoesOn(Item item, const FlightReader& reader, const std::string& path, bool is_last) {
    switch (item) {
      case Item::kEnd:
        report_.ended = true;
        return true;
      case Item::kGap:
        return Stop(path, "not comparable: " + std::to_string(reader.gap_records()) +
                              " records are missing after tick " +
                              std::to_string(report_.last_index));
      case Item::kDamaged:
        return Stop(path, "damaged: " + reader.damage());
      default:
        break;
    }
    report_.cut = reader.ends_within_tick() || !reader.outcome().ok();
    if (report_.cut && !is_last) Stop(path, "it is truncated, but another file follows");
    return false;
  }

  ReadOutcome Configure(const std::string& path, const FlightReader& reader) {
    const std::string& own = request_.configuration_path;
    if (own.empty() && !reader.configuration().whole) {
      return {Status::kTruncated,
              path + ": its configuration is incomplete; give one with --config"};
    }
    const ReadOutcome parsed = own.empty()
                                   ? ParseConfiguration(TextOf(reader.configuration()),
                                                        path + " (configuration)", configuration_)
                                   : ReadConfiguration(own, configuration_);
    if (!parsed.ok()) return parsed;
    if (own.empty() && TextOf(reader.configuration()).find(kHiddenSecret) != std::string::npos) {
      configuration_.onboard.drive.login_password = PasswordOnTheBus();
    }
    const bool has_own_lidar = request_.metadata_path.empty();
    if (has_own_lidar && !reader.lidar_metadata().whole) {
      return {Status::kTruncated, path + ": its metadata is incomplete; give it with --metadata"};
    }
    const auto lidars = std::make_unique<LidarConfigs>();
    if (!has_own_lidar) configuration_.lidar.metadata = request_.metadata_path;
    std::string text;
    const ReadOutcome read = has_own_lidar
                                 ? ParseLidar(configuration_, TextOf(reader.lidar_metadata()),
                                              path + " (metadata)", *lidars)
                                 : ReadLidar(configuration_, text, *lidars);
    if (!read.ok()) return read;
    ReadOutcome configured = vehicle_.Configure(configuration_, *lidars);
    if (!configured.ok()) configured.message = path + ": refused: " + configured.message;
    return configured;
  }

  // A log's configuration does not show the drives' password. A run that used it has it in a frame,
  // a download to 5000h:2; to any other it makes no difference.
  int32_t PasswordOnTheBus() const {
    constexpr uint32_t kFirstQuestion = 0x601;
    constexpr uint32_t kLastQuestion = 0x67f;
    for (const std::string& path : request_.files) {
      FlightReader reader;
      if (!reader.Open(path).ok()) continue;
      const auto tick = std::make_unique<LoggedTick>();
      for (Item item = reader.Next(*tick); item == Item::kTick; item = reader.Next(*tick)) {
        for (const CanFrame& frame : tick->frames_out) {
          const bool is_password = frame.id >= kFirstQuestion && frame.id <= kLastQuestion &&
                                   frame.data[0] == 0x2b && frame.data[1] == 0x00 &&
                                   frame.data[2] == 0x50 && frame.data[3] == 0x02;
          if (is_password) return frame.data[4] | frame.data[5] << 8;
        }
      }
    }
    return 0;
  }

  // Fills the loop with the state that the file begins from.
  ReadOutcome LoadImage(const Opening& opening) {
    const flight_log::VersionRecord& version = opening.version;
    if (!opening.has_version) {
      return {Status::kInvalidArgument, opening.path + ": continues an earlier file"};
    }
    const bool same_layout = vehicle_.Choose(TextOf(version.vehicle)) &&
                             version.state_bytes == vehicle_.get()->state().size() &&
                             version.state_layout == vehicle_.get()->state_layout();
    if (!same_layout) {
      return {Status::kUnsupported,
              opening.path + ": its state image has another layout (hardpack " +
                  std::string(TextOf(version.version)) + ", build " +
                  std::string(TextOf(version.build)) + "): replay it from the run's first file"};
    }
    FlightReader reader;
    const ReadOutcome opened = reader.Open(opening.path);
    if (!opened.ok()) return opened;
    const auto tick = std::make_unique<LoggedTick>();
    Item item = Item::kTick;
    while (!reader.image().whole && (item == Item::kTick || item == Item::kEnd)) {
      item = reader.Next(*tick);
      if (!reader.has_version()) break;
      ParseOnce(opening.path, reader);
    }
    const bool usable = reader.image().whole &&
                        reader.image().bytes.size() == version.state_bytes &&
                        reader.image_index() + 1 == version.next_tick;
    if (!usable) {
      return {Status::kTruncated, opening.path +
                                      ": its state image is incomplete: replay it "
                                      "with the files before it"};
    }
    static_cast<void>(vehicle_.get()->Restore(std::as_bytes(std::span(reader.image().bytes))));
    report_.from_image = report_.ticks == 0;
    return {};
  }

  // The image contains the loop's configuration; the pictures also need the port's part.
  void ParseOnce(const std::string& path, const FlightReader& reader) {
    if (parsed_ || !reader.configuration().whole) return;
    parsed_ = true;
    static_cast<void>(ParseConfiguration(TextOf(reader.configuration()), path, configuration_));
  }

  void ReplayTick(const LoggedTick& logged) {
    datagrams_.clear();
    for (const capture::LoggedDatagram& datagram : logged.datagrams) {
      datagrams_.push_back({datagram.source, datagram.bytes});
    }
    const TickInput input = {logged.begin.index, logged.begin.now_ns, logged.begin.bus,
                             datagrams_,         logged.frames_in,    logged.command};
    const Status status = observer_.Tick(input, *vehicle_.get(), output_);
    report_.logged.Add(logged.begin.index, logged.end.duration_ns);
    const std::string difference = DifferenceOf(logged, status);
    if (difference.empty()) return;
    ++report_.different_ticks;
    if (!report_.difference.found) report_.difference = {true, logged.begin.index, difference};
  }

  std::string DifferenceOf(const LoggedTick& logged, Status status) const {
    if (status != logged.end.status) {
      return std::string("status: ") + StatusName(status) + ", logged " +
             StatusName(logged.end.status);
    }
    const auto frames = static_cast<size_t>(output_.frames.size());
    for (size_t i = 0; i < std::min(frames, logged.frames_out.size()); ++i) {
      const CanFrame& frame = output_.frames[static_cast<int>(i)];
      if (frame != logged.frames_out[i]) {
        return "frame " + std::to_string(i + 1) + ": " + TextOf(frame) + ", logged " +
               TextOf(logged.frames_out[i]);
      }
    }
    if (frames != logged.frames_out.size()) {
      return std::to_string(frames) + " frames, logged " + std::to_string(logged.frames_out.size());
    }
    const uint64_t decision_hash = vehicle_.get()->pilot().decision_hash();
    if (decision_hash == logged.end.decision_hash) return {};
    return "decision hash: " + HexOf(decision_hash) + ", logged " + HexOf(logged.end.decision_hash);
  }

  const Request& request_;
  ChosenVehicle& vehicle_;
  Configuration& configuration_;
  Report& report_;
  Observer observer_;
  bool parsed_ = false;
  std::vector<TickDatagram> datagrams_;
  TickOutput output_;
};

}  // namespace

ReadOutcome AreFlightLogs(const std::vector<std::string>& files, bool& are_logs) {
  size_t logs = 0;
  for (const std::string& path : files) {
    bool is_log = false;
    const ReadOutcome read = FlightReader::IsFlightLog(path, is_log);
    if (!read.ok()) return read;
    logs += is_log ? 1 : 0;
  }
  are_logs = logs == files.size();
  if (logs != 0 && !are_logs) {
    return {Status::kInvalidArgument, "some files are flight logs and some are plain captures"};
  }
  return {};
}

ReadOutcome ReplayLog(const Request& request, ChosenVehicle& vehicle, Configuration& configuration,
                      Report& report) {
  return LogReplay(request, vehicle, configuration, report).Run();
}

}  // namespace hardpack::replay
