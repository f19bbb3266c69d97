// SPDX-License-Identifier: Apache-2.0
#include "hal/pose_datagram/pose_datagram.h"

#include <bit>

#include "core/base/byte_reader.h"
#include "core/base/crc32.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack::pose_datagram {
namespace {

constexpr uint32_t kMagic = 0x44505048u;  // "HPPD"
constexpr size_t kMagic_bytes = 4;
constexpr size_t kVersionAt = 4;
constexpr size_t kGroupsAt = 5;
constexpr size_t kModeAt = 6;
constexpr size_t kStatusAt = 7;
constexpr size_t kSequenceAt = 8;
constexpr size_t kReservedAt = 12;
constexpr size_t kTimeAt = 16;
constexpr size_t kGpsTimeAt = 24;
constexpr size_t kLatitudeAt = 32;
constexpr size_t kLongitudeAt = 40;
constexpr size_t kAltitudeAt = 48;
constexpr size_t kVelocityAt = 52;
constexpr size_t kAttitudeAt = 64;
constexpr size_t kRateAt = 76;
constexpr size_t kAccelerationAt = 88;
constexpr size_t kUncertaintyAt = 100;  // of attitude, position, velocity
constexpr size_t kCrcAt = 112;
static_assert(kCrcAt + 4 == kDatagram_bytes);

// Groups that are there.
constexpr uint32_t kHasGpsTime = 0x01u;
constexpr uint32_t kHasPosition = 0x02u;
constexpr uint32_t kHasVelocity = 0x04u;
constexpr uint32_t kHasAttitude = 0x08u;
constexpr uint32_t kHasRate = 0x10u;
constexpr uint32_t kHasAcceleration = 0x20u;
constexpr uint32_t kHasUncertainties = 0x40u;  // of each group that is there
constexpr uint32_t kHasStatus = 0x80u;

constexpr uint32_t kGnssFix = 0x01u;
constexpr uint32_t kTimeError = 0x02u;
constexpr uint32_t kImuError = 0x04u;
constexpr uint32_t kOtherError = 0x08u;
constexpr uint32_t kGnssError = 0x10u;
constexpr uint32_t kGnssHeading = 0x20u;
constexpr uint32_t kGnssCompass = 0x40u;
constexpr uint32_t kStatusBits = 0x7fu;

constexpr int64_t kMaxLatitude_ndeg = 90'000'000'000;
constexpr int64_t kMaxLongitude_ndeg = 180'000'000'000;
// What floats make of pi and of half of it.
constexpr float kAngleTolerance_rad = 1.0e-5f;

void Put(std::span<uint8_t> bytes, size_t at, size_t size, uint64_t value) {
  HP_LOOP_BOUND(8)
  for (size_t i = 0; i < size; ++i) {
    bytes[at + i] = static_cast<uint8_t>(value >> (8 * i) & 0xffu);
  }
}

void PutFloat(std::span<uint8_t> bytes, size_t at, float value) {
  Put(bytes, at, 4, std::bit_cast<uint32_t>(value));
}

void PutThree(std::span<uint8_t> bytes, size_t at, float first, float second, float third) {
  PutFloat(bytes, at, first);
  PutFloat(bytes, at + 4, second);
  PutFloat(bytes, at + 8, third);
}

uint32_t GroupsOf(const InsSample& sample) {
  const bool has_uncertainties = sample.has_attitude_uncertainty ||
                                 sample.has_position_uncertainty || sample.has_velocity_uncertainty;
  return (sample.has_gps_time ? kHasGpsTime : 0u) | (sample.has_position ? kHasPosition : 0u) |
         (sample.has_velocity ? kHasVelocity : 0u) | (sample.has_attitude ? kHasAttitude : 0u) |
         (sample.has_angular_rate ? kHasRate : 0u) |
         (sample.has_acceleration ? kHasAcceleration : 0u) |
         (has_uncertainties ? kHasUncertainties : 0u) | (sample.has_status ? kHasStatus : 0u);
}

uint32_t BitsOf(const InsStatus& status) {
  return (status.gnss_fix ? kGnssFix : 0u) | (status.time_error ? kTimeError : 0u) |
         (status.imu_error ? kImuError : 0u) |
         (status.magnetometer_or_pressure_error ? kOtherError : 0u) |
         (status.gnss_error ? kGnssError : 0u) | (status.gnss_heading ? kGnssHeading : 0u) |
         (status.gnss_compass ? kGnssCompass : 0u);
}

InsStatus StatusOf(uint32_t mode, uint32_t bits) {
  return {.mode = static_cast<InsMode>(mode),
          .gnss_fix = (bits & kGnssFix) != 0,
          .time_error = (bits & kTimeError) != 0,
          .imu_error = (bits & kImuError) != 0,
          .magnetometer_or_pressure_error = (bits & kOtherError) != 0,
          .gnss_error = (bits & kGnssError) != 0,
          .gnss_heading = (bits & kGnssHeading) != 0,
          .gnss_compass = (bits & kGnssCompass) != 0,
          .word = static_cast<uint16_t>(bits)};
}

void ReadPlace(ByteReader& reader, uint32_t groups, InsSample& sample) {
  sample.has_position = (groups & kHasPosition) != 0;
  if (sample.has_position) {
    sample.latitude_ndeg = static_cast<int64_t>(reader.U64(kLatitudeAt));
    sample.longitude_ndeg = static_cast<int64_t>(reader.U64(kLongitudeAt));
    sample.altitude_m = reader.F32(kAltitudeAt);
  }
  sample.has_velocity = (groups & kHasVelocity) != 0;
  if (sample.has_velocity) {
    sample.velocity_ned = {reader.F32(kVelocityAt), reader.F32(kVelocityAt + 4),
                           reader.F32(kVelocityAt + 8)};
  }
}

void ReadMotion(ByteReader& reader, uint32_t groups, InsSample& sample) {
  sample.has_attitude = (groups & kHasAttitude) != 0;
  if (sample.has_attitude) {
    sample.roll_rad = reader.F32(kAttitudeAt);
    sample.pitch_rad = reader.F32(kAttitudeAt + 4);
    sample.yaw_rad = reader.F32(kAttitudeAt + 8);
  }
  sample.has_angular_rate = (groups & kHasRate) != 0;
  if (sample.has_angular_rate) {
    sample.angular_rate = {reader.F32(kRateAt), reader.F32(kRateAt + 4), reader.F32(kRateAt + 8)};
  }
  sample.has_acceleration = (groups & kHasAcceleration) != 0;
  if (sample.has_acceleration) {
    sample.acceleration = {reader.F32(kAccelerationAt), reader.F32(kAccelerationAt + 4),
                           reader.F32(kAccelerationAt + 8)};
  }
}

void ReadUncertainties(ByteReader& reader, uint32_t groups, InsSample& sample) {
  if ((groups & kHasUncertainties) == 0) return;
  sample.has_attitude_uncertainty = sample.has_attitude;
  if (sample.has_attitude) sample.attitude_uncertainty_rad = reader.F32(kUncertaintyAt);
  sample.has_position_uncertainty = sample.has_position;
  if (sample.has_position) sample.position_uncertainty_m = reader.F32(kUncertaintyAt + 4);
  sample.has_velocity_uncertainty = sample.has_velocity;
  if (sample.has_velocity) sample.velocity_uncertainty_mps = reader.F32(kUncertaintyAt + 8);
}

bool IsFiniteSample(const InsSample& sample) {
  return IsFinite(sample.altitude_m) && IsFinite(sample.velocity_ned) &&
         IsFinite(sample.roll_rad) && IsFinite(sample.pitch_rad) && IsFinite(sample.yaw_rad) &&
         IsFinite(sample.angular_rate) && IsFinite(sample.acceleration) &&
         IsFinite(sample.attitude_uncertainty_rad) && IsFinite(sample.position_uncertainty_m) &&
         IsFinite(sample.velocity_uncertainty_mps);
}

bool IsWithin(int64_t value, int64_t most) {
  return value >= -most && value <= most;
}

bool IsPossible(const InsSample& sample) {
  return IsWithin(sample.latitude_ndeg, kMaxLatitude_ndeg) &&
         IsWithin(sample.longitude_ndeg, kMaxLongitude_ndeg) &&
         Abs(sample.roll_rad) <= kPi + kAngleTolerance_rad &&
         Abs(sample.pitch_rad) <= 0.5f * kPi + kAngleTolerance_rad &&
         Abs(sample.yaw_rad) <= kPi + kAngleTolerance_rad &&
         sample.attitude_uncertainty_rad >= 0.0f && sample.position_uncertainty_m >= 0.0f &&
         sample.velocity_uncertainty_mps >= 0.0f;
}

}  // namespace

Status Decode(std::span<const uint8_t, kDatagram_bytes> bytes, uint32_t& sequence,
              InsSample& sample) {
  ByteReader reader(bytes);
  if (reader.U32(0) != kMagic) return Status::kWrongPacketType;
  if (reader.U8(kVersionAt) != kVersion) return Status::kUnsupported;
  if (reader.U32(kCrcAt) != Crc32<kCrcAt>(bytes.first(kCrcAt))) return Status::kBadCrc;
  const uint32_t groups = reader.U8(kGroupsAt);
  const uint32_t mode = reader.U8(kModeAt);
  const uint32_t bits = reader.U8(kStatusAt);
  const bool fits = mode <= static_cast<uint32_t>(InsMode::kGnssLost) &&
                    (bits & ~kStatusBits) == 0 && reader.U32(kReservedAt) == 0;
  if (!fits) return Status::kInvalidArgument;
  InsSample read;
  read.has_timestamp = true;
  read.timestamp_ns = reader.U64(kTimeAt);
  read.has_gps_time = (groups & kHasGpsTime) != 0;
  if (read.has_gps_time) read.gps_time_ns = reader.U64(kGpsTimeAt);
  ReadPlace(reader, groups, read);
  ReadMotion(reader, groups, read);
  ReadUncertainties(reader, groups, read);
  read.has_status = (groups & kHasStatus) != 0;
  if (read.has_status) read.status = StatusOf(mode, bits);
  if (!IsFiniteSample(read)) return Status::kNotFinite;
  if (!IsPossible(read)) return Status::kInvalidArgument;
  sequence = reader.U32(kSequenceAt);
  sample = read;
  return Status::kOk;
}

Status Encode(const InsSample& sample, uint32_t sequence,
              std::span<uint8_t, kDatagram_bytes> bytes) {
  if (!IsFiniteSample(sample) || !IsPossible(sample)) return Status::kInvalidArgument;
  Put(bytes, 0, 4, kMagic);
  Put(bytes, kVersionAt, 1, kVersion);
  Put(bytes, kGroupsAt, 1, GroupsOf(sample));
  Put(bytes, kModeAt, 1, static_cast<uint64_t>(sample.status.mode));
  Put(bytes, kStatusAt, 1, BitsOf(sample.status));
  Put(bytes, kSequenceAt, 4, sequence);
  Put(bytes, kReservedAt, 4, 0);
  Put(bytes, kTimeAt, 8, sample.timestamp_ns);
  Put(bytes, kGpsTimeAt, 8, sample.gps_time_ns);
  Put(bytes, kLatitudeAt, 8, static_cast<uint64_t>(sample.latitude_ndeg));
  Put(bytes, kLongitudeAt, 8, static_cast<uint64_t>(sample.longitude_ndeg));
  PutFloat(bytes, kAltitudeAt, sample.altitude_m);
  const VelocityNed& velocity = sample.velocity_ned;
  PutThree(bytes, kVelocityAt, velocity.north_mps, velocity.east_mps, velocity.down_mps);
  PutThree(bytes, kAttitudeAt, sample.roll_rad, sample.pitch_rad, sample.yaw_rad);
  const AngularRate& rate = sample.angular_rate;
  PutThree(bytes, kRateAt, rate.x_radps, rate.y_radps, rate.z_radps);
  const Acceleration& acceleration = sample.acceleration;
  PutThree(bytes, kAccelerationAt, acceleration.x_mps2, acceleration.y_mps2, acceleration.z_mps2);
  PutThree(bytes, kUncertaintyAt, sample.attitude_uncertainty_rad, sample.position_uncertainty_m,
           sample.velocity_uncertainty_mps);
  Put(bytes, kCrcAt, 4, Crc32<kCrcAt>(std::span<const uint8_t>(bytes).first(kCrcAt)));
  return Status::kOk;
}

size_t Receiver::Feed(std::span<const uint8_t> bytes) {
  if (begin_ > 0 && end_ + bytes.size() > kCapacity) {
    HP_LOOP_BOUND(kCapacity)
    for (size_t i = begin_; i < end_; ++i) bytes_[i - begin_] = bytes_[i];
    end_ -= begin_;
    begin_ = 0;
  }
  const size_t room = kCapacity - end_;
  const size_t taken = bytes.size() < room ? bytes.size() : room;
  HP_LOOP_BOUND(kCapacity)
  for (size_t i = 0; i < taken; ++i) bytes_[end_ + i] = bytes[i];
  end_ += taken;
  counters_.bytes += taken;
  return taken;
}

void Receiver::PassOver(size_t count) {
  begin_ += count;
  counters_.skipped_bytes += count;
}

// Passes over what cannot begin a datagram. False: no whole magic number is left.
bool Receiver::FindMagic() {
  bool found = false;
  HP_LOOP_BOUND(kCapacity)
  while (!found && end_ - begin_ >= kMagic_bytes) {
    ByteReader reader(Waiting());
    found = reader.U32(0) == kMagic;
    if (!found) PassOver(1);
  }
  return found;
}

bool Receiver::IsNewer(uint32_t sequence) {
  const uint32_t ahead = sequence - sequence_;
  const uint32_t behind = sequence_ - sequence;
  if (has_sequence_ && behind < kRestart) {
    ++counters_.repeated;
    return false;
  }
  const bool goes_on = has_sequence_ && ahead <= 0x7fffffffu;
  if (goes_on) counters_.missed += ahead - 1u;
  if (has_sequence_ && !goes_on) ++counters_.restarts;
  has_sequence_ = true;
  sequence_ = sequence;
  return true;
}

Status Receiver::Next(InsSample& sample) {
  HP_LOOP_BOUND(kCapacity)
  while (looks_left_ > 0) {
    if (!FindMagic() || end_ - begin_ < kDatagram_bytes) return Status::kTruncated;
    --looks_left_;
    uint32_t sequence = 0;
    InsSample read;
    const Status status = Decode(Waiting().first<kDatagram_bytes>(), sequence, read);
    if (status == Status::kBadCrc || status == Status::kUnsupported) {
      ++counters_.bad_crc;
      PassOver(1);
      continue;
    }
    begin_ += kDatagram_bytes;
    if (!IsUsable(status)) {
      ++counters_.refused;
      continue;
    }
    if (!IsNewer(sequence)) continue;
    ++counters_.samples;
    sample = read;
    return Status::kOk;
  }
  return Status::kTruncated;
}

void Receiver::Reset() {
  begin_ = 0;
  end_ = 0;
  has_sequence_ = false;
}

}  // namespace hardpack::pose_datagram
