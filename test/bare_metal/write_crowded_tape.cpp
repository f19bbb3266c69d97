// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/labels/labels.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "test/bare_metal/tape_writer.h"
#include "test/hal/onboard/control/command_bytes.h"
#include "test/hal/ouster/ouster_packets.h"
#include "tools/sim/script/scripted_vehicle.h"

// Writes a tape of ticks that are as dear as a test can make them, so that their instructions can
// be held against the static bound of a tick. A vehicle stands, its drives are brought up, and then
// everything comes at once, as much as a tick takes: a lidar of 128 beams that all return from
// somewhere else, a label for each return, an INS that repeats itself. Near returns fill the map
// with obstacles, and those from behind make them age; ground is bridged between its returns. In
// the second half there is a goal as well, and so planning.

namespace hardpack {
namespace {

constexpr double kDegPerRad = 57.29578;
constexpr int kBeams = kMaxBeams;
constexpr int kColumns = 1024;  // as many as of 128 beams there may be
constexpr int kColumnsPerPacket = 16;
constexpr int kTicksToBringUp = 400;  // at most
constexpr uint64_t kTick_ns = 10'000'000;

enum class Seen : uint8_t { kNear, kGround, kFar, kNearAndFar };
constexpr int kKindsOfSeen = 4;
constexpr int kRevolutionsAlike = 2;
// Once through everything that is seen, 256 columns in each; and once more with a goal.
constexpr int kCrowdedTicks = kKindsOfSeen * kRevolutionsAlike * kColumns / 256;
static_assert(TickParams{}.directions == 256);

void Require(bool condition, const char* otherwise) {
  if (condition) return;
  std::fprintf(stderr, "%s\n", otherwise);
  std::exit(2);
}

// The same numbers on every machine.
class Numbers {
 public:
  uint32_t Below(uint32_t end) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>(state_ >> 33) % end;
  }

 private:
  uint64_t state_ = 1;
};

double Altitude_rad(int beam) {
  constexpr double kHighest_rad = 0.3927;  // 22.5 degrees
  return kHighest_rad * (1.0 - 2.0 * beam / (kBeams - 1));
}

ouster::Metadata LidarOf128Beams() {
  ouster::Metadata lidar;
  lidar.profile = ouster::Profile::kRng19Rfl8Sig16Nir16;
  lidar.beams = kBeams;
  lidar.columns_per_frame = kColumns;
  lidar.columns_per_packet = kColumnsPerPacket;
  lidar.column_window_last = kColumns - 1;
  lidar.lidar_origin_to_beam_origin_m = 0.015f;
  for (int beam = 0; beam < kBeams; ++beam) {
    lidar.beam_altitude_deg[beam] = static_cast<float>(Altitude_rad(beam) * kDegPerRad);
    lidar.beam_azimuth_deg[beam] = 2.1f - 1.4f * static_cast<float>(beam % 4);
  }
  return lidar;
}

// As many columns a tick as one classes, in packets; and the labels of those of the tick before.
class CrowdedLidar {
 public:
  explicit CrowdedLidar(int columns_per_tick)
      : packets_per_tick_(columns_per_tick / kColumnsPerPacket) {}

  void Tick(uint64_t now_ns, std::vector<std::vector<uint8_t>>& labels,
            std::vector<std::vector<uint8_t>>& packets) {
    constexpr size_t kLabelled = labels::kMaxColumns;
    for (size_t i = 0; i + kLabelled <= before_.size(); i += kLabelled) {
      labels.push_back(LabelsOf(std::span(before_).subspan(i, kLabelled)));
    }
    before_.clear();
    for (int i = 0; i < packets_per_tick_; ++i) {
      const uint64_t column_ns =
          kTick_ns / static_cast<uint64_t>(packets_per_tick_ * kColumnsPerPacket);
      const int later = (packets_per_tick_ - i) * kColumnsPerPacket;
      const std::vector<LidarColumn> columns =
          Columns(now_ns - column_ns * static_cast<uint64_t>(later), column_ns);
      packets.push_back(ouster::test::EncodeRng19({.frame_id = frame_id()}, columns));
      before_.insert(before_.end(), columns.begin(), columns.end());
      sent_ += kColumnsPerPacket;
    }
  }

 private:
  uint16_t frame_id() const { return static_cast<uint16_t>(sent_ / kColumns); }

  std::vector<LidarColumn> Columns(uint64_t first_ns, uint64_t column_ns) {
    std::vector<LidarColumn> columns(kColumnsPerPacket);
    const auto seen = static_cast<Seen>(frame_id() / kRevolutionsAlike % kKindsOfSeen);
    for (int i = 0; i < kColumnsPerPacket; ++i) {
      LidarColumn& column = columns[static_cast<size_t>(i)];
      column.timestamp_ns = first_ns + column_ns * static_cast<uint64_t>(i);
      column.measurement_id = static_cast<uint16_t>(sent_ % kColumns + static_cast<uint64_t>(i));
      column.frame_id = frame_id();
      column.status = 1;
      column.valid = true;
      column.beams = kBeams;
      column.returns = 1;
      for (int row = 0; row < kBeams; ++row) {
        column.range_mm[row] = Range_mm(seen, row);
      }
    }
    return columns;
  }

  uint32_t Range_mm(Seen seen, int row) {
    constexpr double kSensor_mm = 1320.0;  // above the ground
    constexpr double kLeastFall = 0.025;
    const double fall = -std::sin(Altitude_rad(row));
    switch (seen) {
      case Seen::kNear:
        return 3000 + numbers_.Below(25000);
      case Seen::kGround:
        if (fall < kLeastFall) return 30000 + numbers_.Below(20000);
        return static_cast<uint32_t>(kSensor_mm / fall) + numbers_.Below(60);
      case Seen::kFar:
        return 30000 + numbers_.Below(30000);
      default:
        return row % 2 == 0 ? 50000 : 5000;
    }
  }

  std::vector<uint8_t> LabelsOf(std::span<const LidarColumn> columns) {
    constexpr uint8_t kSaid[] = {4, 8, 12, 17, 18, 19, 27, 34};  // RELLIS-3D: what stands up
    std::vector<uint8_t> codes(columns.size() * kBeams);
    for (uint8_t& code : codes) code = kSaid[numbers_.Below(std::size(kSaid))];
    const labels::Header header = {.version = labels::kVersion,
                                   .beams = kBeams,
                                   .frame_id = columns.front().frame_id,
                                   .first_measurement = columns.front().measurement_id,
                                   .columns = static_cast<uint16_t>(columns.size()),
                                   .sequence = labels_sent_++,
                                   .timestamp_ns = columns.front().timestamp_ns};
    std::vector<uint8_t> datagram(labels::kMaxDatagramBytes);
    int size_bytes = 0;
    Require(IsUsable(labels::Encode(header, codes, datagram, size_bytes)), "no labels");
    datagram.resize(static_cast<size_t>(size_bytes));
    return datagram;
  }

  int packets_per_tick_;
  uint64_t sent_ = 0;  // columns
  uint32_t labels_sent_ = 0;
  std::vector<LidarColumn> before_;  // of the tick before
  Numbers numbers_;
};

class CrowdedDrive {
 public:
  CrowdedDrive() {
    sim::ScriptedVehicleSettings settings;
    settings.world = sim::LaneWorld();
    settings.lidar.columns = 512;  // it is not listened to
    vehicle_ =
        std::make_unique<sim::ScriptedVehicle>(settings, std::vector<sim::ScriptEvent>{}, now_ns_);
    DriveParams& drive = config_->onboard.drive;
    drive.left_sign = settings.vehicle.left.sign;
    drive.right_sign = settings.vehicle.right.sign;
    drive.gear_ratio = static_cast<float>(settings.vehicle.left.gear_ratio);
    drive.login_user = settings.vehicle.left.login_user;
    drive.login_password = settings.vehicle.left.login_password;
    config_->lidar = LidarOf128Beams();
    config_->perception.mapping.use_labels = 1;
    Require(IsUsable(loop_->Configure(*config_)), "the configuration is refused");
  }

  void Drive() {
    for (int i = 0; i < kTicksToBringUp && !loop_->drives().ready(); ++i) Tick({}, false);
    Require(loop_->drives().ready(), "the drives are not ready");
    for (int i = 0; i < kCrowdedTicks; ++i) Tick({}, true);
    Say(control::Kind::kArm);
    for (int i = 0; i < kCrowdedTicks && !loop_->drives().enabled(); ++i) Tick({}, true);
    Say(control::Kind::kGoal);
    for (int i = 0; i < kCrowdedTicks; ++i) Tick({}, true);
  }

  // What was meant has come in.
  void Check() const {
    const LoopCounters& counters = loop_->counters();
    const MapperCounters& mapper = loop_->mapper().counters();
    Require(counters.refused_columns == 0 && counters.suspect_columns == 0, "columns are refused");
    Require(counters.refused_labels == 0 && mapper.folded_without_labels == 0,
            "labels are refused");
    Require(mapper.folded_with_labels > 2 * kColumns, "hardly anything was seen");
    Require(counters.plans > 0, "nothing was planned");
  }

  bool WriteTo(const std::string& path) const { return tape_.WriteTo(path, *config_); }
  uint32_t ticks() const { return tape_.ticks(); }

 private:
  void Say(control::Kind kind) {
    const std::vector<uint8_t> command = control::CommandBytes(kind, ++sequence_, {45.0f, 40.0f});
    Require(!command.empty(), "no command");
    Tick(command, true);
    Require(output_.has_answer && IsUsable(output_.answer), "a command is refused");
  }

  void Tick(std::span<const uint8_t> command, bool is_crowded) {
    now_ns_ += kTick_ns;
    sim::Outgoing out;
    vehicle_->Advance(now_ns_, out);
    std::vector<std::vector<uint8_t>> ins;
    std::vector<std::vector<uint8_t>> labels;
    std::vector<std::vector<uint8_t>> packets;
    for (const sim::SensorDatagram& datagram : out.datagrams) {
      if (datagram.sensor == sim::Sensor::kIns) ins.push_back(datagram.bytes);
    }
    if (is_crowded) {
      for (std::vector<uint8_t>& bytes : ins) Repeat(bytes);
      if (!ins.empty()) ins.resize(VehicleLoop::kMaxInsDatagrams, ins.back());
      lidar_.Tick(now_ns_, labels, packets);
    }
    std::vector<TickDatagram> datagrams;
    const auto add = [&datagrams](InputSource source, const std::vector<std::vector<uint8_t>>& of,
                                  size_t most) {
      for (size_t i = 0; i < std::min(of.size(), most); ++i) datagrams.push_back({source, of[i]});
    };
    add(InputSource::kIns, ins, VehicleLoop::kMaxInsDatagrams);
    add(InputSource::kLabels, labels, VehicleLoop::kMaxLabelDatagrams);
    add(InputSource::kLidar, packets, VehicleLoop::kMaxDatagramsPerTick - datagrams.size());
    const TickInput input = {++index_,  now_ns_,    CanBusState::kActive,
                             datagrams, out.frames, command};
    const Status status = loop_->Tick(input, output_);
    Require(IsUsable(status), "a tick is refused");
    tape_.Add(input, status, {output_.frames.begin(), output_.frames.end()},
              loop_->decision_hash());
    for (const CanFrame& frame : output_.frames) vehicle_->TakeFrame(frame, now_ns_);
  }

  // The same messages until a datagram is full.
  static void Repeat(std::vector<uint8_t>& bytes) {
    const std::vector<uint8_t> message = bytes;
    while (bytes.size() + message.size() <= VehicleLoop::kMaxInsDatagram_bytes) {
      bytes.insert(bytes.end(), message.begin(), message.end());
    }
  }

  uint64_t now_ns_ = 100'000'000'000;
  uint64_t index_ = 0;
  uint32_t sequence_ = 0;
  std::unique_ptr<sim::ScriptedVehicle> vehicle_;
  std::unique_ptr<VehicleConfig> config_ = std::make_unique<VehicleConfig>();
  std::unique_ptr<VehicleLoop> loop_ = std::make_unique<VehicleLoop>();
  CrowdedLidar lidar_{TickParams{}.directions};
  TickOutput output_;
  TapeWriter tape_;
};

}  // namespace
}  // namespace hardpack

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_crowded_tape TAPE\nWrites a tape of the dearest ticks.\n", stderr);
    return 2;
  }
  hardpack::CrowdedDrive drive;
  drive.Drive();
  drive.Check();
  if (!drive.WriteTo(argv[1])) {
    std::fprintf(stderr, "%s: cannot be written\n", argv[1]);
    return 2;
  }
  std::printf("%u ticks\n", drive.ticks());
  return 0;
}
