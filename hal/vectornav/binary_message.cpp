// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"
#include "hal/vectornav/binary64.h"
#include "hal/vectornav/crc16.h"
#include "hal/vectornav/fields.h"
#include "hal/vectornav/vectornav.h"

// The binary half of hal/vectornav/vectornav.h.

namespace hardpack::vectornav {
namespace {

constexpr size_t kGroups = 7;
constexpr size_t kFieldsPerGroup = 15;
constexpr uint32_t kExtensionOfGroups = 0x80u;
constexpr size_t kCrcBytes = 2;
constexpr size_t kGroupsOffset = 1;
constexpr size_t kMasksOffset = 2;

// What a field is to us.
enum class Use : uint8_t {
  kNone,
  kTimeStartup,
  kTimeGps,
  kYawPitchRoll,
  kAngularRate,
  kPosition,
  kVelocity,
  kAcceleration,
  kInsStatus,
  kPositionUncertainty,
  kVelocityUncertainty,
};

struct Field {
  uint8_t bytes = 0;  // 0: not documented, or of no fixed size
  Use use = Use::kNone;
};

// [kGroups x kFieldsPerGroup], by bit.
// clang-format off
constexpr Field kFields[kGroups][kFieldsPerGroup] = {
    // Common: ... TimeSyncIn, Quaternion, Imu, MagPres, Deltas, SyncInCnt, TimeGpsPps
    {{8, Use::kTimeStartup}, {8, Use::kTimeGps}, {8}, {12, Use::kYawPitchRoll}, {16},
     {12, Use::kAngularRate}, {24, Use::kPosition}, {12, Use::kVelocity}, {12, Use::kAcceleration},
     {24}, {20}, {28}, {2, Use::kInsStatus}, {4}, {8}},
    // Time: ... GpsTow, GpsWeek, TimeSyncIn, TimeGpsPps, TimeUtc, SyncInCnt, SyncOutCnt, TimeStatus
    {{8, Use::kTimeStartup}, {8, Use::kTimeGps}, {8}, {2}, {8}, {8}, {8}, {4}, {4}, {1}},
    // IMU: ImuStatus, uncompensated mag, accel, gyro, Temp, Pres, DeltaTheta, DeltaVel, Mag ...,
    // SensSat, Raw
    {{2}, {12}, {12}, {12}, {4}, {4}, {16}, {12}, {12}, {12, Use::kAcceleration},
     {12, Use::kAngularRate}, {2}, {40}},
    // GPS: UTC, Tow, Week, NumSats, Fix, PosLla, PosEcef, VelNed, VelEcef, PosU, VelU, TimeU,
    // TimeInfo, DOP; SatInfo varies
    {{8}, {8}, {2}, {1}, {1}, {24}, {24}, {12}, {12}, {12}, {4}, {4}, {2}, {28}},
    // Attitude: VpeStatus ... Quaternion, DCM, MagNed, AccelNed, LinearAccelBody, LinearAccelNed,
    // YprU, two reserved, a reserved one, Heave
    {{2}, {12, Use::kYawPitchRoll}, {16}, {36}, {12}, {12}, {12}, {12}, {12}, {12}, {28}, {24},
     {12}},
    // INS: ... PosEcef, VelBody ..., VelEcef, MagEcef, AccelEcef, LinearAccelEcef ..., two reserved
    {{2, Use::kInsStatus}, {24, Use::kPosition}, {24}, {12}, {12, Use::kVelocity}, {12}, {12}, {12},
     {12}, {4, Use::kPositionUncertainty}, {4, Use::kVelocityUncertainty}, {68}, {64}},
    // GPS2: as GPS
    {{8}, {8}, {2}, {1}, {1}, {24}, {24}, {12}, {12}, {12}, {4}, {4}, {2}, {28}},
};
// clang-format on

// The bits of the fields of known size.
consteval uint32_t KnownFields(size_t group) {
  uint32_t known = 0;
  HP_LOOP_BOUND(kFieldsPerGroup)
  for (size_t bit = 0; bit < kFieldsPerGroup; ++bit) {
    if (kFields[group][bit].bytes != 0) known |= 1u << bit;
  }
  return known;
}

constexpr std::array<uint32_t, kGroups> kKnownFields = {
    KnownFields(0), KnownFields(1), KnownFields(2), KnownFields(3),
    KnownFields(4), KnownFields(5), KnownFields(6)};

constexpr size_t FieldBytes(size_t group, uint32_t mask) {
  size_t bytes = 0;
  HP_LOOP_BOUND(kFieldsPerGroup)
  for (size_t bit = 0; bit < kFieldsPerGroup; ++bit) {
    if ((mask >> bit & 1u) != 0) bytes += kFields[group][bit].bytes;
  }
  return bytes;
}

consteval size_t LargestMessage() {
  size_t bytes = kMasksOffset + kCrcBytes;
  HP_LOOP_BOUND(kGroups)
  for (size_t group = 0; group < kGroups; ++group) bytes += 2 + FieldBytes(group, 0x7fffu);
  return bytes;
}
static_assert(LargestMessage() == kMaxBinaryBytes);
static_assert(kMaxBinaryBytes <= kMaxCrcBytes);

// Of AngularRate, Acceleration or VelocityNed.
template <typename Vector>
Vector ReadVector(ByteReader& bytes, size_t offset) {
  return {bytes.F32(offset), bytes.F32(offset + 4), bytes.F32(offset + 8)};
}

Status ReadPosition(ByteReader& bytes, size_t offset, InsSample& sample) {
  int64_t latitude_ndeg = 0;
  int64_t longitude_ndeg = 0;
  const Status latitude = BillionthsFromBinary64(bytes.U64(offset), latitude_ndeg);
  const Status longitude = BillionthsFromBinary64(bytes.U64(offset + 8), longitude_ndeg);
  if (latitude == Status::kNotFinite || longitude == Status::kNotFinite) return Status::kNotFinite;
  if (!IsUsable(latitude) || !IsUsable(longitude)) return Status::kInvalidArgument;
  return SetPosition(latitude_ndeg, longitude_ndeg, FloatFromBinary64(bytes.U64(offset + 16)),
                     sample);
}

Status ReadField(Use use, ByteReader& bytes, size_t offset, InsSample& sample) {
  switch (use) {
    case Use::kNone:
      return Status::kOk;
    case Use::kTimeStartup:
      sample.has_timestamp = true;
      sample.timestamp_ns = bytes.U64(offset);
      return Status::kOk;
    case Use::kTimeGps:
      SetGpsTime(bytes.U64(offset), sample);
      return Status::kOk;
    case Use::kYawPitchRoll:
      return SetAttitude(bytes.F32(offset), bytes.F32(offset + 4), bytes.F32(offset + 8), sample);
    case Use::kAngularRate:
      return SetAngularRate(ReadVector<AngularRate>(bytes, offset), sample);
    case Use::kPosition:
      return ReadPosition(bytes, offset, sample);
    case Use::kVelocity:
      return SetVelocity(ReadVector<VelocityNed>(bytes, offset), sample);
    case Use::kAcceleration:
      return SetAcceleration(ReadVector<Acceleration>(bytes, offset), sample);
    case Use::kInsStatus:
      SetStatus(bytes.U16(offset), sample);
      return Status::kOk;
    case Use::kPositionUncertainty:
      return SetPositionUncertainty(bytes.F32(offset), sample);
    case Use::kVelocityUncertainty:
      return SetVelocityUncertainty(bytes.F32(offset), sample);
  }
  return Status::kUnsupported;
}

// The fields of one group, from `offset` on, which is led behind them.
Status ReadGroup(size_t group, uint32_t mask, ByteReader& bytes, size_t& offset,
                 InsSample& sample) {
  HP_LOOP_BOUND(kFieldsPerGroup)
  for (size_t bit = 0; bit < kFieldsPerGroup; ++bit) {
    if ((mask >> bit & 1u) == 0) continue;
    const Field& field = kFields[group][bit];
    const Status read = ReadField(field.use, bytes, offset, sample);
    if (!IsUsable(read)) return read;
    offset += field.bytes;
  }
  return Status::kOk;
}

// Not std::popcount: a processor without that instruction calls a library for it.
size_t SelectedGroups(uint32_t groups) {
  size_t selected = 0;
  HP_LOOP_BOUND(kGroups)
  for (size_t group = 0; group < kGroups; ++group) selected += groups >> group & 1u;
  return selected;
}

bool SaysAnything(const InsSample& sample) {
  return sample.has_timestamp || sample.has_gps_time || sample.has_attitude ||
         sample.has_angular_rate || sample.has_acceleration || sample.has_position ||
         sample.has_velocity || sample.has_status || sample.has_position_uncertainty ||
         sample.has_velocity_uncertainty;
}

}  // namespace

Status BinaryMessageSize(std::span<const uint8_t> bytes, size_t& message_bytes) {
  ByteReader header(bytes);
  if (bytes.empty()) return Status::kTruncated;
  if (header.U8(0) != kBinarySync) return Status::kUnsupported;
  if (bytes.size() <= kGroupsOffset) return Status::kTruncated;
  const uint32_t groups = header.U8(kGroupsOffset);
  if (groups == 0 || (groups & kExtensionOfGroups) != 0) return Status::kUnsupported;

  size_t total = kMasksOffset + kCrcBytes;
  size_t offset = kMasksOffset;
  HP_LOOP_BOUND(kGroups)
  for (size_t group = 0; group < kGroups; ++group) {
    if ((groups >> group & 1u) == 0) continue;
    const uint32_t mask = header.U16(offset);
    if (!IsUsable(header.status())) return Status::kTruncated;
    // A selected group of no fields is not sent. The extension bit is no known field.
    if (mask == 0 || (mask & ~kKnownFields[group]) != 0) return Status::kUnsupported;
    total += 2 + FieldBytes(group, mask);
    offset += 2;
  }
  message_bytes = total;
  return Status::kOk;
}

Status DecodeCheckedBinary(std::span<const uint8_t> message, InsSample& sample) {
  ByteReader bytes(message);
  const uint32_t groups = bytes.U8(kGroupsOffset);
  size_t mask_offset = kMasksOffset;
  size_t offset = kMasksOffset + 2 * SelectedGroups(groups);
  InsSample read;
  HP_LOOP_BOUND(kGroups)
  for (size_t group = 0; group < kGroups; ++group) {
    if ((groups >> group & 1u) == 0) continue;
    const Status status = ReadGroup(group, bytes.U16(mask_offset), bytes, offset, read);
    if (!IsUsable(status)) return status;
    mask_offset += 2;
  }
  if (!IsUsable(bytes.status())) return bytes.status();
  if (!SaysAnything(read)) return Status::kWrongPacketType;
  sample = read;
  return Status::kOk;
}

Status DecodeBinary(std::span<const uint8_t> message, InsSample& sample) {
  size_t message_bytes = 0;
  const Status sized = BinaryMessageSize(message, message_bytes);
  if (!IsUsable(sized)) return sized;
  if (message.size() < message_bytes) return Status::kTruncated;
  if (message.size() > message_bytes) return Status::kOversized;
  if (Crc16(message.subspan(1)) != 0) return Status::kBadCrc;
  return DecodeCheckedBinary(message, sample);
}

}  // namespace hardpack::vectornav
