// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "hal/ouster/ouster.h"

// One packet of every profile, written byte by byte from the documented layouts: two rows, two
// columns (one for DUAL), the second of them invalid. All are synthetic: recordings are not part of
// the project. Recordings of LEGACY, RNG19 and RNG15 are decoded in test/tools/capture; of DUAL
// there is none, these bytes are all that it is held to.

namespace hardpack::ouster {
namespace {

Metadata MetadataOfTwoBeams(Profile profile, int columns_per_packet) {
  Metadata metadata;
  metadata.profile = profile;
  metadata.beams = 2;
  metadata.columns_per_frame = 1024;
  metadata.columns_per_packet = columns_per_packet;
  metadata.column_window_last = 1023;
  return metadata;
}

class OusterGoldenBytes : public ::testing::Test {
 protected:
  // What CheckPacket and DecodeColumn say of a whole packet.
  void Check(Profile profile, int columns_per_packet, const std::vector<uint8_t>& packet) {
    ASSERT_EQ(MakeLayout(MetadataOfTwoBeams(profile, columns_per_packet), layout_), Status::kOk);
    ASSERT_EQ(CheckPacket(layout_, SensorIdentity{}, packet, header_), Status::kOk);
  }
  Status Decode(const std::vector<uint8_t>& packet, int index) {
    return DecodeColumn(layout_, packet, index, *column_);
  }

  PacketLayout layout_;
  PacketHeader header_;
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

// clang-format off
constexpr std::array<uint8_t, 32> kHeader = {
    0x01, 0x00,                    // lidar packet
    0xef, 0xbe,                    // frame 0xbeef
    0x56, 0x34, 0x12,              // init id 0x123456
    0x9a, 0x78, 0x56, 0x34, 0x12,  // serial number 0x123456789a
    0x90, 0x00, 0x00, 0x00,        // alert flags, reserved
    0x00, 0x00, 0x00, 0x00,        // countdowns and states
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
// clang-format on

std::vector<uint8_t> WithHeaderAndFooter(const std::vector<uint8_t>& columns) {
  std::vector<uint8_t> packet(kHeader.size() + columns.size() + 32);
  const auto behind_header = std::copy(kHeader.begin(), kHeader.end(), packet.begin());
  std::copy(columns.begin(), columns.end(), behind_header);
  return packet;
}

TEST_F(OusterGoldenBytes, Legacy) {
  // clang-format off
  const std::vector<uint8_t> packet = {
      0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,  // timestamp
      0xff, 0x03,                                      // measurement 1023
      0x34, 0x12,                                      // frame 0x1234
      0xa8, 0x5f, 0x01, 0x00,                          // encoder 90024
      0x40, 0xe2, 0x01, 0xa0,                          // range 123456 mm, flags 0xa
      0x34, 0x12, 0x78, 0x56, 0xbc, 0x9a, 0xff, 0xff,  // reflectivity, signal, near-IR, reserved
      0xff, 0xff, 0x0f, 0x00,                          // range 1048575 mm, the largest
      0x01, 0x00, 0x02, 0x00, 0x03, 0x00, 0x00, 0x00,
      0xff, 0xff, 0xff, 0xff,                          // valid
      // The second column, cut short by the sensor.
      0x09, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,
      0x00, 0x00,
      0x35, 0x12,
      0x00, 0x00, 0x00, 0x00,
      0x00, 0x00, 0xf0, 0xff, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
      0x05, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
      0xfe, 0xff, 0xff, 0xff};                         // not all ones: invalid
  // clang-format on
  Check(Profile::kLegacy, 2, packet);
  EXPECT_EQ(header_.packet_type, 0);
  ASSERT_EQ(Decode(packet, 0), Status::kOk);
  EXPECT_EQ(column_->timestamp_ns, 0x0102030405060708u);
  EXPECT_EQ(column_->measurement_id, 1023);
  EXPECT_EQ(column_->frame_id, 0x1234);
  EXPECT_EQ(column_->encoder_ticks, 90024u);
  EXPECT_EQ(column_->status, 0xffffffffu);
  EXPECT_TRUE(column_->valid);
  EXPECT_EQ(column_->beams, 2);
  EXPECT_EQ(column_->returns, 1);
  EXPECT_EQ(column_->range_mm[0], 123456u);
  EXPECT_EQ(column_->flags[0], 0xa);
  EXPECT_EQ(column_->reflectivity[0], 0x1234);
  EXPECT_EQ(column_->signal[0], 0x5678);
  EXPECT_EQ(column_->near_ir[0], 0x9abc);
  EXPECT_EQ(column_->range_mm[1], 1048575u);
  EXPECT_EQ(column_->flags[1], 0);
  EXPECT_EQ(column_->near_ir[1], 3);
  ASSERT_EQ(Decode(packet, 1), Status::kColumnInvalid);
  EXPECT_EQ(column_->frame_id, 0x1235);
  EXPECT_FALSE(column_->valid);
  EXPECT_EQ(column_->range_mm[0], 0u);
  EXPECT_EQ(column_->flags[0], 0xf);
  EXPECT_EQ(column_->range_mm[1], 5u);
}

TEST_F(OusterGoldenBytes, Rng19) {
  // clang-format off
  const std::vector<uint8_t> packet = WithHeaderAndFooter({
      0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,  // timestamp
      0xff, 0x03,                                      // measurement 1023
      0x01, 0x00,                                      // valid
      0x40, 0xe2, 0xa9, 0xff,                          // range 123456 mm, flags 0x15, reserved
      0x34, 0xff, 0x78, 0x56, 0xbc, 0x9a, 0xff, 0xff,  // reflectivity, signal, near-IR, reserved
      0xff, 0xff, 0x07, 0x00,                          // range 524287 mm, the largest
      0xff, 0x00, 0x02, 0x00, 0x03, 0x00, 0x00, 0x00,
      0x09, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,
      0x00, 0x00,
      0xfe, 0xff,                                      // bit 0 is 0: invalid
      0x00, 0x00, 0xf8, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
      0x05, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00});
  // clang-format on
  Check(Profile::kRng19Rfl8Sig16Nir16, 2, packet);
  EXPECT_EQ(header_.packet_type, 1);
  EXPECT_EQ(header_.frame_id, 0xbeef);
  EXPECT_EQ(header_.init_id, 0x123456u);
  EXPECT_EQ(header_.serial_number, 0x123456789au);
  ASSERT_EQ(Decode(packet, 0), Status::kOk);
  EXPECT_EQ(column_->timestamp_ns, 0x0102030405060708u);
  EXPECT_EQ(column_->measurement_id, 1023);
  EXPECT_EQ(column_->frame_id, 0xbeef);
  EXPECT_EQ(column_->encoder_ticks, 0u);
  EXPECT_EQ(column_->status, 1u);
  EXPECT_EQ(column_->returns, 1);
  EXPECT_EQ(column_->range_mm[0], 123456u);
  EXPECT_EQ(column_->flags[0], 0x15);
  EXPECT_EQ(column_->reflectivity[0], 0x34);
  EXPECT_EQ(column_->signal[0], 0x5678);
  EXPECT_EQ(column_->near_ir[0], 0x9abc);
  EXPECT_EQ(column_->range_mm[1], 524287u);
  EXPECT_EQ(column_->flags[1], 0);
  EXPECT_EQ(column_->reflectivity[1], 0xff);
  EXPECT_EQ(column_->signal[1], 2);
  ASSERT_EQ(Decode(packet, 1), Status::kColumnInvalid);
  EXPECT_EQ(column_->status, 0xfffeu);
  EXPECT_EQ(column_->flags[0], 0x1f);
  EXPECT_EQ(column_->range_mm[0], 0u);
  EXPECT_EQ(column_->range_mm[1], 5u);
}

TEST_F(OusterGoldenBytes, Rng15) {
  // clang-format off
  const std::vector<uint8_t> packet = WithHeaderAndFooter({
      0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,  // timestamp
      0xff, 0x03,                                      // measurement 1023
      0x01, 0x00,                                      // valid
      0x48, 0xbc, 0x34, 0xab,  // range 0x3c48 = 15432 of 8 mm, flag, reflectivity, near-IR of 16
      0xff, 0x7f, 0x00, 0xff,  // the largest range, 32767 of 8 mm; no flag; the largest near-IR
      0x09, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,
      0x00, 0x00,
      0x00, 0x00,                                      // invalid
      0x00, 0x80, 0x00, 0x00,  // no range, but the flag
      0x01, 0x00, 0xff, 0x01});
  // clang-format on
  Check(Profile::kRng15Rfl8Nir8, 2, packet);
  column_->signal[0] = 99;  // of a column that was there before
  ASSERT_EQ(Decode(packet, 0), Status::kOk);
  EXPECT_EQ(column_->timestamp_ns, 0x0102030405060708u);
  EXPECT_EQ(column_->measurement_id, 1023);
  EXPECT_EQ(column_->frame_id, 0xbeef);
  EXPECT_EQ(column_->returns, 1);
  EXPECT_EQ(column_->range_mm[0], 123456u);
  EXPECT_EQ(column_->flags[0], 1);
  EXPECT_EQ(column_->reflectivity[0], 0x34);
  EXPECT_EQ(column_->near_ir[0], 0xab0);
  EXPECT_EQ(column_->signal[0], 0);
  EXPECT_EQ(column_->range_mm[1], 262136u);
  EXPECT_EQ(column_->flags[1], 0);
  EXPECT_EQ(column_->near_ir[1], 4080);
  ASSERT_EQ(Decode(packet, 1), Status::kColumnInvalid);
  EXPECT_EQ(column_->range_mm[0], 0u);
  EXPECT_EQ(column_->flags[0], 1);
  EXPECT_EQ(column_->range_mm[1], 8u);
  EXPECT_EQ(column_->reflectivity[1], 0xff);
  EXPECT_EQ(column_->near_ir[1], 16);
}

// Synthetic: no recording of this profile was to be had.
TEST_F(OusterGoldenBytes, Dual) {
  // clang-format off
  const std::vector<uint8_t> packet = WithHeaderAndFooter({
      0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,  // timestamp
      0xff, 0x03,                                      // measurement 1023
      0x01, 0x00,                                      // valid
      0x40, 0xe2, 0xa9, 0x34,  // first return: 123456 mm, flags 0x15, reflectivity 0x34
      0xff, 0xff, 0x57, 0xfe,  // second return: 524287 mm, flags 0x0a, reflectivity 0xfe
      0x78, 0x56, 0xf0, 0xde,  // signals
      0xbc, 0x9a, 0xff, 0xff,  // near-IR, reserved
      0x05, 0x00, 0x00, 0x01,  // one return only
      0x00, 0x00, 0x00, 0x00,
      0x02, 0x00, 0x00, 0x00,
      0x03, 0x00, 0x00, 0x00});
  // clang-format on
  Check(Profile::kRng19Rfl8Sig16Nir16Dual, 1, packet);
  ASSERT_EQ(Decode(packet, 0), Status::kOk);
  EXPECT_EQ(column_->measurement_id, 1023);
  EXPECT_EQ(column_->frame_id, 0xbeef);
  EXPECT_EQ(column_->returns, 2);
  EXPECT_EQ(column_->range_mm[0], 123456u);
  EXPECT_EQ(column_->flags[0], 0x15);
  EXPECT_EQ(column_->reflectivity[0], 0x34);
  EXPECT_EQ(column_->signal[0], 0x5678);
  EXPECT_EQ(column_->second_range_mm[0], 524287u);
  EXPECT_EQ(column_->second_flags[0], 0x0a);
  EXPECT_EQ(column_->second_reflectivity[0], 0xfe);
  EXPECT_EQ(column_->second_signal[0], 0xdef0);
  EXPECT_EQ(column_->near_ir[0], 0x9abc);
  EXPECT_EQ(column_->range_mm[1], 5u);
  EXPECT_EQ(column_->flags[1], 0);
  EXPECT_EQ(column_->reflectivity[1], 1);
  EXPECT_EQ(column_->signal[1], 2);
  EXPECT_EQ(column_->second_range_mm[1], 0u);
  EXPECT_EQ(column_->second_signal[1], 0);
  EXPECT_EQ(column_->near_ir[1], 3);
}

}  // namespace
}  // namespace hardpack::ouster
