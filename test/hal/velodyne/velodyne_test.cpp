// SPDX-License-Identifier: Apache-2.0
// The codec against bytes that were written by hand from the maker's description.
#include "hal/velodyne/velodyne.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "hal/velodyne/beams.h"
#include "test/hal/velodyne/velodyne_packets.h"

namespace hardpack::velodyne {
namespace {

using test::PacketOf;
using test::PutAzimuth;
using test::PutTime;
using test::Turning;

constexpr Config kVlp16 = {Model::kVlp16, ReturnMode::kStrongest, 600};
constexpr Config kVlp32c = {Model::kVlp32c, ReturnMode::kLast, 600};
constexpr Config kVlp16Dual = {Model::kVlp16, ReturnMode::kDual, 600};
constexpr Config kVlp32cDual = {Model::kVlp32c, ReturnMode::kDual, 600};

// Azimuth 277.42 degrees; laser 0 at 102.308 m with 8, laser 1 nothing, laser 2 at 2 mm with 255;
// the second firing's (or laser 16's) first return 256 units away with 7.
const std::vector<uint8_t> kBlock = {0xff, 0xee, 0x5e, 0x6c, 0xd2, 0xc7, 0x08,
                                     0x00, 0x00, 0x00, 0x01, 0x00, 0xff};
const std::vector<uint8_t> kSecondFiring = {0x00, 0x01, 0x07};

std::vector<uint8_t> Golden(const Config& config) {
  const bool is_dual = config.return_mode == ReturnMode::kDual;
  const int step_cdeg = config.model == Model::kVlp16 ? 40 : 20;
  std::vector<uint8_t> bytes(1206, 0);
  for (size_t block = 0; block < 12; ++block) {
    std::copy(kBlock.begin(), kBlock.end(), bytes.begin() + static_cast<int64_t>(100 * block));
    const size_t group = is_dual ? block / 2 : block;
    PutAzimuth(bytes, block,
               27742u + static_cast<uint32_t>(step_cdeg) * static_cast<uint32_t>(group));
    std::copy(kSecondFiring.begin(), kSecondFiring.end(),
              bytes.begin() + static_cast<int64_t>(100 * block + 4 + 48));
  }
  bytes[1200] = 0x61;  // 0x45b9e761: 1,169,811,297 us
  bytes[1201] = 0xe7;
  bytes[1202] = 0xb9;
  bytes[1203] = 0x45;
  bytes[1204] = static_cast<uint8_t>(config.return_mode);
  bytes[1205] = config.model == Model::kVlp16 ? 0x22 : 0x28;
  return bytes;
}

class Velodyne : public ::testing::Test {
 protected:
  Status Read(const Config& config, const std::vector<uint8_t>& bytes) {
    return ReadHeader(config, bytes, header_);
  }
  const LidarColumn& Decoded(const Config& config, const std::vector<uint8_t>& bytes, int firing) {
    DecodeReturns(FormatOf(config), std::span<const uint8_t, 1206>(bytes), firing, *column_);
    return *column_;
  }

  PacketHeader header_;
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

TEST_F(Velodyne, ReadsAVlp16) {
  const std::vector<uint8_t> bytes = Golden(kVlp16);
  ASSERT_EQ(Read(kVlp16, bytes), Status::kOk);
  EXPECT_EQ(header_.time_us, 1'169'811'297u);
  EXPECT_EQ(header_.azimuth_cdeg[0], 27742);
  EXPECT_EQ(header_.azimuth_cdeg[11], 27742 + 440);
  const LidarColumn& first = Decoded(kVlp16, bytes, 0);
  EXPECT_EQ(first.beams, 16);
  EXPECT_EQ(first.returns, 1);
  EXPECT_EQ(first.range_mm[0], 102'308u);
  EXPECT_EQ(first.reflectivity[0], 8);
  EXPECT_EQ(first.range_mm[1], 0u);
  EXPECT_EQ(first.range_mm[2], 2u);
  EXPECT_EQ(first.reflectivity[2], 255);
  EXPECT_EQ(first.range_mm[15], 0u);
  const LidarColumn& second = Decoded(kVlp16, bytes, 23);
  EXPECT_EQ(second.range_mm[0], 512u);
  EXPECT_EQ(second.reflectivity[0], 7);
  EXPECT_EQ(second.range_mm[2], 0u);
}

TEST_F(Velodyne, ReadsAVlp32c) {
  const std::vector<uint8_t> bytes = Golden(kVlp32c);
  ASSERT_EQ(Read(kVlp32c, bytes), Status::kOk);
  const LidarColumn& column = Decoded(kVlp32c, bytes, 11);
  EXPECT_EQ(column.beams, 32);
  EXPECT_EQ(column.range_mm[0], 204'616u);
  EXPECT_EQ(column.range_mm[2], 4u);
  EXPECT_EQ(column.range_mm[16], 1024u);
  EXPECT_EQ(column.reflectivity[16], 7);
  EXPECT_EQ(column.range_mm[31], 0u);
}

// The last return comes first, the strongest behind it.
TEST_F(Velodyne, ReadsTwoReturns) {
  for (const Config& config : {kVlp16Dual, kVlp32cDual}) {
    std::vector<uint8_t> bytes = Golden(config);
    const uint32_t unit_mm = config.model == Model::kVlp16 ? 2 : 4;
    bytes[1100 + 4] = 0x10;  // the strongest of the last pair's laser 0: nearer
    bytes[1100 + 5] = 0x00;
    ASSERT_EQ(Read(config, bytes), Status::kOk);
    const int last = FormatOf(config).firings - FormatOf(config).firings_per_block;
    const LidarColumn& column = Decoded(config, bytes, last);
    EXPECT_EQ(column.returns, 2);
    EXPECT_EQ(column.range_mm[0], 16u * unit_mm);
    EXPECT_EQ(column.second_range_mm[0], 51'154u * unit_mm);
    EXPECT_EQ(column.second_reflectivity[0], 8);
    // One return only.
    EXPECT_EQ(column.range_mm[2], unit_mm);
    EXPECT_EQ(column.second_range_mm[2], 0u);
    EXPECT_EQ(column.second_reflectivity[2], 0);
    EXPECT_EQ(Decoded(config, bytes, 0).range_mm[0], 51'154u * unit_mm);
  }
  EXPECT_EQ(FormatOf(kVlp16Dual).firings, 12);
  EXPECT_EQ(FormatOf(kVlp32cDual).firings, 6);
}

TEST_F(Velodyne, RefusesEverythingThatIsNoPacketOfIt) {
  const std::vector<uint8_t> good = Golden(kVlp16);
  const auto with = [&](size_t at, uint8_t value) {
    std::vector<uint8_t> bytes = good;
    bytes[at] = value;
    return bytes;
  };
  for (size_t size = 0; size < 1206; ++size) {
    const std::vector<uint8_t> cut(good.begin(), good.begin() + static_cast<int64_t>(size));
    ASSERT_EQ(Read(kVlp16, cut), Status::kTruncated);
  }
  std::vector<uint8_t> longer = good;
  longer.push_back(0);
  EXPECT_EQ(Read(kVlp16, longer), Status::kOversized);
  for (size_t block = 0; block < 12; ++block) {
    EXPECT_EQ(Read(kVlp16, with(100 * block, 0xfe)), Status::kWrongPacketType);
    EXPECT_EQ(Read(kVlp16, with(100 * block + 1, 0xdd)), Status::kWrongPacketType);
  }
  for (const int product : {0x00, 0x21, 0x24, 0x28, 0x31, 0x63}) {
    EXPECT_EQ(Read(kVlp16, with(1205, static_cast<uint8_t>(product))), Status::kWrongSensor);
  }
  for (const int mode : {0x00, 0x38, 0x39, 0x3a}) {
    EXPECT_EQ(Read(kVlp16, with(1204, static_cast<uint8_t>(mode))), Status::kUnsupported);
  }
  EXPECT_EQ(Read(kVlp32c, good), Status::kWrongSensor);
  EXPECT_EQ(Read(kVlp16, good), Status::kOk);
}

TEST_F(Velodyne, RefusesAnglesAndTimesThatCannotBe) {
  std::vector<uint8_t> bytes = Golden(kVlp16);
  for (const uint32_t azimuth_cdeg : {36'000u, 36'001u, 65'535u}) {
    PutAzimuth(bytes, 5, azimuth_cdeg);
    EXPECT_EQ(Read(kVlp16, bytes), Status::kBadColumn) << azimuth_cdeg;
  }
  bytes = Golden(kVlp16);
  PutTime(bytes, 3'599'999'999u);
  EXPECT_EQ(Read(kVlp16, bytes), Status::kOk);
  for (const uint32_t time_us : {3'600'000'000u, 4'294'967'295u}) {
    PutTime(bytes, time_us);
    EXPECT_EQ(Read(kVlp16, bytes), Status::kInvalidArgument) << time_us;
  }
  bytes = Golden(kVlp32cDual);
  PutAzimuth(bytes, 7, 27742u + 3u * 20u + 1u);
  EXPECT_EQ(Read(kVlp32cDual, bytes), Status::kBadColumn) << "a pair of one firing has one azimuth";
}

// The next settings of the sensor, 60 rpm off, are told from the configured one.
TEST_F(Velodyne, RefusesAHeadThatTurnsOtherwise) {
  for (const Config& config : {kVlp16, kVlp32c, kVlp16Dual, kVlp32cDual}) {
    for (const int rpm : {540, 600, 1140, 1200}) {
      Turning sensor{.config = config};
      sensor.config.rpm = rpm;
      for (const double rate : {0.97, 1.0, 1.03}) {
        sensor.rate = rate;
        EXPECT_EQ(Read(sensor.config, PacketOf(sensor, 0)), Status::kOk) << rpm << " " << rate;
      }
      for (const double rate : {-1.0, 0.0, 0.5, 1.0 - 60.0 / rpm, 1.0 + 60.0 / rpm, 2.0}) {
        if (std::abs(rate - 1.0) < 0.09) continue;
        sensor.rate = rate;
        sensor.begin_cdeg = 18'000.0;
        EXPECT_EQ(Read(sensor.config, PacketOf(sensor, 0)), Status::kDeviceFault)
            << rpm << " " << rate;
      }
    }
  }
  std::vector<uint8_t> bytes = Golden(kVlp16);
  PutAzimuth(bytes, 5, 27742u + 5u * 40u + 30u);
  EXPECT_EQ(Read(kVlp16, bytes), Status::kDeviceFault) << "on its way";
}

TEST_F(Velodyne, IsSetUpAsASensorCanBe) {
  EXPECT_EQ(CheckConfig(kVlp16), Status::kOk);
  EXPECT_EQ(CheckConfig(kVlp32cDual), Status::kOk);
  for (const int rpm : {0, -600, 300, 480, 539, 601, 630, 1201, 1260, INT32_MAX, INT32_MIN}) {
    EXPECT_EQ(CheckConfig({Model::kVlp16, ReturnMode::kLast, rpm}), Status::kInvalidArgument)
        << rpm;
  }
  EXPECT_EQ(CheckConfig({static_cast<Model>(2), ReturnMode::kLast, 600}), Status::kUnsupported);
  EXPECT_EQ(CheckConfig({Model::kVlp16, static_cast<ReturnMode>(0x3a), 600}), Status::kUnsupported);
}

// The manual's correction of the height is where its beams cross.
TEST_F(Velodyne, TheBeamsOfAVlp16CrossBeforeItsAxis) {
  const double corrections_mm[16] = {11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                     5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
  for (size_t row = 0; row < 16; ++row) {
    const double altitude_rad = static_cast<double>(kVlp16Altitude_deg[row]) * M_PI / 180.0;
    const double raised_mm = -1000.0 * static_cast<double>(kVlp16Origin_m) * std::sin(altitude_rad);
    EXPECT_NEAR(raised_mm, corrections_mm[row], 0.2) << row;
  }
}

}  // namespace
}  // namespace hardpack::velodyne
