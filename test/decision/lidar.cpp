// SPDX-License-Identifier: Apache-2.0
#include "test/decision/lidar.h"

#include "core/base/saturate.h"
#include "core/scan/scan.h"

namespace hardpack::decision {
namespace {

constexpr uint64_t kStart_ns = 1'700'000'000'000'000'000u;
constexpr uint64_t kColumnTime_ns = 195'312u;
constexpr uint32_t kEncoderTicks = 90112u;
constexpr uint32_t kColumnValid = 0xffffffffu;
constexpr uint16_t kFrameId = 65535u;

Vec3 Rotate(const Transform3& transform, const Vec3& v) {
  const float* r = transform.rotation;
  return {r[0] * v.x_m + r[1] * v.y_m + r[2] * v.z_m, r[3] * v.x_m + r[4] * v.y_m + r[5] * v.z_m,
          r[6] * v.x_m + r[7] * v.y_m + r[8] * v.z_m};
}

// The beam of one row at one encoder angle, lidar frame; see PointInSensor in core/scan.
Ray Beam(const BeamModel& model, SinCosPair encoder, int row) {
  const float cos_azimuth = model.cos_azimuth[row];
  const float sin_azimuth = model.sin_azimuth[row];
  const float cos_total = encoder.cos * cos_azimuth - encoder.sin * sin_azimuth;
  const float sin_total = encoder.sin * cos_azimuth + encoder.cos * sin_azimuth;
  const float n = model.origin_to_beam_m;
  return {{n * encoder.cos, n * encoder.sin, 0.0f},
          {cos_total * model.cos_altitude[row], sin_total * model.cos_altitude[row],
           model.sin_altitude[row]}};
}

// A code of the RELLIS-3D ontology for each class.
uint8_t LabelOf(ReturnClass what) {
  switch (what) {
    case ReturnClass::kIgnored:
      return 0;  // void
    case ReturnClass::kGround:
      return 3;  // grass
    case ReturnClass::kSoft:
      return 19;  // bush
    case ReturnClass::kPerson:
      return 17;
    case ReturnClass::kHard:
      break;
  }
  return 4;  // tree
}

}  // namespace

Status SyntheticLidar::Configure(uint32_t seed) {
  random_ = Random(seed);
  metadata_.beams = kBeams;
  metadata_.columns_per_frame = kColumns;
  metadata_.columns_per_packet = kColumnsPerPacket;
  metadata_.column_window_last = kColumns - 1;
  metadata_.lidar_origin_to_beam_origin_m = 0.012163f;
  metadata_.sensor_from_lidar = {{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0.0f, 0.0f, 0.03618f}};
  constexpr float kAzimuth_deg[4] = {3.164f, 1.055f, -1.055f, -3.164f};
  for (int row = 0; row < kBeams; ++row) {
    metadata_.beam_altitude_deg[row] = 16.611f - 0.5273f * static_cast<float>(row);
    metadata_.beam_azimuth_deg[row] = kAzimuth_deg[row % 4];
  }
  return MakeBeamModel(
      std::span(metadata_.beam_altitude_deg, kBeams), std::span(metadata_.beam_azimuth_deg, kBeams),
      kColumns, metadata_.lidar_origin_to_beam_origin_m, metadata_.sensor_from_lidar, model_);
}

void SyntheticLidar::Put(size_t offset, uint64_t value, size_t size) {
  for (size_t i = 0; i < size; ++i) packet_[offset + i] = static_cast<uint8_t>(value >> (8 * i));
}

// 0 when there is no return.
uint32_t SyntheticLidar::Measure(const World& world, const Transform3& odom_from_sensor,
                                 SinCosPair encoder, int row, uint8_t& label) {
  const Transform3 odom_from_lidar = odom_from_sensor * model_.sensor_from_lidar;
  const Ray beam = Beam(model_, encoder, row);
  const Hit hit =
      Cast(world, {odom_from_lidar.Apply(beam.origin), Rotate(odom_from_lidar, beam.direction)});
  const float noise_m = random_.RealBetween(-0.02f, 0.02f);
  const bool dropped = random_.Between(0, 99) == 0;
  label = LabelOf(hit.what);
  if (dropped || hit.distance_m >= kFarAway_m) return 0;
  return static_cast<uint32_t>(
      RoundToInt((hit.distance_m + model_.origin_to_beam_m + noise_m) * 1000.0f));
}

void SyntheticLidar::MakePacket(const World& world, std::span<const Transform3> odom_from_sensor,
                                int index, int revolution) {
  const auto frame_id = static_cast<uint16_t>(kFrameId + revolution);  // 65535 is followed by 0
  for (int i = 0; i < kColumnsPerPacket; ++i) {
    const int column = index * kColumnsPerPacket + i;
    const SinCosPair encoder = EncoderSinCos(model_, column);
    const bool valid = random_.Between(0, 99) != 0;
    const size_t at = static_cast<size_t>(i) * (kPacketBytes / kColumnsPerPacket);
    const int since = revolution * kColumns + column;
    Put(at, kStart_ns + static_cast<uint64_t>(since) * kColumnTime_ns, 8);
    Put(at + 8, static_cast<uint64_t>(column), 2);
    Put(at + 10, frame_id, 2);
    Put(at + 12, static_cast<uint64_t>(column) * (kEncoderTicks / kColumns), 4);
    labels_[i].frame_id = frame_id;
    labels_[i].measurement_id = static_cast<uint16_t>(column);
    labels_[i].beams = kBeams;
    for (int row = 0; row < kBeams; ++row) {
      const uint32_t range_mm = Measure(world, odom_from_sensor[static_cast<size_t>(column)],
                                        encoder, row, labels_[i].label[row]);
      const size_t pixel = at + 16 + static_cast<size_t>(row) * 12;
      Put(pixel, range_mm | (random_.Next() & 0xf0000000u), 4);
      Put(pixel + 4, random_.Next() & 0xffffu, 2);
      Put(pixel + 6, random_.Next() & 0xffffu, 2);
      Put(pixel + 8, random_.Next() & 0xffffu, 2);
    }
    Put(at + 16 + 12 * kBeams, valid ? kColumnValid : 0u, 4);
  }
}

}  // namespace hardpack::decision
