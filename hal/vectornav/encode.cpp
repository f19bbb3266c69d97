// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/encode.h"

#include <bit>
#include <limits>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/wide_int.h"
#include "hal/vectornav/binary64.h"
#include "hal/vectornav/crc16.h"
#include "hal/vectornav/fields.h"
#include "hal/vectornav/vectornav.h"

namespace hardpack::vectornav {
namespace {

constexpr uint8_t kCommonGroup = 0x01;

// Appends to a buffer; what does not fit, or cannot be written, is told at the end.
class Writer {
 public:
  explicit Writer(std::span<uint8_t> bytes) : bytes_(bytes) {}

  Status status() const { return status_; }
  std::span<const uint8_t> written() const { return bytes_.first(at_); }

  // The first reason counts.
  void Refuse(Status status) {
    if (IsUsable(status_)) status_ = status;
  }
  void Byte(uint32_t byte) {
    if (at_ >= bytes_.size()) {
      Refuse(Status::kCapacityExceeded);
      return;
    }
    bytes_[at_++] = static_cast<uint8_t>(byte & 0xffu);
  }
  void U16(uint32_t value) { Lowest(value, 2); }
  void U64(uint64_t value) { Lowest(value, 8); }
  void F32(float value) { Lowest(std::bit_cast<uint32_t>(value), 4); }
  void Vector(float x, float y, float z) {
    F32(x);
    F32(y);
    F32(z);
  }

 private:
  void Lowest(uint64_t value, int bytes) {
    HP_LOOP_BOUND(8)
    for (int i = 0; i < bytes; ++i) Byte(static_cast<uint32_t>(value >> (8 * i) & 0xffu));
  }

  std::span<uint8_t> bytes_;
  size_t at_ = 0;
  Status status_ = Status::kOk;
};

uint32_t StatusWord(const InsStatus& status) {
  constexpr uint32_t kNamed = kStatusModeMask | kStatusGnssFix | kStatusTimeError |
                              kStatusImuError | kStatusMagnetometerOrPressureError |
                              kStatusGnssError | kStatusGnssHeading | kStatusGnssCompass;
  uint32_t word = (status.word & ~kNamed) | static_cast<uint32_t>(status.mode);
  if (status.gnss_fix) word |= kStatusGnssFix;
  if (status.time_error) word |= kStatusTimeError;
  if (status.imu_error) word |= kStatusImuError;
  if (status.magnetometer_or_pressure_error) word |= kStatusMagnetometerOrPressureError;
  if (status.gnss_error) word |= kStatusGnssError;
  if (status.gnss_heading) word |= kStatusGnssHeading;
  if (status.gnss_compass) word |= kStatusGnssCompass;
  return word;
}

constexpr float Degrees(float angle_rad) {
  constexpr float kDegPerRad = 57.2957795130823208768f;
  return angle_rad * kDegPerRad;
}

// The bits of the Common group's fields that the sample has.
uint32_t CommonFields(const InsSample& sample) {
  return (sample.has_timestamp ? 1u << 0u : 0u) | (sample.has_gps_time ? 1u << 1u : 0u) |
         (sample.has_attitude ? 1u << 3u : 0u) | (sample.has_angular_rate ? 1u << 5u : 0u) |
         (sample.has_position ? 1u << 6u : 0u) | (sample.has_velocity ? 1u << 7u : 0u) |
         (sample.has_acceleration ? 1u << 8u : 0u) | (sample.has_status ? 1u << 12u : 0u);
}

// Decimal text.
constexpr int kMaxPlaces = 12;

// So many digits, with a point before the last `decimals`. Precondition: value >= 0.
void WriteDigits(Writer& line, int64_t value, int places, int decimals) {
  uint8_t digits[kMaxPlaces] = {};
  HP_LOOP_BOUND(kMaxPlaces)
  for (int i = 0; i < places; ++i) {
    const Division division = Divide(value, 10);
    digits[i] = static_cast<uint8_t>('0' + division.remainder);
    value = division.quotient;
  }
  if (value != 0) line.Refuse(Status::kInvalidArgument);
  HP_LOOP_BOUND(kMaxPlaces)
  for (int i = places - 1; i >= 0; --i) {
    line.Byte(digits[i]);
    if (i == decimals && decimals != 0) line.Byte('.');
  }
}

void WriteSigned(Writer& line, int64_t value, int places, int decimals) {
  line.Byte(value < 0 ? '-' : '+');
  WriteDigits(line, value < 0 ? -value : value, places, decimals);
  line.Byte(',');
}

void WriteHex(Writer& line, uint32_t value, int digits) {
  HP_LOOP_BOUND(4)
  for (int i = digits - 1; i >= 0; --i) {
    const uint32_t digit = value >> (4 * i) & 0xfu;
    line.Byte(digit < 10 ? '0' + digit : 'A' + digit - 10);
  }
}

template <size_t kSize>
void WriteText(Writer& line, const char (&text)[kSize]) {
  HP_LOOP_BOUND(kSize - 1)
  for (size_t i = 0; i + 1 < kSize; ++i) line.Byte(static_cast<uint8_t>(text[i]));
}

int32_t Thousandths(float value) {
  return RoundToInt(value * 1000.0f);
}

// Nanodegrees to the nearest 1e-8 degree, halves away from zero.
int64_t HundredMillionths(int64_t angle_ndeg) {
  return angle_ndeg < 0 ? -Divide(5 - angle_ndeg, 10).quotient
                        : Divide(angle_ndeg + 5, 10).quotient;
}

// Time of week in microseconds, and the week. Precondition: time_ns >= 0.
void WriteTime(Writer& line, int64_t time_ns) {
  // A week is 60480 * 10000 * 1000 microseconds: three divisions by what a Divide takes.
  const int64_t time_us = Divide(time_ns, 1000).quotient;
  const Division first = Divide(time_us, 60480);
  const Division second = Divide(first.quotient, 10000);
  const Division third = Divide(second.quotient, 1000);
  const int64_t in_week_us =
      first.remainder + int64_t{60480} * (second.remainder + 10000 * third.remainder);
  WriteDigits(line, in_week_us, 12, 6);
  line.Byte(',');
  WriteDigits(line, third.quotient, 4, 0);
  line.Byte(',');
}

void WriteFields(Writer& line, const InsSample& sample) {
  WriteHex(line, StatusWord(sample.status), 4);
  line.Byte(',');
  WriteSigned(line, Thousandths(Degrees(sample.yaw_rad)), 6, 3);
  WriteSigned(line, Thousandths(Degrees(sample.pitch_rad)), 6, 3);
  WriteSigned(line, Thousandths(Degrees(sample.roll_rad)), 6, 3);
  WriteSigned(line, HundredMillionths(sample.latitude_ndeg), 10, 8);
  WriteSigned(line, HundredMillionths(sample.longitude_ndeg), 11, 8);
  WriteSigned(line, Thousandths(sample.altitude_m), 8, 3);
  WriteSigned(line, Thousandths(sample.velocity_ned.north_mps), 6, 3);
  WriteSigned(line, Thousandths(sample.velocity_ned.east_mps), 6, 3);
  WriteSigned(line, Thousandths(sample.velocity_ned.down_mps), 6, 3);
  WriteDigits(line, RoundToInt(Abs(Degrees(sample.attitude_uncertainty_rad)) * 10.0f), 3, 1);
  line.Byte(',');
  WriteDigits(line, RoundToInt(Abs(sample.position_uncertainty_m) * 10.0f), 3, 1);
  line.Byte(',');
  WriteDigits(line, RoundToInt(Abs(sample.velocity_uncertainty_mps) * 100.0f), 3, 2);
}

}  // namespace

Status EncodeBinary(const InsSample& sample, std::span<uint8_t> message, size_t& message_bytes) {
  const uint32_t fields = CommonFields(sample);
  if (fields == 0) return Status::kInvalidArgument;
  Writer writer(message);
  writer.Byte(kBinarySync);
  writer.Byte(kCommonGroup);
  writer.U16(fields);
  if (sample.has_timestamp) writer.U64(sample.timestamp_ns);
  if (sample.has_gps_time) writer.U64(sample.gps_time_ns);
  if (sample.has_attitude) {
    writer.Vector(Degrees(sample.yaw_rad), Degrees(sample.pitch_rad), Degrees(sample.roll_rad));
  }
  if (sample.has_angular_rate) {
    const AngularRate& rate = sample.angular_rate;
    writer.Vector(rate.x_radps, rate.y_radps, rate.z_radps);
  }
  if (sample.has_position) {
    writer.U64(Binary64FromBillionths(sample.latitude_ndeg));
    writer.U64(Binary64FromBillionths(sample.longitude_ndeg));
    writer.U64(Binary64FromFloat(sample.altitude_m));
  }
  if (sample.has_velocity) {
    const VelocityNed& velocity = sample.velocity_ned;
    writer.Vector(velocity.north_mps, velocity.east_mps, velocity.down_mps);
  }
  if (sample.has_acceleration) {
    const Acceleration& acceleration = sample.acceleration;
    writer.Vector(acceleration.x_mps2, acceleration.y_mps2, acceleration.z_mps2);
  }
  if (sample.has_status) writer.U16(StatusWord(sample.status));
  if (!IsUsable(writer.status())) return writer.status();
  const uint32_t crc = Crc16(writer.written().subspan(1));
  writer.Byte(crc >> 8u);
  writer.Byte(crc);
  if (!IsUsable(writer.status())) return writer.status();
  message_bytes = writer.written().size();
  return Status::kOk;
}

Status EncodeAscii(const InsSample& sample, std::span<uint8_t> line, size_t& line_bytes) {
  const uint64_t time_ns = sample.has_gps_time ? sample.gps_time_ns : sample.timestamp_ns;
  if (time_ns > static_cast<uint64_t>(std::numeric_limits<int64_t>::max())) {
    return Status::kInvalidArgument;
  }
  Writer writer(line);
  WriteText(writer, "$VNINS,");
  WriteTime(writer, static_cast<int64_t>(time_ns));
  WriteFields(writer, sample);
  if (!IsUsable(writer.status())) return writer.status();
  uint32_t sum = 0;
  HP_LOOP_BOUND(kMaxAsciiBytes)
  for (const uint8_t character : writer.written().subspan(1)) sum ^= character;
  writer.Byte('*');
  WriteHex(writer, sum, 2);
  WriteText(writer, "\r\n");
  if (!IsUsable(writer.status())) return writer.status();
  line_bytes = writer.written().size();
  return Status::kOk;
}

}  // namespace hardpack::vectornav
