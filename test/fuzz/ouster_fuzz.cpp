// SPDX-License-Identifier: Apache-2.0
// Any bytes as a lidar packet: checked, decoded, filed and turned into points. The first two bytes
// choose the sensor.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "core/scan/scan.h"
#include "hal/ouster/ouster.h"

using hardpack::BeamModel;
using hardpack::LidarColumn;
using hardpack::ReturnClass;
using hardpack::ScanRing;
using hardpack::Status;
using hardpack::Transform3;
using hardpack::Vec3;

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  hardpack::ouster::Metadata metadata;
  metadata.profile = static_cast<hardpack::ouster::Profile>(data[0] % 2);
  metadata.beams = 16 << (data[0] / 2 % 4);
  metadata.columns_per_frame = 512 << (data[0] / 8 % 2);
  metadata.columns_per_packet = 1 + data[1] % 16;
  metadata.init_id = data[1] / 128;
  const std::span<const uint8_t> packet(data + 2, size - 2);

  hardpack::ouster::PacketLayout layout;
  Require(MakeLayout(metadata, layout) == Status::kOk);
  hardpack::ouster::PacketHeader header;
  const bool whole = IsUsable(CheckPacket(layout, metadata, packet, header));

  static const auto ring = std::make_unique<ScanRing>();
  static const auto column = std::make_unique<LidarColumn>();
  static const auto model = std::make_unique<BeamModel>();
  const size_t beams = static_cast<size_t>(metadata.beams);
  Require(MakeBeamModel({metadata.beam_altitude_deg, beams}, {metadata.beam_azimuth_deg, beams},
                        metadata.columns_per_frame, 0.015f, Transform3{}, *model) == Status::kOk);
  Require(ring->Configure(metadata.beams, metadata.columns_per_frame) == Status::kOk);
  for (int index = -1; index <= metadata.columns_per_packet; ++index) {
    const Status decoded = DecodeColumn(layout, packet, index, *column);
    if (whole && index >= 0 && index < metadata.columns_per_packet) {
      Require(decoded == Status::kOk || decoded == Status::kColumnInvalid ||
              decoded == Status::kBadColumn);
    }
    const Status filed = ring->Push(*column, Transform3{}, ReturnClass::kHard);
    if (decoded != Status::kOk) continue;
    Require(filed == Status::kOk || filed == Status::kDuplicate);
    const int id = column->measurement_id;
    for (int row = 0; row < metadata.beams; ++row) {
      const Vec3 point =
          PointInSensor(*model, EncoderSinCos(*model, id), row, ring->at(id, row).range_mm());
      Require(hardpack::Abs(point.x_m) < 1100.0f && hardpack::Abs(point.y_m) < 1100.0f);
    }
  }
  return 0;
}
