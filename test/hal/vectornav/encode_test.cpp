// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/encode.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "core/base/math.h"
#include "hal/vectornav/vectornav.h"
#include "test/hal/vectornav/vectornav_messages.h"

namespace hardpack::vectornav {
namespace {

using test::Bits;

std::vector<uint8_t> Binary(const InsSample& sample) {
  std::array<uint8_t, kMaxBinaryBytes> bytes;
  size_t size = 0;
  EXPECT_EQ(EncodeBinary(sample, bytes, size), Status::kOk);
  return {bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size)};
}

std::string Ascii(const InsSample& sample) {
  std::array<uint8_t, kMaxAsciiBytes> bytes;
  size_t size = 0;
  EXPECT_EQ(EncodeAscii(sample, bytes, size), Status::kOk);
  return {bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size)};
}

// What FA 01 EB 10 carries.
InsSample RandomSample(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  std::uniform_int_distribution<int64_t> angle(-90'000'000'000, 90'000'000'000);
  InsSample sample;
  sample.has_timestamp = sample.has_gps_time = sample.has_attitude = true;
  sample.has_angular_rate = sample.has_position = sample.has_velocity = sample.has_status = true;
  sample.timestamp_ns = uint64_t{random()} << 20;
  sample.gps_time_ns = 1'400'000'000'000'000'000 + uint64_t{random()} * 1000;
  sample.roll_rad = kPi * unit(random);
  sample.pitch_rad = kHalfPi * unit(random);
  sample.yaw_rad = kPi * unit(random);
  sample.angular_rate = {unit(random), unit(random), unit(random)};
  sample.latitude_ndeg = angle(random);
  sample.longitude_ndeg = 2 * angle(random);
  sample.altitude_m = 4000.0f * unit(random);
  sample.velocity_ned = {9.0f * unit(random), 9.0f * unit(random), unit(random)};
  sample.status.word = static_cast<uint16_t>(random());
  sample.status.mode = static_cast<InsMode>(sample.status.word & 3);
  sample.status.gnss_fix = (sample.status.word & 4) != 0;
  sample.status.time_error = (sample.status.word & 8) != 0;
  sample.status.imu_error = (sample.status.word & 16) != 0;
  sample.status.magnetometer_or_pressure_error = (sample.status.word & 32) != 0;
  sample.status.gnss_error = (sample.status.word & 64) != 0;
  sample.status.gnss_heading = (sample.status.word & 256) != 0;
  sample.status.gnss_compass = (sample.status.word & 512) != 0;
  return sample;
}

// Angles pass through degrees: everything else comes back bit by bit.
void ExpectSame(InsSample sent, const InsSample& received) {
  constexpr float kAngleTolerance_rad = 1.0e-6f;
  EXPECT_LT(Abs(WrapAngle(sent.yaw_rad - received.yaw_rad)), kAngleTolerance_rad);
  EXPECT_NEAR(sent.pitch_rad, received.pitch_rad, kAngleTolerance_rad);
  EXPECT_LT(Abs(WrapAngle(sent.roll_rad - received.roll_rad)), kAngleTolerance_rad);
  sent.yaw_rad = received.yaw_rad;
  sent.pitch_rad = received.pitch_rad;
  sent.roll_rad = received.roll_rad;
  EXPECT_EQ(Bits(sent), Bits(received));
}

TEST(VectorNavEncode, BinaryComesBack) {
  constexpr uint32_t kSeed = 11;
  std::mt19937 random(kSeed);
  for (int i = 0; i < 2000; ++i) {
    InsSample sample = RandomSample(random);
    const std::vector<uint8_t> message = Binary(sample);
    ASSERT_EQ(message.size(), 84u);
    EXPECT_EQ(message[2] | message[3] << 8, 0x10eb);
    InsSample back;
    ASSERT_EQ(DecodeBinary(message, back), Status::kOk);
    ExpectSame(sample, back);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed << ", sample " << i;
  }
}

TEST(VectorNavEncode, AnglesAtTheirEndsComeBack) {
  for (const float yaw_rad : {kPi, -kPi, 0.0f}) {
    for (const float pitch_rad : {kHalfPi, -kHalfPi}) {
      InsSample sample;
      sample.has_attitude = true;
      sample.yaw_rad = sample.roll_rad = yaw_rad;
      sample.pitch_rad = pitch_rad;
      InsSample back;
      ASSERT_EQ(DecodeBinary(Binary(sample), back), Status::kOk);
      ExpectSame(sample, back);
    }
  }
}

TEST(VectorNavEncode, BinaryHasTheFieldsOfTheSample) {
  InsSample sample;
  std::array<uint8_t, kMaxBinaryBytes> bytes;
  size_t size = 7;
  EXPECT_EQ(EncodeBinary(sample, bytes, size), Status::kInvalidArgument);
  sample.has_acceleration = true;
  sample.acceleration = {0.5f, -0.25f, -9.75f};
  EXPECT_EQ(EncodeBinary(sample, std::span(bytes).first(17), size), Status::kCapacityExceeded);
  EXPECT_EQ(size, 7u);
  const std::vector<uint8_t> message = Binary(sample);
  EXPECT_EQ(message.size(), 18u);
  EXPECT_EQ(message[2] | message[3] << 8, 0x0100);
  InsSample back;
  ASSERT_EQ(DecodeBinary(message, back), Status::kOk);
  EXPECT_EQ(Bits(back), Bits(sample));
}

// The host's printf as the reference for the text.
TEST(VectorNavEncode, AsciiIsWhatPrintfWrites) {
  constexpr uint32_t kSeed = 12;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> thousandths(-89'999, 89'999);
  for (int i = 0; i < 2000; ++i) {
    InsSample sample = RandomSample(random);
    // Values that have three decimals, so that no rounding is in doubt.
    const int yaw = 2 * thousandths(random);
    const int altitude = thousandths(random);
    const int64_t latitude = sample.latitude_ndeg / 10;
    const int64_t longitude = sample.longitude_ndeg / 10;
    sample.latitude_ndeg = 10 * latitude + (latitude < 0 ? -4 : 4);
    sample.longitude_ndeg = 10 * longitude + (longitude < 0 ? 5 : -5);
    sample.yaw_rad = static_cast<float>(yaw) * 1e-3f * kRadPerDeg;
    sample.pitch_rad = sample.roll_rad = 0.0f;
    sample.altitude_m = static_cast<float>(altitude) * 1e-3f;
    sample.velocity_ned = {1.5f, -22.25f, 0.0f};
    sample.attitude_uncertainty_rad = 3.9f * kRadPerDeg;
    sample.position_uncertainty_m = 1.2f;
    sample.velocity_uncertainty_mps = 0.1f;
    const uint64_t us = sample.gps_time_ns / 1000;
    const auto sign = [](int64_t value) { return value < 0 ? '-' : '+'; };
    const int64_t lat = std::abs(latitude);
    const int64_t lon = std::abs(longitude);
    char body[200];
    std::snprintf(body, sizeof(body),
                  "VNINS,%06llu.%06llu,%04llu,%04X,%c%03d.%03d,+000.000,+000.000,"
                  "%c%02lld.%08lld,%c%03lld.%08lld,%c%05d.%03d,+001.500,-022.250,+000.000,"
                  "03.9,01.2,0.10",
                  us / 1'000'000ull % 604'800, us % 1'000'000ull, us / 604'800'000'000ull,
                  sample.status.word, sign(yaw), std::abs(yaw) / 1000, std::abs(yaw) % 1000,
                  sign(latitude), lat / 100'000'000ll, lat % 100'000'000ll, sign(longitude),
                  lon / 100'000'000ll, lon % 100'000'000ll, sign(altitude),
                  std::abs(altitude) / 1000, std::abs(altitude) % 1000);
    ASSERT_EQ(Ascii(sample), test::Line(body)) << "seed " << kSeed << ", sample " << i;
  }
}

TEST(VectorNavEncode, AsciiComesBack) {
  std::mt19937 random(13);
  for (int i = 0; i < 500; ++i) {
    const InsSample sample = RandomSample(random);
    const std::string line = Ascii(sample);
    InsSample back;
    ASSERT_EQ(DecodeAscii(test::Bytes(line), back), Status::kOk) << line;
    EXPECT_EQ(back.gps_time_ns, sample.gps_time_ns);
    EXPECT_EQ(back.status.word, sample.status.word);
    EXPECT_NEAR(back.pitch_rad, sample.pitch_rad, 1e-5f);
    EXPECT_NEAR(back.altitude_m, sample.altitude_m, 1e-3f);
    EXPECT_LE(std::abs(back.latitude_ndeg - sample.latitude_ndeg), 5);
    EXPECT_LE(std::abs(back.longitude_ndeg - sample.longitude_ndeg), 5);
    EXPECT_EQ(Ascii(back), line);
  }
}

TEST(VectorNavEncode, WithoutGpsTimeTheSecondsSinceTheStartStandThere) {
  InsSample sample;
  sample.has_timestamp = true;
  sample.timestamp_ns = 241'350'006'000;
  const std::string line = Ascii(sample);
  EXPECT_EQ(line.substr(0, 26), "$VNINS,000241.350006,0000,");
  InsSample back;
  ASSERT_EQ(DecodeAscii(test::Bytes(line), back), Status::kOk);
  EXPECT_FALSE(back.has_gps_time);
}

TEST(VectorNavEncode, WhatDoesNotFitIsRefused) {
  std::array<uint8_t, kMaxAsciiBytes> bytes;
  size_t size = 7;
  InsSample sample;
  for (size_t room = 0; room < Ascii(sample).size(); ++room) {
    ASSERT_EQ(EncodeAscii(sample, std::span(bytes).first(room), size), Status::kCapacityExceeded);
  }
  sample.altitude_m = 100'000.0f;  // one digit more than the line has
  EXPECT_EQ(EncodeAscii(sample, bytes, size), Status::kInvalidArgument);
  sample.altitude_m = 0.0f;
  sample.has_timestamp = true;
  sample.timestamp_ns = uint64_t{1} << 63;
  EXPECT_EQ(EncodeAscii(sample, bytes, size), Status::kInvalidArgument);
  EXPECT_EQ(size, 7u);
}

}  // namespace
}  // namespace hardpack::vectornav
