// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "hal/vectornav/encode.h"
#include "hal/vectornav/stream_parser.h"
#include "test/hal/vectornav/vectornav_messages.h"

// Real sensors' bytes; they are not part of the project.

namespace hardpack::vectornav {
namespace {

constexpr double kPiOfHost = 3.14159265358979323846;

std::string ReadRecording(const std::string& name) {
  const char* folder = std::getenv("HARDPACK_DATA");
  if (folder == nullptr) return {};
  std::ifstream file(std::string(folder) + "/vectornav/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

double Radians(double degrees) {
  const double wrapped = std::remainder(degrees, 360.0);
  return wrapped * kPiOfHost / 180.0;
}

void ExpectAttitude(const InsSample& sample, double yaw_deg, double pitch_deg, double roll_deg) {
  EXPECT_TRUE(sample.has_attitude);
  EXPECT_NEAR(static_cast<double>(sample.yaw_rad), Radians(yaw_deg), 5e-7);
  EXPECT_NEAR(static_cast<double>(sample.pitch_rad), Radians(pitch_deg), 5e-7);
  EXPECT_NEAR(static_cast<double>(sample.roll_rad), Radians(roll_deg), 5e-7);
}

float FloatAt(const std::vector<uint8_t>& bytes, size_t offset) {
  float value = 0;
  std::memcpy(&value, &bytes[offset], sizeof(value));
  return value;
}

// A VN-100's log: binary messages of IMU and attitude with lines of text between them.
class VectorNavLog : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string text = ReadRecording("vn100_F00294.bin");
    if (text.empty()) GTEST_SKIP() << "no recordings: HARDPACK_DATA is not set or has none";
    log_ = test::Bytes(text);
    whole_ = std::make_unique<StreamParser>();
    test::Give(*whole_, log_, samples_);
  }
  std::vector<uint8_t> log_;
  std::unique_ptr<StreamParser> whole_;
  std::vector<InsSample> samples_;
};

TEST_F(VectorNavLog, All99MessagesAreFoundAndRead) {
  ASSERT_EQ(samples_.size(), 99u);
  EXPECT_EQ(whole_->counters().binary_messages, 99u);
  // FA 14 3E00 3A00: 44 bytes of IMU, then yaw, pitch and roll; 124 bytes in all.
  const std::vector<uint8_t> header = {0xfa, 0x14, 0x3e, 0x00, 0x3a, 0x00};
  size_t at = 0;
  for (const InsSample& sample : samples_) {
    const auto found = std::search(log_.begin() + static_cast<ptrdiff_t>(at), log_.end(),
                                   header.begin(), header.end());
    ASSERT_NE(found, log_.end());
    at = static_cast<size_t>(found - log_.begin());
    const size_t payload = at + header.size();
    ASSERT_EQ(test::SlowCrc16(std::span(log_).subspan(at + 1, 123)), 0);
    ExpectAttitude(sample, static_cast<double>(FloatAt(log_, payload + 44)),
                   static_cast<double>(FloatAt(log_, payload + 48)),
                   static_cast<double>(FloatAt(log_, payload + 52)));
    EXPECT_FALSE(sample.has_timestamp || sample.has_gps_time || sample.has_angular_rate ||
                 sample.has_acceleration || sample.has_position || sample.has_velocity ||
                 sample.has_status);
    at += 124;
  }
}

TEST_F(VectorNavLog, HoweverTheyAreCut) {
  for (uint32_t seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    // 1 byte each; then up to so many.
    const size_t largest = seed == 0 ? 1 : 1 + random() % 2000;
    const auto parser = std::make_unique<StreamParser>();
    std::vector<InsSample> samples;
    std::span<const uint8_t> rest(log_);
    while (!rest.empty()) {
      const size_t size = std::min<size_t>(rest.size(), 1 + random() % largest);
      test::Give(*parser, rest.first(size), samples);
      rest = rest.subspan(size);
    }
    ASSERT_EQ(test::BitsOfAll(samples), test::BitsOfAll(samples_)) << "seed " << seed;
    ASSERT_EQ(test::Text(parser->counters()), test::Text(whole_->counters())) << "seed " << seed;
  }
}

TEST(VectorNavRecording, YawPitchRollMessages) {
  const std::vector<std::string> lines = Lines(ReadRecording("vn_ypr_binary_hex.txt"));
  if (lines.empty()) GTEST_SKIP() << "no recordings: HARDPACK_DATA is not set or has none";
  for (const std::string& line : lines) {
    std::vector<uint8_t> message;
    for (size_t i = 0; i + 1 < line.size(); i += 2) {
      message.push_back(static_cast<uint8_t>(std::stoul(line.substr(i, 2), nullptr, 16)));
    }
    ASSERT_EQ(message.size(), 18u);
    InsSample sample;
    ASSERT_EQ(DecodeBinary(message, sample), Status::kOk) << line;
    ExpectAttitude(sample, static_cast<double>(FloatAt(message, 4)),
                   static_cast<double>(FloatAt(message, 8)),
                   static_cast<double>(FloatAt(message, 12)));
    EXPECT_FALSE(sample.has_timestamp || sample.has_position || sample.has_status);
  }
}

// Read once more with the host's own numbers, field by field.
TEST(VectorNavRecording, InsLines) {
  const std::vector<std::string> lines = Lines(ReadRecording("vnins_samples.txt"));
  if (lines.empty()) GTEST_SKIP() << "no recordings: HARDPACK_DATA is not set or has none";
  for (const std::string& line : lines) {
    SCOPED_TRACE(line);
    double f[15] = {};
    unsigned status = 0;
    ASSERT_EQ(std::sscanf(line.c_str(),
                          "$VNINS,%lf,%lf,%x,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf",
                          &f[0], &f[1], &status, &f[3], &f[4], &f[5], &f[6], &f[7], &f[8], &f[9],
                          &f[10], &f[11], &f[12], &f[13], &f[14]),
              15);
    InsSample sample;
    ASSERT_EQ(DecodeAscii(test::Bytes(line + "\r\n"), sample), Status::kOk);
    EXPECT_EQ(sample.has_gps_time, f[1] > 0);
    if (sample.has_gps_time) {
      const auto tow_us = static_cast<uint64_t>(std::llround(f[0] * 1e6));
      EXPECT_EQ(sample.gps_time_ns,
                static_cast<uint64_t>(f[1]) * 604'800'000'000'000u + tow_us * 1000u);
    }
    EXPECT_EQ(sample.status.word, status);
    EXPECT_EQ(static_cast<unsigned>(sample.status.mode), status & 3u);
    EXPECT_EQ(sample.status.gnss_fix, (status & 4u) != 0);
    ExpectAttitude(sample, f[3], f[4], f[5]);
    EXPECT_EQ(sample.latitude_ndeg, std::llround(f[6] * 1e9));
    EXPECT_EQ(sample.longitude_ndeg, std::llround(f[7] * 1e9));
    EXPECT_FLOAT_EQ(sample.altitude_m, static_cast<float>(f[8]));
    EXPECT_FLOAT_EQ(sample.velocity_ned.north_mps, static_cast<float>(f[9]));
    EXPECT_FLOAT_EQ(sample.velocity_ned.east_mps, static_cast<float>(f[10]));
    EXPECT_FLOAT_EQ(sample.velocity_ned.down_mps, static_cast<float>(f[11]));
    EXPECT_NEAR(static_cast<double>(sample.attitude_uncertainty_rad), f[12] * kPiOfHost / 180,
                1e-6);
    EXPECT_FLOAT_EQ(sample.position_uncertainty_m, static_cast<float>(f[13]));
    EXPECT_FLOAT_EQ(sample.velocity_uncertainty_mps, static_cast<float>(f[14]));
  }
}

// The encoder writes the very line that the sensor sent.
TEST(VectorNavRecording, InsLinesAreWrittenAsTheSensorDoes) {
  const std::vector<std::string> lines = Lines(ReadRecording("vnins_samples.txt"));
  if (lines.empty()) GTEST_SKIP() << "no recordings: HARDPACK_DATA is not set or has none";
  for (const std::string& line : lines) {
    InsSample sample;
    ASSERT_EQ(DecodeAscii(test::Bytes(line + "\r\n"), sample), Status::kOk);
    if (!sample.has_gps_time) continue;  // the time since the start is not kept
    uint8_t written[kMaxAsciiBytes];
    size_t size = 0;
    ASSERT_EQ(EncodeAscii(sample, written, size), Status::kOk);
    EXPECT_EQ(std::string(written, written + size), line + "\r\n");
  }
}

}  // namespace
}  // namespace hardpack::vectornav
