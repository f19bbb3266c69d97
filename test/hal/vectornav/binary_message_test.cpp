// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "hal/vectornav/vectornav.h"
#include "test/hal/vectornav/vectornav_messages.h"
#include "test/not_finite.h"

namespace hardpack::vectornav {
namespace {

using test::Bits;
using test::Common;
using test::CommonMessage;
using test::MessageBuilder;

using testing::kInfinity;
using testing::kNaN;

// FA 01 EB 10: the message that a VN-300 is configured to send. Written byte by byte from the
// documented layout; the CRC is that of a program of its own.
// clang-format off
const std::vector<uint8_t> kGolden = {
    0xfa, 0x01, 0xeb, 0x10,
    0x15, 0xcd, 0x5b, 0x07, 0x00, 0x00, 0x00, 0x00,  // 123,456,789 ns since start
    0x00, 0x00, 0x64, 0xa7, 0xb3, 0xb6, 0xe0, 0x0d,  // 1,000,000,000,000,000,000 ns of GPS
    0x00, 0x00, 0xb4, 0xc2,                          // yaw -90 deg
    0x00, 0x00, 0xa0, 0x40,                          // pitch 5 deg
    0x00, 0x00, 0x20, 0xc1,                          // roll -10 deg
    0x00, 0x00, 0x80, 0x3e,                          // rate 0.25, -0.5, 1 rad/s
    0x00, 0x00, 0x00, 0xbf,
    0x00, 0x00, 0x80, 0x3f,
    0x00, 0x00, 0x00, 0x00, 0x00, 0xa0, 0x3e, 0x40,  // latitude 30.625
    0x00, 0x00, 0x00, 0x00, 0x00, 0x18, 0x58, 0xc0,  // longitude -96.375
    0x00, 0x00, 0x00, 0x00, 0x00, 0x40, 0x56, 0x40,  // altitude 89
    0x00, 0x00, 0xc0, 0x3f,                          // velocity 1.5, -2, 0.125 m/s
    0x00, 0x00, 0x00, 0xc0,
    0x00, 0x00, 0x00, 0x3e,
    0x06, 0x03,                                      // tracking, fix, both compass bits
    0xfd, 0x20};                                     // CRC, high byte first
// clang-format on

TEST(VectorNavBinary, GoldenMessageFieldByField) {
  ASSERT_EQ(kGolden.size(), 84u);
  InsSample sample;
  ASSERT_EQ(DecodeBinary(kGolden, sample), Status::kOk);
  EXPECT_TRUE(sample.has_timestamp);
  EXPECT_EQ(sample.timestamp_ns, 123'456'789u);
  EXPECT_TRUE(sample.has_gps_time);
  EXPECT_EQ(sample.gps_time_ns, 1'000'000'000'000'000'000u);
  EXPECT_TRUE(sample.has_attitude);
  EXPECT_FLOAT_EQ(sample.yaw_rad, -1.57079633f);
  EXPECT_FLOAT_EQ(sample.pitch_rad, 0.0872664626f);
  EXPECT_FLOAT_EQ(sample.roll_rad, -0.174532925f);
  EXPECT_TRUE(sample.has_angular_rate);
  EXPECT_EQ(sample.angular_rate.x_radps, 0.25f);
  EXPECT_EQ(sample.angular_rate.y_radps, -0.5f);
  EXPECT_EQ(sample.angular_rate.z_radps, 1.0f);
  EXPECT_TRUE(sample.has_position);
  EXPECT_EQ(sample.latitude_ndeg, 30'625'000'000);
  EXPECT_EQ(sample.longitude_ndeg, -96'375'000'000);
  EXPECT_EQ(sample.altitude_m, 89.0f);
  EXPECT_TRUE(sample.has_velocity);
  EXPECT_EQ(sample.velocity_ned.north_mps, 1.5f);
  EXPECT_EQ(sample.velocity_ned.east_mps, -2.0f);
  EXPECT_EQ(sample.velocity_ned.down_mps, 0.125f);
  EXPECT_TRUE(sample.has_status);
  EXPECT_EQ(sample.status.mode, InsMode::kTracking);
  EXPECT_TRUE(sample.status.gnss_fix);
  EXPECT_TRUE(sample.status.gnss_heading);
  EXPECT_TRUE(sample.status.gnss_compass);
  EXPECT_FALSE(sample.status.time_error || sample.status.imu_error || sample.status.gnss_error ||
               sample.status.magnetometer_or_pressure_error);
  EXPECT_EQ(sample.status.word, 0x0306);
  EXPECT_FALSE(sample.has_acceleration || sample.has_attitude_uncertainty ||
               sample.has_position_uncertainty || sample.has_velocity_uncertainty);
}

TEST(VectorNavBinary, EachStatusBitIsNamed) {
  const auto status_of = [](uint16_t word) {
    InsSample sample;
    EXPECT_EQ(DecodeBinary(MessageBuilder(0x20, {0x0001}).Add(word).Build(), sample), Status::kOk);
    return sample.status;
  };
  EXPECT_EQ(status_of(0).mode, InsMode::kNotTracking);
  EXPECT_EQ(status_of(1).mode, InsMode::kAligning);
  EXPECT_EQ(status_of(2).mode, InsMode::kTracking);
  EXPECT_EQ(status_of(3).mode, InsMode::kGnssLost);
  EXPECT_TRUE(status_of(1u << 2).gnss_fix);
  EXPECT_TRUE(status_of(1u << 3).time_error);
  EXPECT_TRUE(status_of(1u << 4).imu_error);
  EXPECT_TRUE(status_of(1u << 5).magnetometer_or_pressure_error);
  EXPECT_TRUE(status_of(1u << 6).gnss_error);
  EXPECT_TRUE(status_of(1u << 8).gnss_heading);
  EXPECT_TRUE(status_of(1u << 9).gnss_compass);
  EXPECT_EQ(status_of(0xfc80).word, 0xfc80);
}

// The same quantities from the other groups, between fields that are stepped over.
TEST(VectorNavBinary, ReadsTheOtherGroupsToo) {
  const std::vector<uint8_t> message =
      MessageBuilder(0x76, {0x0005, 0x0e01, 0x0006, 0x0613, 0x0008})
          .Add(uint64_t{42})             // Time: TimeStartup
          .Filler(8)                     //   GpsTow
          .Filler(2)                     // IMU: ImuStatus
          .Vector(1.0f, 2.0f, -9.75f)    //   Accel
          .Vector(0.5f, 0.25f, 0.125f)   //   AngularRate
          .Filler(2)                     //   SensSat
          .Vector(180.0f, -90.0f, 0.0f)  // Attitude: YawPitchRoll
          .Filler(16)                    //   Quaternion
          .Add(uint16_t{0x0005})         // INS: InsStatus
          .Add(-33.5)
          .Add(151.25)
          .Add(-12.0)                  //   PosLla
          .Vector(-1.0f, 2.0f, -3.0f)  //   VelNed
          .Add(1.5f)                   //   PosU
          .Add(0.75f)                  //   VelU
          .Filler(1)                   // GPS2: NumSats
          .Build();
  InsSample sample;
  ASSERT_EQ(DecodeBinary(message, sample), Status::kOk);
  EXPECT_EQ(sample.timestamp_ns, 42u);
  EXPECT_FALSE(sample.has_gps_time);
  EXPECT_EQ(sample.acceleration.z_mps2, -9.75f);
  EXPECT_EQ(sample.angular_rate.y_radps, 0.25f);
  EXPECT_FLOAT_EQ(sample.yaw_rad, 3.14159265f);
  EXPECT_FLOAT_EQ(sample.pitch_rad, -1.57079633f);
  EXPECT_EQ(sample.status.mode, InsMode::kAligning);
  EXPECT_EQ(sample.latitude_ndeg, -33'500'000'000);
  EXPECT_EQ(sample.longitude_ndeg, 151'250'000'000);
  EXPECT_EQ(sample.altitude_m, -12.0f);
  EXPECT_EQ(sample.velocity_ned.down_mps, -3.0f);
  EXPECT_TRUE(sample.has_position_uncertainty && sample.has_velocity_uncertainty);
  EXPECT_EQ(sample.position_uncertainty_m, 1.5f);
  EXPECT_EQ(sample.velocity_uncertainty_mps, 0.75f);
}

TEST(VectorNavBinary, StepsOverEveryFieldOfEveryGroup) {
  // As documented, in their order; all but those of the INS group's status, in front of it.
  const size_t common = 8 + 8 + 8 + 12 + 16 + 12 + 24 + 12 + 12 + 24 + 20 + 28 + 2 + 4 + 8;
  const size_t time = 8 + 8 + 8 + 2 + 8 + 8 + 8 + 4 + 4 + 1;
  const size_t imu = 2 + 12 + 12 + 12 + 4 + 4 + 16 + 12 + 12 + 12 + 12 + 2 + 40;
  const size_t gps = 8 + 8 + 2 + 1 + 1 + 24 + 24 + 12 + 12 + 12 + 4 + 4 + 2 + 28;
  const size_t attitude = 2 + 12 + 16 + 36 + 12 + 12 + 12 + 12 + 12 + 12 + 28 + 24 + 12;
  const size_t ins = 2 + 24 + 24 + 12 + 12 + 12 + 12 + 12 + 12 + 4 + 4 + 68 + 64;
  const std::vector<uint8_t> message =
      MessageBuilder(0x7f, {0x7fff, 0x03ff, 0x1fff, 0x3fff, 0x1fff, 0x1fff, 0x3fff})
          .Filler(common + time + imu + gps + attitude, 0)
          .Add(uint16_t{0x1234})
          .Filler(ins - 2 + gps, 0)
          .Build();
  ASSERT_EQ(message.size(), kMaxBinaryBytes);
  InsSample sample;
  ASSERT_EQ(DecodeBinary(message, sample), Status::kOk);
  EXPECT_EQ(sample.status.word, 0x1234);
}

// The sensor counts from its own start until it knows the week.
TEST(VectorNavBinary, TimeOfLessThanAWeekIsNoGpsTime) {
  InsSample sample;
  Common common;
  common.gps_ns = 604'799'999'999'999;
  ASSERT_EQ(DecodeBinary(CommonMessage(common), sample), Status::kOk);
  EXPECT_FALSE(sample.has_gps_time);
  EXPECT_EQ(sample.gps_time_ns, 0u);
  common.gps_ns = 604'800'000'000'000;
  ASSERT_EQ(DecodeBinary(CommonMessage(common), sample), Status::kOk);
  EXPECT_TRUE(sample.has_gps_time);
}

// SR-INP02
TEST(VectorNavBinary, RefusesNumbersThatAreNotFinite) {
  const Common good;
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int which = 0; which < 9; ++which) {
      Common common = good;
      if (which == 0) common.yaw_deg = bad;
      if (which == 1) common.pitch_deg = bad;
      if (which == 2) common.roll_deg = bad;
      if (which == 3) common.rate_radps[1] = bad;
      if (which == 4) common.latitude_deg = static_cast<double>(bad);
      if (which == 5) common.longitude_deg = static_cast<double>(bad);
      if (which == 6) common.altitude_m = static_cast<double>(bad);
      if (which == 7) common.velocity_mps[2] = bad;
      if (which == 8) common.altitude_m = 1e39;  // finite, but no float
      InsSample sample;
      EXPECT_EQ(DecodeBinary(CommonMessage(common), sample), Status::kNotFinite) << which;
      EXPECT_EQ(Bits(sample), Bits(InsSample{}));
    }
  }
}

TEST(VectorNavBinary, DoesNotMindWhatItDoesNotUse) {
  InsSample sample;
  const std::vector<uint8_t> message = MessageBuilder(0x01, {0x1010})
                                           .Vector(kNaN, kInfinity, kNaN)
                                           .Add(kNaN)
                                           .Add(uint16_t{2})
                                           .Build();
  EXPECT_EQ(DecodeBinary(message, sample), Status::kOk);
}

TEST(VectorNavBinary, RefusesWhatCannotBe) {
  const auto status_of = [](const Common& common) {
    InsSample sample;
    const Status status = DecodeBinary(CommonMessage(common), sample);
    EXPECT_EQ(sample.has_status, status == Status::kOk);
    return status;
  };
  Common common;
  common.latitude_deg = 90.0;
  common.longitude_deg = -180.0;
  common.yaw_deg = 360.0f;
  common.pitch_deg = 90.0f;
  common.roll_deg = -180.0f;
  EXPECT_EQ(status_of(common), Status::kOk);
  Common bad = common;
  bad.latitude_deg = 90.000000001;
  EXPECT_EQ(status_of(bad), Status::kInvalidArgument);
  bad = common;
  bad.longitude_deg = -180.000000001;
  EXPECT_EQ(status_of(bad), Status::kInvalidArgument);
  bad.longitude_deg = 1e300;
  EXPECT_EQ(status_of(bad), Status::kInvalidArgument);
  bad = common;
  bad.yaw_deg = -361.0f;
  EXPECT_EQ(status_of(bad), Status::kInvalidArgument);
  bad = common;
  bad.pitch_deg = 90.1f;
  EXPECT_EQ(status_of(bad), Status::kInvalidArgument);
}

TEST(VectorNavBinary, RefusesNegativeUncertainties) {
  InsSample sample;
  EXPECT_EQ(DecodeBinary(MessageBuilder(0x20, {0x0200}).Add(-0.5f).Build(), sample),
            Status::kInvalidArgument);
  EXPECT_EQ(DecodeBinary(MessageBuilder(0x20, {0x0400}).Add(kNaN).Build(), sample),
            Status::kNotFinite);
}

TEST(VectorNavBinary, WrapsYawAndRoll) {
  Common common;
  common.yaw_deg = 270.0f;
  common.roll_deg = -180.0f;
  InsSample sample;
  ASSERT_EQ(DecodeBinary(CommonMessage(common), sample), Status::kOk);
  EXPECT_NEAR(sample.yaw_rad, -1.57079633f, 1e-6f);
  EXPECT_NEAR(std::abs(sample.roll_rad), 3.14159265f, 1e-6f);
}

TEST(VectorNavBinary, SizesAreExact) {
  const std::vector<uint8_t> message = test::NumberedMessage(1);
  InsSample sample;
  for (size_t size = 0; size < message.size(); ++size) {
    EXPECT_EQ(DecodeBinary(std::span(message).first(size), sample), Status::kTruncated) << size;
  }
  std::vector<uint8_t> longer = message;
  longer.push_back(0);
  EXPECT_EQ(DecodeBinary(longer, sample), Status::kOversized);
  EXPECT_EQ(Bits(sample), Bits(InsSample{}));
}

TEST(VectorNavBinary, EveryFlippedBitIsSeen) {
  const std::vector<uint8_t> message = test::NumberedMessage(7);
  InsSample sample;
  for (size_t bit = 0; bit < 8 * message.size(); ++bit) {
    std::vector<uint8_t> flipped = message;
    flipped[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    EXPECT_FALSE(IsUsable(DecodeBinary(flipped, sample))) << bit;
  }
  EXPECT_EQ(Bits(sample), Bits(InsSample{}));
}

TEST(VectorNavBinary, SaysWhatIsNotSupported) {
  size_t size = 0;
  const auto sized = [&size](const std::vector<uint8_t>& header) {
    return BinaryMessageSize(header, size);
  };
  EXPECT_EQ(sized({0x24, 0x01, 0x08, 0x00}), Status::kUnsupported);              // no sync byte
  EXPECT_EQ(sized({0xfa, 0x00, 0x08, 0x00}), Status::kUnsupported);              // no group
  EXPECT_EQ(sized({0xfa, 0x81, 0x01, 0x08, 0x00}), Status::kUnsupported);        // more groups
  EXPECT_EQ(sized({0xfa, 0x01, 0x08, 0x80, 0x00, 0x00}), Status::kUnsupported);  // more fields
  EXPECT_EQ(sized({0xfa, 0x01, 0x00, 0x00}), Status::kUnsupported);              // no field
  EXPECT_EQ(sized({0xfa, 0x08, 0x00, 0x40}), Status::kUnsupported);              // SatInfo varies
  EXPECT_EQ(sized({0xfa, 0x02, 0x00, 0x04}), Status::kUnsupported);              // no such field
  EXPECT_EQ(sized({0xfa, 0x05, 0x08, 0x00, 0x00, 0x20}), Status::kUnsupported);  // in group two
  EXPECT_EQ(sized({}), Status::kTruncated);
  EXPECT_EQ(sized({0xfa}), Status::kTruncated);
  EXPECT_EQ(sized({0xfa, 0x05, 0x08, 0x00, 0x00}), Status::kTruncated);
  EXPECT_EQ(size, 0u);
  EXPECT_EQ(sized({0xfa, 0x05, 0x08, 0x00, 0x01, 0x00}), Status::kOk);
  EXPECT_EQ(size, 2u + 4u + 12u + 2u + 2u);
}

TEST(VectorNavBinary, SaysThatNothingIsUsed) {
  InsSample sample;
  EXPECT_EQ(DecodeBinary(MessageBuilder(0x01, {0x0010}).Filler(16).Build(), sample),
            Status::kWrongPacketType);
}

}  // namespace
}  // namespace hardpack::vectornav
