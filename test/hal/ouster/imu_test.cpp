// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "hal/ouster/ouster.h"
#include "test/hal/ouster/ouster_packets.h"

namespace hardpack::ouster {
namespace {

std::vector<uint8_t> EncodeImu(const float (&readings)[6], uint64_t packet_time_ns = 1,
                               uint64_t acceleration_time_ns = 2,
                               uint64_t angular_rate_time_ns = 3) {
  test::ByteWriter out;
  out.Put(packet_time_ns, 8);
  out.Put(acceleration_time_ns, 8);
  out.Put(angular_rate_time_ns, 8);
  for (const float reading : readings) out.PutFloat(reading);
  return out.bytes();
}

// Byte by byte from the documented layout.
TEST(OusterImu, DecodesGoldenBytesToSiUnits) {
  const std::vector<uint8_t> packet = {
      0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  // put together at 1 ns
      0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,  // acceleration read at
      0x18, 0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11,  // angular rate read at
      0x00, 0x00, 0x00, 0x3f,                          // 0.5 g
      0x00, 0x00, 0x80, 0xbf,                          // -1 g
      0x00, 0x00, 0x00, 0x40,                          // 2 g
      0x00, 0x00, 0x34, 0x43,                          // 180 deg/s
      0x00, 0x00, 0xb4, 0xc2,                          // -90 deg/s
      0x00, 0x00, 0x00, 0x00,                          // 0 deg/s
  };
  ImuSample sample;
  ASSERT_EQ(DecodeImu(packet, sample), Status::kOk);
  EXPECT_EQ(sample.acceleration_time_ns, 0x0102030405060708u);
  EXPECT_EQ(sample.angular_rate_time_ns, 0x1112131415161718u);
  EXPECT_FLOAT_EQ(sample.acceleration.x_mps2, 4.903325f);
  EXPECT_FLOAT_EQ(sample.acceleration.y_mps2, -9.80665f);
  EXPECT_FLOAT_EQ(sample.acceleration.z_mps2, 19.6133f);
  EXPECT_FLOAT_EQ(sample.angular_rate.x_radps, 3.14159265f);
  EXPECT_FLOAT_EQ(sample.angular_rate.y_radps, -1.57079633f);
  EXPECT_EQ(sample.angular_rate.z_radps, 0.0f);
}

TEST(OusterImu, RefusesEveryOtherSize) {
  const std::vector<uint8_t> packet = EncodeImu({0, 0, 1, 0, 0, 0});
  ImuSample sample;
  sample.acceleration_time_ns = 77;
  for (size_t size = 0; size < packet.size(); ++size) {
    const std::vector<uint8_t> cut(packet.begin(),
                                   packet.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(DecodeImu(cut, sample), Status::kTruncated) << size;
  }
  std::vector<uint8_t> longer = packet;
  longer.push_back(0);
  EXPECT_EQ(DecodeImu(longer, sample), Status::kOversized);
  EXPECT_EQ(sample.acceleration_time_ns, 77u) << "a refused packet left something";
}

TEST(OusterImu, RefusesReadingsThatAreNotFinite) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ImuSample sample;
  sample.acceleration_time_ns = 77;
  for (size_t i = 0; i < 6; ++i) {
    for (const float bad : {infinity, -infinity, nan, -nan}) {
      float readings[6] = {0, 0, 1, 0, 0, 0};
      readings[i] = bad;
      EXPECT_EQ(DecodeImu(EncodeImu(readings), sample), Status::kNotFinite) << i;
    }
  }
  // Finite in g, but not in m/s^2.
  EXPECT_EQ(DecodeImu(EncodeImu({3e38f, 0, 0, 0, 0, 0}), sample), Status::kNotFinite);
  EXPECT_EQ(sample.acceleration_time_ns, 77u) << "a refused packet left something";
}

TEST(OusterImu, GivesFiniteReadingsOrNoneOnRandomBytes) {
  const unsigned seed = 7201;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<uint8_t> packet(kImuPacketBytes);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    for (uint8_t& byte : packet) byte = static_cast<uint8_t>(random());
    ImuSample sample;
    const Status status = DecodeImu(packet, sample);
    if (status == Status::kNotFinite) continue;
    ASSERT_EQ(status, Status::kOk);
    ++accepted;
    ASSERT_TRUE(IsFinite(sample.acceleration) && IsFinite(sample.angular_rate));
  }
  EXPECT_GT(accepted, 10000);
}

}  // namespace
}  // namespace hardpack::ouster
