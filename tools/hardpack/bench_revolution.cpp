// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/bench_revolution.h"

#include <iterator>

#include "core/base/math.h"
#include "port_linux/ouster_metadata.h"
#include "tools/hardpack/bench_timing.h"
#include "tools/hardpack/command.h"

namespace hardpack::command {
namespace {

constexpr uint32_t kSeed = 1;
constexpr uint16_t kLidarPort = 7502;

// Keeps the worse of two statuses, so that one look at the end is enough.
void Worsen(Status status, Status& worst) {
  if (!IsUsable(status)) worst = status;
}

}  // namespace

RevolutionBench::RevolutionBench() : recording_(scene::Record(scene::DemoWorld(), kSeed)) {
  Require(ouster::ParseMetadata(recording_.metadata_json, "made-up metadata", metadata_));
  Worsen(ouster::MakeLayout(metadata_, layout_), status_);
  const auto beams = static_cast<size_t>(metadata_.beams);
  Worsen(MakeBeamModel({metadata_.beam_altitude_deg, beams}, {metadata_.beam_azimuth_deg, beams},
                       metadata_.columns_per_frame, metadata_.lidar_origin_to_beam_origin_m,
                       metadata_.sensor_from_lidar, model_),
         status_);
  if (!IsUsable(status_)) throw CommandFailure(kWorkFailed, "the made-up metadata are refused");
  std::erase_if(recording_.datagrams,
                [](const auto& datagram) { return datagram.port != kLidarPort; });
  // The recording holds a bit of the revolutions before and after.
  const auto packets = metadata_.columns_per_frame / layout_.columns_per_packet;
  const auto around = (std::ssize(recording_.datagrams) - packets) / 2;
  recording_.datagrams.erase(recording_.datagrams.begin() + around + packets,
                             recording_.datagrams.end());
  recording_.datagrams.erase(recording_.datagrams.begin(), recording_.datagrams.begin() + around);
  columns_.resize(recording_.datagrams.size() * static_cast<size_t>(layout_.columns_per_packet));
}

BenchRow RevolutionBench::Decode() {
  BenchRow row = {.stage = "decode", .scene = "revolution", .object_bytes = sizeof(LidarColumn)};
  MeasureRow([] {},
             [this] {
               auto column = columns_.begin();
               for (const scene::Datagram& datagram : recording_.datagrams) {
                 ouster::PacketHeader header;
                 Worsen(ouster::CheckPacket(layout_, metadata_, datagram.payload, header), status_);
                 for (int i = 0; i < layout_.columns_per_packet; ++i, ++column) {
                   Worsen(ouster::DecodeColumn(layout_, datagram.payload, i, *column), status_);
                 }
               }
             },
             row);
  row.status = status_;
  return row;
}

Status RevolutionBench::FileColumn(const LidarColumn& column, const Transform3& odom_from_sensor) {
  const Status pushed = ring_->Push(column, odom_from_sensor, ReturnClass::kHard);
  const SinCosPair encoder = EncoderSinCos(model_, column.measurement_id);
  for (int row = 0; row < column.beams; ++row) {
    const PackedReturn one = ring_->at(column.measurement_id, row);
    if (one.range_mm() == 0) continue;
    const Vec3 point = PointInSensor(model_, encoder, row, one.range_mm());
    const Status inserted = heights_->Insert(odom_from_sensor.Apply(point), one.return_class());
    (void)inserted;  // a return off the map is no failure of the bench
  }
  return pushed;
}

void RevolutionBench::FileRevolution() {
  const Transform3 odom_from_sensor = BodyFromSensor(mount_);
  for (const LidarColumn& column : columns_) Worsen(FileColumn(column, odom_from_sensor), status_);
}

BenchRow RevolutionBench::Scan() {
  BenchRow row = {.stage = "scan",
                  .scene = "revolution",
                  .object_bytes = sizeof(ScanRing) + sizeof(HeightGrid)};
  MeasureRow(
      [this] {
        Worsen(ring_->Configure(model_.beams, model_.columns_per_revolution), status_);
        Worsen(heights_->Reset({}), status_);
      },
      [this] { FileRevolution(); }, row);
  row.status = status_;
  return row;
}

}  // namespace hardpack::command
