// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "hal/onboard/flight_log/flight_log.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/fakes/memory_recorder.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"
#include "test/port_linux/log_files.h"
#include "tools/replay/report_json.h"

namespace hardpack::replay {
namespace {

using fakes::LogDirectory;
using fakes::MemoryRecorder;

constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kRotateBytes = 20'000'000;
constexpr Ipv4Address kLidarAddress = {0x0a000005u};
constexpr Ipv4Address kInsAddress = {0x0a000006u};

void WriteFile(const std::string& path, std::span<const uint8_t> bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

// A drive of a simulated vehicle, boots, arms and drives off, logged as it goes; made once.
class LoggedDrive {
 public:
  static const LoggedDrive& Get() {
    static const LoggedDrive drive;
    return drive;
  }

  std::vector<std::string> files;
  std::string plain_capture;  // the same packets, without our records
  std::string configuration_path;
  std::string metadata_path;
  uint64_t decision_hash = 0;
  int64_t ticks = 0;
  std::vector<MemoryRecorder::File> packets;

 private:
  LoggedDrive() {
    sim::ScriptedVehicleSettings settings;
    settings.world = sim::LaneWorld();
    settings.lidar.columns = 512;
    uint64_t now_ns = 100'000'000'000;
    sim::ScriptedVehicle vehicle(settings, {}, now_ns);
    metadata_ = vehicle.lidar().MetadataJson();
    Configuration configuration;
    configuration.onboard = hardpack::testing::ConfigFor(settings, metadata_).onboard;
    configuration.lidar.address = kLidarAddress;
    configuration.lidar.metadata = "scan.json";
    configuration.ins.address = kInsAddress;
    configuration.ins.port = 7520;
    configuration_ = ToToml(configuration);
    Prepare();
    for (int i = 0; i < 1500 || !IsLastImageWhole(); ++i) {
      now_ns += kTick_ns;
      sim::Outgoing out;
      vehicle.Advance(now_ns, out);
      Tick(now_ns, out);
      for (const CanFrame& frame : output_.frames) vehicle.TakeFrame(frame, now_ns);
    }
    log_.End();
    decision_hash = onboard_->get()->pilot().decision_hash();
    Write();
  }

  void Prepare() {
    Configuration parsed;
    const ReadOutcome outcome = ParseConfiguration(configuration_, "made up", parsed);
    ASSERT_TRUE(outcome.ok()) << outcome.message;
    const auto lidars = std::make_unique<LidarConfigs>();
    ASSERT_TRUE(ParseLidar(parsed, metadata_, "made up", *lidars).ok());
    const ReadOutcome configured = onboard_->Configure(parsed, *lidars);
    ASSERT_TRUE(configured.ok()) << configured.message;
    flight_log::FlightLogSetup setup;
    setup.version.state_layout = onboard_->get()->state_layout();
    onboard_->get()->CopyType(setup.version.vehicle);
    setup.version.run = 77;
    setup.configuration = BytesOf(configuration_);
    setup.lidar_metadata = BytesOf(metadata_);
    setup.sender[0] = {kInsAddress.value, 7520};
    setup.receiver[0] = {0x0a000001u, 7520};
    setup.sender[2] = {kLidarAddress.value, 7502};
    setup.receiver[2] = {0x0a000001u, 7502};
    setup.wall_clock_offset_ns = 1'795'000'000'000'000'000;
    ASSERT_EQ(log_.Start(setup), Status::kOk);
  }

  void Tick(uint64_t now_ns, const sim::Outgoing& out) {
    std::vector<TickDatagram> datagrams;
    for (const sim::SensorDatagram& datagram : out.datagrams) {
      datagrams.push_back(
          {datagram.sensor == sim::Sensor::kLidar ? InputSource::kLidar : InputSource::kIns,
           datagram.bytes});
    }
    std::stable_sort(datagrams.begin(), datagrams.end(),
                     [](const auto& a, const auto& b) { return a.source < b.source; });
    index_ += ticks % 100 == 99 ? 2 : 1;  // one in a hundred is missed
    ++ticks;
    const std::vector<uint8_t> command = Command();
    const TickInput input = {index_, now_ns, CanBusState::kActive, datagrams, out.frames, command};
    log_.BeginTick(input, {}, onboard_->get()->state());
    const Status status = onboard_->get()->Tick(input, output_);
    EXPECT_EQ(status, Status::kOk);
    log_.EndTick({index_, status, onboard_->get()->pilot().decision_hash(), 1000, 0}, output_);
  }

  // The image is written with the file's first ticks: it is when three quarters of the file are.
  bool IsLastImageWhole() const {
    uint64_t bytes = 0;
    for (const MemoryRecorder::Packet& packet : recorder_.files().back()) {
      bytes += packet.bytes.size();
    }
    static_assert(sizeof(VehicleLoop) < kRotateBytes / 2);
    return bytes >= kRotateBytes / 4 * 3;
  }

  // Arms once the drives are ready, and then sends the vehicle off.
  std::vector<uint8_t> Command() {
    control::OperatorCommand command;
    command.sequence = ++sequence_;
    if (!armed_ && onboard_->get()->Drives().ready && ticks > 300) {
      armed_ = true;
      command.kind = control::Kind::kArm;
    } else if (armed_ && !sent_ && onboard_->get()->Drives().enabled) {
      sent_ = true;
      command.kind = control::Kind::kGoal;
      command.waypoints = 1;
      command.waypoint[0].position_m = {15.0f, 0.0f};
    } else {
      return {};
    }
    std::vector<uint8_t> bytes(control::kMaxMessageBytes);
    int size_bytes = 0;
    EXPECT_EQ(control::Encode(command, bytes, size_bytes), Status::kOk);
    bytes.resize(static_cast<size_t>(size_bytes));
    return bytes;
  }

  void Write() {
    packets = recorder_.files();
    MemoryRecorder::File plain;
    for (size_t i = 0; i < packets.size(); ++i) {
      files.push_back(directory_.path() + "/" + std::to_string(i) + ".pcap");
      WriteFile(files.back(), MemoryRecorder::AsPcap(packets[i]));
      for (const MemoryRecorder::Packet& packet : packets[i]) {
        const bool own = packet.bytes.size() > flight_log::kDatagramHeadBytes &&
                         packet.bytes[32] == 0x7f && packet.bytes[0] == 0x08;
        if (!own) plain.push_back(packet);
      }
    }
    plain_capture = directory_.path() + "/plain.pcap";
    WriteFile(plain_capture, MemoryRecorder::AsPcap(plain));
    configuration_path = directory_.path() + "/vehicle.toml";
    WriteFile(configuration_path, BytesOf(configuration_));
    metadata_path = directory_.path() + "/scan.json";
    WriteFile(metadata_path, BytesOf(metadata_));
  }

  static std::span<const uint8_t> BytesOf(const std::string& text) {
    return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
  }

  LogDirectory directory_;
  std::string configuration_;
  std::string metadata_;
  std::unique_ptr<ChosenVehicle> onboard_ = std::make_unique<ChosenVehicle>();
  std::vector<uint8_t> snapshot_ = std::vector<uint8_t>(sizeof(VehicleLoop));
  MemoryRecorder recorder_{kRotateBytes};
  flight_log::FlightLog log_{recorder_, snapshot_};
  TickOutput output_;
  uint64_t index_ = 0;
  uint32_t sequence_ = 0;
  bool armed_ = false;
  bool sent_ = false;
};

struct Replayed {
  ReadOutcome outcome;
  Report report;
  std::unique_ptr<ChosenVehicle> vehicle = std::make_unique<ChosenVehicle>();
};

Replayed Replay(const Request& request) {
  Replayed replayed;
  Configuration configuration;
  bool are_logs = false;
  replayed.outcome = AreFlightLogs(request.files, are_logs);
  if (!replayed.outcome.ok()) return replayed;
  replayed.outcome =
      are_logs ? ReplayLog(request, *replayed.vehicle, configuration, replayed.report)
               : ReplayCapture(request, *replayed.vehicle, configuration, replayed.report);
  return replayed;
}

// SR-DET06, SR-LOG01
TEST(Replay, DecidesALoggedDriveTheSameAgain) {
  const LoggedDrive& drive = LoggedDrive::Get();
  ASSERT_GE(drive.files.size(), 3u);
  std::vector<std::string> files = drive.files;
  std::reverse(files.begin(), files.end());  // in any order
  const Replayed replayed = Replay({files, "", "", false});
  ASSERT_TRUE(replayed.outcome.ok()) << replayed.outcome.message;
  EXPECT_TRUE(replayed.report.same())
      << replayed.report.difference.what << replayed.report.not_comparable;
  EXPECT_EQ(replayed.report.files, drive.files);
  EXPECT_EQ(replayed.report.ticks, drive.ticks);
  EXPECT_EQ(replayed.report.decision_hash, drive.decision_hash);
  EXPECT_TRUE(replayed.report.ended);
  EXPECT_FALSE(replayed.report.cut);
  EXPECT_TRUE(std::any_of(replayed.report.modes.begin(), replayed.report.modes.end(),
                          [](const ModeChange& change) { return change.mode == Mode::kDriving; }));
  EXPECT_FALSE(replayed.report.plans.empty());
  EXPECT_GT(replayed.report.driven.size(), 5u);
  const nlohmann::json object = ReportToJson(replayed.report, replayed.vehicle->get()->pilot());
  EXPECT_EQ(object["decision_hash"], HashText(drive.decision_hash));
  EXPECT_EQ(object["same"], true);
  EXPECT_EQ(object["counters"]["missed_ticks"], drive.ticks / 100);
}

// SR-LOG01
TEST(Replay, ReplaysAnyFileAloneFromItsImage) {
  const LoggedDrive& drive = LoggedDrive::Get();
  for (size_t i = 1; i < drive.files.size(); ++i) {
    const Replayed replayed = Replay({{drive.files[i]}, "", "", false});
    ASSERT_TRUE(replayed.outcome.ok()) << replayed.outcome.message;
    EXPECT_TRUE(replayed.report.same()) << replayed.report.difference.what;
    EXPECT_TRUE(replayed.report.from_image);
    if (i + 1 == drive.files.size()) {
      EXPECT_EQ(replayed.report.decision_hash, drive.decision_hash);
    }
  }
  const Replayed all = Replay({drive.files, "", "", true});
  EXPECT_TRUE(all.outcome.ok() && all.report.same());
  EXPECT_EQ(all.report.decision_hash, drive.decision_hash);
}

// One byte of the log changed, `at` behind the head of the first packet that `chosen` takes.
template <typename Chosen>
Replayed ReplayPlanted(const LogDirectory& directory, Chosen&& chosen, size_t at) {
  MemoryRecorder::File file = LoggedDrive::Get().packets[0];
  for (MemoryRecorder::Packet& packet : file) {
    if (!chosen(packet)) continue;
    packet.bytes[at] ^= 1u;
    break;
  }
  const std::string path = directory.path() + "/planted.pcap";
  WriteFile(path, MemoryRecorder::AsPcap(file));
  return Replay({{path}, "", "", false});
}

// SR-LOG01
TEST(Replay, FindsAPlantedDifference) {
  LogDirectory directory;
  int frames = 0;
  const auto frame_out = [&frames](const MemoryRecorder::Packet& packet) {
    return packet.bytes[1] == 0x0c && packet.bytes[10] == 4 && ++frames == 50;
  };
  const Replayed frame = ReplayPlanted(directory, frame_out, 28);
  ASSERT_TRUE(frame.outcome.ok());
  EXPECT_TRUE(frame.report.difference.found);
  EXPECT_EQ(frame.report.different_ticks, 1);
  EXPECT_NE(frame.report.difference.what.find("frame "), std::string::npos);
  EXPECT_GT(frame.report.difference.index, 0u);

  // The time of the 200th tick: the hash of everything after it differs, or the frames do.
  int ticks = 0;
  const auto tick_begin = [&ticks](const MemoryRecorder::Packet& packet) {
    const auto payload =
        std::span(packet.bytes)
            .subspan(std::min(packet.bytes.size(), flight_log::kDatagramHeadBytes));
    return flight_log::KindOf(payload) == flight_log::RecordKind::kTickEnd && ++ticks == 200;
  };
  const Replayed hash = ReplayPlanted(directory, tick_begin, flight_log::kDatagramHeadBytes + 21);
  EXPECT_EQ(hash.report.different_ticks, 1);
  EXPECT_NE(hash.report.difference.what.find("decision hash"), std::string::npos);
}

// SR-LOG02
TEST(Replay, GoesUpToTheLastWholeTickOfALogThatWasCutOff) {
  LogDirectory directory;
  const std::string path = directory.path() + "/cut.pcap";
  std::filesystem::copy_file(LoggedDrive::Get().files[0], path);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 100'001);
  const Replayed replayed = Replay({{path}, "", "", false});
  ASSERT_TRUE(replayed.outcome.ok()) << replayed.outcome.message;
  EXPECT_TRUE(replayed.report.same());
  EXPECT_TRUE(replayed.report.cut);
  EXPECT_FALSE(replayed.report.ended);
  EXPECT_GT(replayed.report.ticks, 100);
}

// SR-LOG02
TEST(Replay, SaysThatALogWithAGapIsNotComparable) {
  LogDirectory directory;
  MemoryRecorder::File file = LoggedDrive::Get().packets[0];
  const flight_log::RecordHead gap(flight_log::GapRecord{42});
  MemoryRecorder::Packet packet = {1, std::vector<uint8_t>(flight_log::kDatagramHeadBytes)};
  constexpr flight_log::Endpoint kOwn = {flight_log::kLoopback, flight_log::kRecordPort};
  flight_log::EncodeDatagramHead(kOwn, kOwn, gap.bytes().size(),
                                 std::span(packet.bytes).first<flight_log::kDatagramHeadBytes>());
  packet.bytes.insert(packet.bytes.end(), gap.bytes().begin(), gap.bytes().end());
  file.insert(file.begin() + static_cast<std::ptrdiff_t>(file.size() / 2), packet);
  const std::string path = directory.path() + "/gap.pcap";
  WriteFile(path, MemoryRecorder::AsPcap(file));
  const Replayed replayed = Replay({{path}, "", "", false});
  ASSERT_TRUE(replayed.outcome.ok());
  EXPECT_FALSE(replayed.report.same());
  EXPECT_NE(replayed.report.not_comparable.find("not comparable: 42 records"), std::string::npos);
}

// SR-LOG02
TEST(Replay, NoticesAMissingFileAndAnImageOfAnotherLayout) {
  const LoggedDrive& drive = LoggedDrive::Get();
  const Replayed missing = Replay({{drive.files[0], drive.files[2]}, "", "", false});
  EXPECT_NE(missing.report.not_comparable.find("missing"), std::string::npos);

  LogDirectory directory;
  MemoryRecorder::File file = drive.packets[1];
  file[0].bytes[flight_log::kDatagramHeadBytes + 36] ^= 1u;  // of the version's state_layout
  const std::string path = directory.path() + "/other.pcap";
  WriteFile(path, MemoryRecorder::AsPcap(file));
  const Replayed other = Replay({{path}, "", "", false});
  EXPECT_EQ(other.outcome.status, Status::kUnsupported);
  EXPECT_NE(other.outcome.message.find("another layout"), std::string::npos);

  // A byte of the image: its CRC does not match.
  file = drive.packets[1];
  for (MemoryRecorder::Packet& packet : file) {
    flight_log::ImageRecord part;
    if (packet.bytes.size() < 10'000 || packet.bytes[32] != 0x7f) continue;
    const auto payload = std::span(packet.bytes).subspan(flight_log::kDatagramHeadBytes);
    if (!IsUsable(flight_log::Decode(payload, part))) continue;
    packet.bytes.back() ^= 1u;
    break;
  }
  WriteFile(path, MemoryRecorder::AsPcap(file));
  EXPECT_EQ(Replay({{path}, "", "", false}).outcome.status, Status::kTruncated);
}

TEST(Replay, FormsTheTicksOfAPlainCapture) {
  const LoggedDrive& drive = LoggedDrive::Get();
  EXPECT_EQ(Replay({{drive.plain_capture}, "", "", false}).outcome.status,
            Status::kInvalidArgument);  // it needs a configuration
  const Request request = {
      {drive.plain_capture}, drive.configuration_path, drive.metadata_path, false};
  const Replayed replayed = Replay(request);
  ASSERT_TRUE(replayed.outcome.ok()) << replayed.outcome.message;
  EXPECT_FALSE(replayed.report.is_flight_log);
  EXPECT_NEAR(static_cast<double>(replayed.report.ticks), static_cast<double>(drive.ticks), 3.0);
  EXPECT_GT(replayed.report.own_frames, 100);  // the master's, which are not fed
  EXPECT_GT(replayed.report.frames_in, 100);
  EXPECT_GT(replayed.report.datagrams[static_cast<size_t>(InputSource::kLidar)], 100);
  EXPECT_GT(replayed.report.datagrams[static_cast<size_t>(InputSource::kIns)], 100);
  EXPECT_FALSE(replayed.vehicle->get()->Drives().foreign_sender);
  EXPECT_TRUE(replayed.vehicle->get()->pilot().mapper().has_seen());
  EXPECT_EQ(Replay(request).report.decision_hash, replayed.report.decision_hash);
}

TEST(Replay, RefusesWhatItCannotUse) {
  const LoggedDrive& drive = LoggedDrive::Get();
  LogDirectory directory;
  EXPECT_FALSE(Replay({{directory.path() + "/none.pcap"}, "", "", false}).outcome.ok());
  EXPECT_FALSE(Replay({{drive.files[0], drive.plain_capture}, "", "", false}).outcome.ok());
  EXPECT_FALSE(Replay({{drive.files[0]}, "/no/such.toml", "", false}).outcome.ok());
}

}  // namespace
}  // namespace hardpack::replay
