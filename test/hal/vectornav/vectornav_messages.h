// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/measurements/measurements.h"
#include "hal/vectornav/stream_parser.h"

// What the tests of hal/vectornav share: messages put together with the host's own arithmetic, and
// samples compared bit by bit.

namespace hardpack::vectornav::test {

// CRC-16/XMODEM, bit by bit from its definition.
inline uint16_t SlowCrc16(std::span<const uint8_t> bytes) {
  uint32_t crc = 0;
  for (const uint8_t byte : bytes) {
    for (int bit = 7; bit >= 0; --bit) {
      const uint32_t out = (crc >> 15u ^ uint32_t{byte} >> bit) & 1u;
      crc = (crc << 1u & 0xffffu) ^ (out != 0 ? 0x1021u : 0u);
    }
  }
  return static_cast<uint16_t>(crc);
}

// A binary message, put together field by field. The host is little-endian.
class MessageBuilder {
 public:
  explicit MessageBuilder(uint8_t groups, std::initializer_list<uint16_t> masks)
      : bytes_{0xfa, groups} {
    for (const uint16_t mask : masks) Add(mask);
  }

  template <typename T>
  MessageBuilder& Add(T value) {
    uint8_t bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const uint8_t byte : bytes) bytes_.push_back(byte);
    return *this;
  }
  MessageBuilder& Vector(float x, float y, float z) { return Add(x).Add(y).Add(z); }
  MessageBuilder& Filler(size_t count, uint8_t byte = 0x5a) {
    bytes_.insert(bytes_.end(), count, byte);
    return *this;
  }
  std::vector<uint8_t> Build() const {
    std::vector<uint8_t> message = bytes_;
    const uint16_t crc = SlowCrc16(std::span<const uint8_t>(message).subspan(1));
    message.push_back(static_cast<uint8_t>(crc >> 8));
    message.push_back(static_cast<uint8_t>(crc & 0xff));
    return message;
  }

 private:
  std::vector<uint8_t> bytes_;
};

// What a common group's payload says, in the units of the wire.
struct Common {
  uint64_t startup_ns = 0;
  uint64_t gps_ns = 0;
  float yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
  float rate_radps[3] = {};
  double latitude_deg = 0, longitude_deg = 0, altitude_m = 0;
  float velocity_mps[3] = {};
  uint16_t status = 0;
};

// FA 01 EB 10.
inline std::vector<uint8_t> CommonMessage(const Common& common) {
  return MessageBuilder(0x01, {0x10eb})
      .Add(common.startup_ns)
      .Add(common.gps_ns)
      .Vector(common.yaw_deg, common.pitch_deg, common.roll_deg)
      .Vector(common.rate_radps[0], common.rate_radps[1], common.rate_radps[2])
      .Add(common.latitude_deg)
      .Add(common.longitude_deg)
      .Add(common.altitude_m)
      .Vector(common.velocity_mps[0], common.velocity_mps[1], common.velocity_mps[2])
      .Add(common.status)
      .Build();
}

// The n-th of a series of messages of which no two are alike.
inline std::vector<uint8_t> NumberedMessage(uint32_t n) {
  Common common;
  common.startup_ns = 5'000'000ull * n;
  common.gps_ns = 1'400'000'000'000'000'000ull + common.startup_ns;
  common.yaw_deg = static_cast<float>(n % 360) - 180.0f;
  common.pitch_deg = 0.25f * static_cast<float>(n % 40);
  common.rate_radps[2] = 0.01f * static_cast<float>(n % 100);
  common.latitude_deg = 30.6 + 1e-6 * n;
  common.longitude_deg = -96.3 - 1e-6 * n;
  common.altitude_m = 91.5;
  common.velocity_mps[0] = 1.5f;
  common.status = 0x0306;
  return CommonMessage(common);
}

// $ and * and the checksum around a body.
inline std::string Line(const std::string& body) {
  uint32_t sum = 0;
  for (const char character : body) sum ^= static_cast<uint8_t>(character);
  char end[8];
  std::snprintf(end, sizeof(end), "*%02X\r\n", sum);
  return "$" + body + end;
}

inline std::vector<uint8_t> Bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

// Every field as bits: equal texts are equal samples.
inline std::string Bits(const InsSample& s) {
  std::string text;
  const auto add = [&text](uint64_t value) { text += std::to_string(value) + " "; };
  const auto number = [&add](float value) { add(std::bit_cast<uint32_t>(value)); };
  const auto vector = [&number](const auto& v) {
    const auto& [x, y, z] = v;
    number(x), number(y), number(z);
  };
  add(s.has_timestamp), add(s.timestamp_ns), add(s.has_gps_time), add(s.gps_time_ns);
  add(s.has_attitude), number(s.roll_rad), number(s.pitch_rad), number(s.yaw_rad);
  add(s.has_angular_rate), vector(s.angular_rate);
  add(s.has_acceleration), vector(s.acceleration);
  add(s.has_position), add(static_cast<uint64_t>(s.latitude_ndeg));
  add(static_cast<uint64_t>(s.longitude_ndeg)), number(s.altitude_m);
  add(s.has_velocity), vector(s.velocity_ned);
  add(s.has_status), add(static_cast<uint64_t>(s.status.mode)), add(s.status.word);
  add(s.status.gnss_fix), add(s.status.time_error), add(s.status.imu_error);
  add(s.status.magnetometer_or_pressure_error), add(s.status.gnss_error);
  add(s.status.gnss_heading), add(s.status.gnss_compass);
  add(s.has_attitude_uncertainty), number(s.attitude_uncertainty_rad);
  add(s.has_position_uncertainty), number(s.position_uncertainty_m);
  add(s.has_velocity_uncertainty), number(s.velocity_uncertainty_mps);
  return text;
}

// Gives the parser one datagram and appends what it tells.
inline void Give(StreamParser& parser, std::span<const uint8_t> datagram,
                 std::vector<InsSample>& samples) {
  InsSample sample;
  while (!datagram.empty()) {
    datagram = datagram.subspan(parser.Feed(datagram));
    while (IsUsable(parser.Next(sample))) samples.push_back(sample);
  }
}

inline std::string BitsOfAll(const std::vector<InsSample>& samples) {
  std::string text;
  for (const InsSample& sample : samples) text += Bits(sample) + "\n";
  return text;
}

inline std::string Text(const StreamCounters& c) {
  std::string text;
  for (const uint64_t count :
       {c.bytes, c.skipped_bytes, c.binary_messages, c.ascii_messages, c.samples, c.unused,
        c.not_finite, c.out_of_range, c.bad_checksum, c.unsupported}) {
    text += std::to_string(count) + " ";
  }
  return text;
}

}  // namespace hardpack::vectornav::test
