// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/ouster.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "test/hal/ouster/ouster_packets.h"

namespace hardpack::ouster {
namespace {

using test::Encode;
using test::EncodeRng19;
using test::PacketIdentity;
using test::RandomColumns;

Metadata MetadataOf(Profile profile, int beams) {
  Metadata metadata;
  metadata.profile = profile;
  metadata.beams = beams;
  metadata.columns_per_frame = 1024;
  metadata.columns_per_packet = 16;
  metadata.column_window_last = 1023;
  return metadata;
}

PacketLayout LayoutOf(const Metadata& metadata) {
  PacketLayout layout;
  EXPECT_EQ(MakeLayout(metadata, layout), Status::kOk);
  return layout;
}

void ExpectSameColumn(const LidarColumn& a, const LidarColumn& b) {
  EXPECT_EQ(a.timestamp_ns, b.timestamp_ns);
  EXPECT_EQ(a.measurement_id, b.measurement_id);
  EXPECT_EQ(a.frame_id, b.frame_id);
  EXPECT_EQ(a.encoder_ticks, b.encoder_ticks);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.valid, b.valid);
  EXPECT_EQ(a.returns, b.returns);
  ASSERT_EQ(a.beams, b.beams);
  for (int row = 0; row < a.beams; ++row) {
    ASSERT_EQ(a.range_mm[row], b.range_mm[row]) << row;
    ASSERT_EQ(a.signal[row], b.signal[row]) << row;
    ASSERT_EQ(a.reflectivity[row], b.reflectivity[row]) << row;
    ASSERT_EQ(a.near_ir[row], b.near_ir[row]) << row;
    ASSERT_EQ(a.flags[row], b.flags[row]) << row;
    ASSERT_EQ(a.second_range_mm[row], b.second_range_mm[row]) << row;
    ASSERT_EQ(a.second_signal[row], b.second_signal[row]) << row;
    ASSERT_EQ(a.second_reflectivity[row], b.second_reflectivity[row]) << row;
    ASSERT_EQ(a.second_flags[row], b.second_flags[row]) << row;
  }
}

// Sizes that the maker's documentation states.
TEST(OusterLayout, HasTheDocumentedSizes) {
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kLegacy, 64)).packet_bytes, 12608);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kLegacy, 64)).column_bytes, 788);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kRng19Rfl8Sig16Nir16, 64)).packet_bytes, 12544);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kRng19Rfl8Sig16Nir16, 128)).packet_bytes, 24832);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kRng15Rfl8Nir8, 64)).packet_bytes, 4352);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kRng15Rfl8Nir8, 128)).packet_bytes, 8448);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kRng19Rfl8Sig16Nir16Dual, 64)).packet_bytes, 16640);
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kRng19Rfl8Sig16Nir16Dual, 128)).packet_bytes, 33024);
}

TEST(OusterLayout, TakesTheMostThatItMay) {
  Metadata metadata = MetadataOf(Profile::kLegacy, 16);
  metadata.columns_per_packet = kMaxColumnsPerPacket;
  metadata.columns_per_frame = kMaxColumnsPerRevolution;
  EXPECT_EQ(LayoutOf(metadata).packet_bytes, 64 * (16 + 16 * 12 + 4));
  EXPECT_EQ(LayoutOf(MetadataOf(Profile::kLegacy, kMaxBeams)).beams, 128);
}

TEST(OusterLayout, RefusesWhatItCannotDecode) {
  PacketLayout layout;
  EXPECT_EQ(MakeLayout(MetadataOf(static_cast<Profile>(4), 64), layout), Status::kUnsupported);
  EXPECT_EQ(MakeLayout(MetadataOf(static_cast<Profile>(200), 64), layout), Status::kUnsupported);
  for (const int beams : {-1, 0, 129, INT32_MAX, INT32_MIN}) {
    EXPECT_EQ(MakeLayout(MetadataOf(Profile::kLegacy, beams), layout), Status::kInvalidArgument);
  }
  Metadata metadata = MetadataOf(Profile::kLegacy, 64);
  for (const int columns : {-1, 0, 65, INT32_MAX}) {
    metadata.columns_per_packet = columns;
    EXPECT_EQ(MakeLayout(metadata, layout), Status::kInvalidArgument);
  }
  // 16 columns of 128 DUAL beams are the most.
  Metadata large = MetadataOf(Profile::kRng19Rfl8Sig16Nir16Dual, 128);
  EXPECT_EQ(MakeLayout(large, layout), Status::kOk);
  EXPECT_LE(layout.packet_bytes, kMaxPacketBytes);
  large.columns_per_packet = 17;
  EXPECT_EQ(MakeLayout(large, layout), Status::kCapacityExceeded);
  metadata.columns_per_packet = 16;
  metadata.columns_per_frame = 2049;
  EXPECT_EQ(MakeLayout(metadata, layout), Status::kCapacityExceeded);
  metadata.columns_per_frame = 0;
  EXPECT_EQ(MakeLayout(metadata, layout), Status::kInvalidArgument);

  // What a failed MakeLayout leaves is refused.
  const std::vector<uint8_t> packet(12608);
  PacketHeader header;
  LidarColumn column;
  EXPECT_EQ(CheckPacket(layout, metadata, packet, header), Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(layout, packet, 0, column), Status::kInvalidArgument);
}

class OusterCodec : public ::testing::TestWithParam<std::tuple<Profile, int>> {
 protected:
  std::vector<uint8_t> Encode(const std::vector<LidarColumn>& columns) const {
    return test::Encode(profile(), identity_, columns);
  }
  Profile profile() const { return std::get<0>(GetParam()); }
  int beams() const { return std::get<1>(GetParam()); }

  PacketIdentity identity_{1, 0xbeef, 0x52dffd, 992210000957};
};

TEST_P(OusterCodec, DecodesEveryFieldThatWasWritten) {
  const unsigned seed = 7001;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  Metadata metadata = MetadataOf(profile(), beams());
  metadata.init_id = identity_.init_id;
  metadata.serial_number = identity_.serial_number;
  const PacketLayout layout = LayoutOf(metadata);
  LidarColumn decoded;
  for (int packet_number = 0; packet_number < 64; ++packet_number) {
    const std::vector<LidarColumn> columns =
        RandomColumns(random, profile(), beams(), 16, 0xbeef, 16 * packet_number);
    const std::vector<uint8_t> packet = Encode(columns);
    ASSERT_EQ(static_cast<int32_t>(packet.size()), layout.packet_bytes);
    PacketHeader header;
    ASSERT_EQ(CheckPacket(layout, metadata, packet, header), Status::kOk);
    if (profile() != Profile::kLegacy) {
      EXPECT_EQ(header.frame_id, 0xbeef);
      EXPECT_EQ(header.init_id, identity_.init_id);
      EXPECT_EQ(header.serial_number, identity_.serial_number);
    }
    for (int index = 0; index < 16; ++index) {
      ASSERT_EQ(DecodeColumn(layout, packet, index, decoded), Status::kOk);
      ExpectSameColumn(decoded, columns[static_cast<size_t>(index)]);
    }
  }
}

// SR-INP01
TEST_P(OusterCodec, RefusesEveryOtherSize) {
  std::mt19937 random(7002);
  const Metadata metadata = MetadataOf(profile(), beams());
  const PacketLayout layout = LayoutOf(metadata);
  const std::vector<uint8_t> packet = Encode(RandomColumns(random, profile(), beams(), 16, 1, 0));
  LidarColumn column;
  PacketHeader header;
  const size_t footer_bytes = profile() == Profile::kLegacy ? 0 : 32;
  for (size_t size = 0; size < packet.size(); ++size) {
    // A copy of exactly this size, so that a sanitizer sees any byte read beyond it.
    const std::vector<uint8_t> cut(packet.begin(),
                                   packet.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(CheckPacket(layout, metadata, cut, header), Status::kTruncated) << size;
    if (size < packet.size() - footer_bytes) {
      ASSERT_EQ(DecodeColumn(layout, cut, 15, column), Status::kTruncated) << size;
    }
  }
  std::vector<uint8_t> longer = packet;
  longer.push_back(0);
  EXPECT_EQ(CheckPacket(layout, metadata, longer, header), Status::kOversized);
}

TEST_P(OusterCodec, TellsInvalidColumnsAndBadIds) {
  std::mt19937 random(7003);
  const Metadata metadata = MetadataOf(profile(), beams());
  const PacketLayout layout = LayoutOf(metadata);
  std::vector<LidarColumn> columns = RandomColumns(random, profile(), beams(), 16, 1, 1012);
  columns[0].status = profile() == Profile::kLegacy ? 0xfffffffeu : 0xfffeu;
  columns[0].valid = false;
  columns[1].status = 0;
  columns[1].valid = false;
  columns[2].measurement_id = 65535;
  const std::vector<uint8_t> packet = Encode(columns);
  LidarColumn column;
  EXPECT_EQ(DecodeColumn(layout, packet, 0, column), Status::kColumnInvalid);
  columns[0].frame_id = column.frame_id;  // a header's, where the profile has one
  ExpectSameColumn(column, columns[0]);
  EXPECT_EQ(DecodeColumn(layout, packet, 1, column), Status::kColumnInvalid);
  EXPECT_EQ(DecodeColumn(layout, packet, 2, column), Status::kBadColumn);
  EXPECT_EQ(DecodeColumn(layout, packet, 11, column), Status::kOk);
  EXPECT_EQ(column.measurement_id, 1023);
  EXPECT_EQ(DecodeColumn(layout, packet, 12, column), Status::kBadColumn);
  EXPECT_EQ(DecodeColumn(layout, packet, -1, column), Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(layout, packet, 16, column), Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(layout, packet, INT32_MAX, column), Status::kInvalidArgument);
}

// Whatever the bytes, a column that is said to be good is within the sensor.
TEST_P(OusterCodec, StaysWithinItsTypesOnRandomBytes) {
  const unsigned seed = 7004;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const Metadata metadata = MetadataOf(profile(), beams());
  const PacketLayout layout = LayoutOf(metadata);
  std::vector<uint8_t> packet = Encode(RandomColumns(random, profile(), beams(), 16, 1, 0));
  const test::FieldLimits limits = test::LimitsOf(profile());
  LidarColumn column;
  for (int round = 0; round < 3000; ++round) {
    packet[random() % packet.size()] ^= static_cast<uint8_t>(1u << (random() % 8));
    const size_t size = random() % 4 == 0 ? random() % (packet.size() + 1) : packet.size();
    const int index = static_cast<int>(random() % 18) - 1;
    const Status status = DecodeColumn(layout, {packet.data(), size}, index, column);
    if (status != Status::kOk) continue;
    EXPECT_TRUE(column.valid);
    EXPECT_LT(column.measurement_id, 1024);
    EXPECT_EQ(column.beams, beams());
    for (int row = 0; row < beams(); ++row) {
      ASSERT_LE(column.range_mm[row], limits.range_mask * limits.range_unit_mm);
      ASSERT_LE(column.flags[row], limits.flags_mask);
      ASSERT_LE(column.near_ir[row], limits.near_ir_mask * limits.near_ir_unit);
    }
  }
}

std::string ProfileName(Profile profile) {
  switch (profile) {
    case Profile::kLegacy:
      return "Legacy";
    case Profile::kRng19Rfl8Sig16Nir16:
      return "Rng19";
    case Profile::kRng15Rfl8Nir8:
      return "Rng15";
    default:
      return "Dual";
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, OusterCodec,
                         ::testing::Combine(::testing::Values(Profile::kLegacy,
                                                              Profile::kRng19Rfl8Sig16Nir16,
                                                              Profile::kRng15Rfl8Nir8,
                                                              Profile::kRng19Rfl8Sig16Nir16Dual),
                                            ::testing::Values(16, 32, 64, 128)),
                         [](const ::testing::TestParamInfo<std::tuple<Profile, int>>& info) {
                           return ProfileName(std::get<0>(info.param)) + "x" +
                                  std::to_string(std::get<1>(info.param));
                         });

// A column that held two returns and now one keeps no trace of the second in `returns`.
TEST(OusterDecodeColumn, SaysHowManyReturnsABeamHas) {
  std::mt19937 random(7006);
  const auto column = std::make_unique<LidarColumn>();
  for (const Profile profile : {Profile::kRng19Rfl8Sig16Nir16Dual, Profile::kRng19Rfl8Sig16Nir16,
                                Profile::kRng19Rfl8Sig16Nir16Dual, Profile::kRng15Rfl8Nir8,
                                Profile::kRng19Rfl8Sig16Nir16Dual, Profile::kLegacy}) {
    const PacketLayout layout = LayoutOf(MetadataOf(profile, 16));
    const std::vector<uint8_t> packet =
        Encode(profile, {}, RandomColumns(random, profile, 16, 16, 0, 0));
    ASSERT_EQ(DecodeColumn(layout, packet, 3, *column), Status::kOk);
    EXPECT_EQ(column->returns, profile == Profile::kRng19Rfl8Sig16Nir16Dual ? 2 : 1);
  }
}

// A window's first and last packet hold columns of both kinds, also where it is narrower than one.
TEST(OusterDecodeColumn, TellsEachColumnOfAPartlyInvalidPacket) {
  std::mt19937 random(7007);
  for (const Profile profile : {Profile::kLegacy, Profile::kRng15Rfl8Nir8}) {
    const PacketLayout layout = LayoutOf(MetadataOf(profile, 32));
    std::vector<LidarColumn> columns = RandomColumns(random, profile, 32, 16, 0, 256);
    for (int i = 0; i < 16; ++i) {
      if (i == 5 || i == 6) continue;
      columns[static_cast<size_t>(i)].status = 0;
    }
    const std::vector<uint8_t> packet = Encode(profile, {}, columns);
    const auto column = std::make_unique<LidarColumn>();
    for (int i = 0; i < 16; ++i) {
      const bool valid = i == 5 || i == 6;
      EXPECT_EQ(DecodeColumn(layout, packet, i, *column),
                valid ? Status::kOk : Status::kColumnInvalid);
      EXPECT_EQ(column->valid, valid);
      EXPECT_EQ(column->measurement_id, 256 + i);
    }
  }
}

// SR-INP01
TEST(OusterCheckPacket, TellsAnotherSensorFromANewStartOfTheSame) {
  std::mt19937 random(7005);
  Metadata metadata = MetadataOf(Profile::kRng19Rfl8Sig16Nir16, 16);
  const PacketLayout layout = LayoutOf(metadata);
  const PacketIdentity identity{1, 3, 0x123456, 0x123456789a};
  const std::vector<LidarColumn> columns = RandomColumns(random, metadata.profile, 16, 16, 3, 0);
  const std::vector<uint8_t> packet = EncodeRng19(identity, columns);
  constexpr uint32_t kSame = 0x123456;
  constexpr uint32_t kOther = 0x123457;
  struct Case {
    uint32_t init_id;  // expected
    uint64_t serial_number;
    Status status;
  };
  const Case cases[] = {{0, 0, Status::kOk},
                        {kSame, 0, Status::kOk},
                        {0, 0x123456789a, Status::kOk},
                        {kSame, 0x123456789a, Status::kOk},
                        {kOther, 0, Status::kSensorRestarted},
                        {kOther, 0x123456789a, Status::kSensorRestarted},
                        {0, 0x123456789b, Status::kWrongSensor},
                        {kSame, 0x123456789b, Status::kWrongSensor},
                        {kOther, 0x123456789b, Status::kWrongSensor},
                        {kSame, 0x5512345678, Status::kWrongSensor}};
  for (const Case& one : cases) {
    metadata.init_id = one.init_id;
    metadata.serial_number = one.serial_number;
    PacketHeader header;
    EXPECT_EQ(CheckPacket(layout, metadata, packet, header), one.status);
    EXPECT_EQ(header.init_id, kSame);
    EXPECT_EQ(header.serial_number, 0x123456789au);
    EXPECT_EQ(CheckPacket(layout, SensorIdentity{one.init_id, one.serial_number}, packet, header),
              one.status);
  }
}

// SR-INP01
TEST(OusterCheckPacket, RefusesOtherPacketTypes) {
  std::mt19937 random(7008);
  const Metadata metadata = MetadataOf(Profile::kRng15Rfl8Nir8, 16);
  const PacketLayout layout = LayoutOf(metadata);
  const std::vector<LidarColumn> columns = RandomColumns(random, metadata.profile, 16, 16, 3, 0);
  PacketHeader header;
  for (const uint16_t type : {uint16_t{0}, uint16_t{2}, uint16_t{257}}) {
    const std::vector<uint8_t> packet = Encode(metadata.profile, {type, 3, 5, 6}, columns);
    EXPECT_EQ(CheckPacket(layout, metadata, packet, header), Status::kWrongPacketType);
  }
}

// SR-INP01
TEST(OusterCheckPacket, HoldsPacketsToTheCrcOnlyWhereTheFirmwareHasIt) {
  std::mt19937 random(7009);
  for (const Profile profile : {Profile::kRng19Rfl8Sig16Nir16, Profile::kRng15Rfl8Nir8,
                                Profile::kRng19Rfl8Sig16Nir16Dual, Profile::kLegacy}) {
    Metadata metadata = MetadataOf(profile, 32);
    std::vector<uint8_t> packet =
        Encode(profile, {1, 3, 5, 6}, RandomColumns(random, profile, 32, 16, 3, 0));
    PacketHeader header;
    EXPECT_EQ(CheckPacket(LayoutOf(metadata), metadata, packet, header), Status::kOk);
    metadata.crc_in_footer = true;
    const PacketLayout layout = LayoutOf(metadata);
    // LEGACY has no footer: nothing to hold it to.
    EXPECT_EQ(layout.crc_in_footer, profile != Profile::kLegacy);
    EXPECT_EQ(CheckPacket(layout, metadata, packet, header),
              profile == Profile::kLegacy ? Status::kOk : Status::kBadCrc);
    test::SetCrc(packet);
    EXPECT_EQ(CheckPacket(layout, metadata, packet, header), Status::kOk);
  }
}

// No single flipped bit gets through, wherever it is; a damaged identity is not taken for a new
// one.
// SR-INP01
TEST(OusterCheckPacket, SeesEveryFlippedBit) {
  std::mt19937 random(7010);
  Metadata metadata = MetadataOf(Profile::kRng15Rfl8Nir8, 16);
  metadata.crc_in_footer = true;
  metadata.init_id = 5;
  metadata.serial_number = 6;
  const PacketLayout layout = LayoutOf(metadata);
  std::vector<uint8_t> packet =
      Encode(metadata.profile, {1, 3, 5, 6}, RandomColumns(random, metadata.profile, 16, 16, 3, 0));
  test::SetCrc(packet);
  PacketHeader header;
  ASSERT_EQ(CheckPacket(layout, metadata, packet, header), Status::kOk);
  for (size_t bit = 0; bit < 8 * packet.size(); ++bit) {
    packet[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    const Status expected = bit < 16 ? Status::kWrongPacketType : Status::kBadCrc;
    ASSERT_EQ(CheckPacket(layout, metadata, packet, header), expected) << bit;
    packet[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
  }
}

}  // namespace
}  // namespace hardpack::ouster
