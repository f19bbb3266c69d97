// SPDX-License-Identifier: Apache-2.0
// Any bytes as a lidar's datagrams: of every profile and size, through the monitor, the codec and
// the geometry of the beams; and as IMU packets.
//   byte 0  profile, beams, columns a frame
//   byte 1  columns a packet, whether the metadata state an identity and a CRC
//   then datagrams: a u16 with their size in the input, a byte that says what is to be done with
//   them (kResume ...), the bytes

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <vector>

#include "core/scan/scan.h"
#include "hal/ouster/crc64.h"
#include "hal/ouster/ouster.h"
#include "hal/ouster/packet_monitor.h"
#include "test/fuzz/accepted.h"

using hardpack::BeamModel;
using hardpack::ImuSample;
using hardpack::LidarColumn;
using hardpack::Status;
using hardpack::Transform3;
using hardpack::Vec3;
using hardpack::ouster::Metadata;
using hardpack::ouster::PacketCounters;
using hardpack::ouster::PacketHeader;
using hardpack::ouster::PacketLayout;
using hardpack::ouster::PacketMonitor;
using hardpack::ouster::Profile;

namespace {

enum Treatment : uint8_t {
  kResume = 1,   // before it
  kFill = 2,     // with zeros, or cut it, to the size of a packet
  kRepair = 4,   // type and identity
  kSeal = 8,     // with its CRC
  kRepeat = 16,  // the one before it instead
};

void Require(bool condition) {
  if (!condition) std::abort();
}

Metadata MetadataFrom(uint8_t first, uint8_t second) {
  Metadata metadata;
  metadata.profile = static_cast<Profile>(first % 4);
  metadata.beams = 16 << (first / 4 % 4);
  metadata.columns_per_frame = 512 << (first / 16 % 3);
  metadata.columns_per_packet = 1 + second % 16;
  metadata.column_window_first = first >= 128 ? 100 : 0;
  metadata.column_window_last = first >= 192 ? 50 : metadata.columns_per_frame - 1;
  metadata.init_id = second & 0x20 ? 0x010203 : 0;
  metadata.serial_number = second & 0x40 ? 0x0102030405 : 0;
  metadata.crc_in_footer = (second & 0x80) != 0;
  return metadata;
}

uint64_t SumOf(const PacketCounters& c) {
  return c.accepted + c.wrong_size + c.wrong_type + c.bad_crc + c.wrong_sensor + c.not_resumed +
         c.before_start + c.duplicates;
}

void CheckColumn(const Metadata& metadata, const BeamModel& model, const LidarColumn& column) {
  Require(column.valid && column.beams == metadata.beams);
  Require(column.measurement_id < metadata.columns_per_frame);
  const bool dual = metadata.profile == Profile::kRng19Rfl8Sig16Nir16Dual;
  Require(column.returns == (dual ? 2 : 1));
  const hardpack::SinCosPair encoder = EncoderSinCos(model, column.measurement_id);
  for (int row = 0; row < metadata.beams; ++row) {
    if (metadata.profile == Profile::kRng15Rfl8Nir8) {
      Require(column.range_mm[row] % 8 == 0 && column.range_mm[row] <= 262136);
    }
    const uint32_t farthest_mm =
        dual ? std::max(column.range_mm[row], column.second_range_mm[row]) : column.range_mm[row];
    const Vec3 point = PointInSensor(model, encoder, row, farthest_mm);
    Require(hardpack::Abs(point.x_m) < 1100.0f && hardpack::Abs(point.y_m) < 1100.0f);
  }
}

void DecodeAll(const PacketLayout& layout, const Metadata& metadata, const BeamModel& model,
               std::span<const uint8_t> packet, bool accepted) {
  static const auto column = std::make_unique<LidarColumn>();
  for (int index = -1; index <= metadata.columns_per_packet; ++index) {
    const Status decoded = DecodeColumn(layout, packet, index, *column);
    if (index < 0 || index == metadata.columns_per_packet) {
      Require(decoded == Status::kInvalidArgument);
    } else if (accepted) {
      Require(decoded == Status::kOk || decoded == Status::kColumnInvalid ||
              decoded == Status::kBadColumn);
    }
    if (decoded == Status::kOk) CheckColumn(metadata, model, *column);
  }
}

void CheckImu(std::span<const uint8_t> packet) {
  ImuSample sample;
  if (!IsUsable(hardpack::ouster::DecodeImu(packet, sample))) return;
  hardpack::Accepted("imu");
  Require(packet.size() == 48);
  Require(hardpack::IsFinite(sample.acceleration.x_mps2) &&
          hardpack::IsFinite(sample.angular_rate.z_radps));
}

void NoteAccepted(const Metadata& metadata) {
  constexpr const char* kProfiles[] = {"legacy", "rng19", "rng15", "dual"};
  hardpack::Accepted(kProfiles[static_cast<int>(metadata.profile)]);
  if (metadata.crc_in_footer) hardpack::Accepted("crc");
}

void Treat(uint8_t treatment, const PacketLayout& layout, std::vector<uint8_t>& packet) {
  if ((treatment & kFill) != 0) packet.resize(static_cast<size_t>(layout.packet_bytes));
  if (packet.size() < 64) return;
  if ((treatment & kRepair) != 0) {
    const uint8_t header[] = {1, 0, packet[2], packet[3], 3, 2, 1, 5, 4, 3, 2, 1};
    std::copy(std::begin(header), std::end(header), packet.begin());
  }
  if ((treatment & kSeal) != 0) {
    const size_t covered = packet.size() - 8;
    const uint64_t crc = hardpack::ouster::Crc64({packet.data(), covered});
    for (size_t i = 0; i < 8; ++i) packet[covered + i] = static_cast<uint8_t>(crc >> (8 * i));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const Metadata metadata = MetadataFrom(data[0], data[1]);
  std::span<const uint8_t> rest(data + 2, size - 2);

  PacketMonitor monitor;
  Require(monitor.Configure(metadata) == Status::kOk);
  const PacketLayout& layout = monitor.layout();
  static const auto model = std::make_unique<BeamModel>();
  const size_t beams = static_cast<size_t>(metadata.beams);
  Require(MakeBeamModel({metadata.beam_altitude_deg, beams}, {metadata.beam_azimuth_deg, beams},
                        metadata.columns_per_frame, 0.015f, Transform3{}, *model) == Status::kOk);
  std::vector<uint8_t> packet;
  for (uint64_t given = 1; rest.size() >= 3; ++given) {
    const size_t length = std::min<size_t>(rest[0] + 256u * rest[1], rest.size() - 3);
    const uint8_t treatment = rest[2];
    if ((treatment & kRepeat) == 0) packet.assign(rest.data() + 3, rest.data() + 3 + length);
    rest = rest.subspan(3 + length);
    Treat(treatment, layout, packet);
    if ((treatment & kResume) != 0) monitor.Resume();
    CheckImu(packet);
    PacketHeader header;
    const bool accepted = monitor.Check(packet, header) == Status::kOk;
    Require(SumOf(monitor.counters()) == given);
    Require(monitor.counters().missing <= given * 101 * 2048);
    if (accepted) Require(static_cast<int>(packet.size()) == layout.packet_bytes);
    if (accepted) NoteAccepted(metadata);
    DecodeAll(layout, metadata, *model, packet, accepted);
  }
  return 0;
}
