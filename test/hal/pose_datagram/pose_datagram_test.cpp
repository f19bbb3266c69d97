// SPDX-License-Identifier: Apache-2.0
#include "hal/pose_datagram/pose_datagram.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/crc32.h"
#include "test/hal/pose_datagram/samples.h"

namespace hardpack::pose_datagram {
namespace {

using Bytes = std::vector<uint8_t>;

Status DecodeOf(const Bytes& bytes, InsSample& sample) {
  uint32_t sequence = 0;
  return Decode(std::span<const uint8_t>(bytes).first<kDatagram_bytes>(), sequence, sample);
}

// With a right CRC.
Bytes Changed(size_t at, const Bytes& to) {
  Bytes bytes = Encoded(Example(), 7);
  std::copy(to.begin(), to.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  const uint32_t crc = Crc32<112>(std::span<const uint8_t>(bytes).first(112));
  for (size_t i = 0; i < 4; ++i) bytes[112 + i] = static_cast<uint8_t>(crc >> (8 * i));
  return bytes;
}

Bytes FloatBytes(float value) {
  Bytes bytes(4);
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

std::vector<uint64_t> StampsOf(Receiver& receiver, const Bytes& bytes) {
  std::vector<uint64_t> stamps;
  std::span<const uint8_t> rest = bytes;
  InsSample sample;
  while (!rest.empty()) {
    rest = rest.subspan(receiver.Feed(rest));
    while (IsUsable(receiver.Next(sample))) stamps.push_back(sample.timestamp_ns);
  }
  return stamps;
}

Bytes Numbered(uint32_t sequence) {
  InsSample sample = Example();
  sample.timestamp_ns = sequence;
  return Encoded(sample, sequence);
}

// The block of the document, byte by byte.
TEST(PoseDatagram, IsWhatTheDocumentSays) {
  std::ifstream file(HARDPACK_SOURCE "/docs/pose_datagram.md");
  ASSERT_TRUE(file);
  std::ostringstream text;
  text << file.rdbuf();
  const size_t begin = text.str().find("```hex\n") + 7;
  std::istringstream block(text.str().substr(begin, text.str().find("```", begin) - begin));
  Bytes golden;
  for (std::string word; block >> word;) {
    golden.push_back(static_cast<uint8_t>(std::stoi(word, nullptr, 16)));
  }
  ASSERT_EQ(golden.size(), kDatagram_bytes);
  EXPECT_EQ(Encoded(Example(), 7), golden);
  InsSample sample;
  ASSERT_EQ(DecodeOf(golden, sample), Status::kOk);
  EXPECT_EQ(Encoded(sample, 7), golden);
  EXPECT_EQ(sample.longitude_ndeg, -96'336'000'000);
  EXPECT_EQ(sample.yaw_rad, 1.5f);
  EXPECT_EQ(sample.acceleration.z_mps2, -9.75f);
  EXPECT_EQ(sample.status.mode, InsMode::kTracking);
  EXPECT_TRUE(sample.status.gnss_compass);
  EXPECT_FALSE(sample.status.imu_error);
}

TEST(PoseDatagram, AGroupThatIsNotThereIsNotRead) {
  InsSample sample;
  sample.has_timestamp = true;
  sample.timestamp_ns = 5;
  sample.has_angular_rate = true;
  sample.angular_rate = {0.0f, 0.0f, 0.5f};
  Bytes bytes = Encoded(sample, 1);
  InsSample read = Example();
  ASSERT_EQ(DecodeOf(bytes, read), Status::kOk);
  EXPECT_TRUE(read.has_timestamp && read.has_angular_rate);
  EXPECT_FALSE(read.has_position || read.has_velocity || read.has_attitude ||
               read.has_acceleration || read.has_gps_time || read.has_status ||
               read.has_attitude_uncertainty);
  EXPECT_EQ(read.yaw_rad, 0.0f);
}

TEST(PoseDatagram, NoWrongBitPasses) {
  const Bytes good = Encoded(Example(), 7);
  for (size_t bit = 0; bit < 8 * kDatagram_bytes; ++bit) {
    Bytes bad = good;
    bad[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    InsSample sample;
    EXPECT_FALSE(IsUsable(DecodeOf(bad, sample))) << bit;
  }
}

TEST(PoseDatagram, RefusesWhatCannotBe) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  InsSample sample;
  EXPECT_EQ(DecodeOf(Changed(0, {'X'}), sample), Status::kWrongPacketType);
  EXPECT_EQ(DecodeOf(Changed(4, {2}), sample), Status::kUnsupported);
  EXPECT_EQ(DecodeOf(Changed(6, {4}), sample), Status::kInvalidArgument) << "mode";
  EXPECT_EQ(DecodeOf(Changed(7, {0x80}), sample), Status::kInvalidArgument) << "status";
  EXPECT_EQ(DecodeOf(Changed(13, {1}), sample), Status::kInvalidArgument) << "reserved";
  for (size_t at = 48; at < 112; at += 4) {
    EXPECT_EQ(DecodeOf(Changed(at, FloatBytes(nan)), sample), Status::kNotFinite) << at;
    EXPECT_EQ(DecodeOf(Changed(at, FloatBytes(inf)), sample), Status::kNotFinite) << at;
  }
  EXPECT_EQ(DecodeOf(Changed(39, {0x7f}), sample), Status::kInvalidArgument) << "latitude";
  EXPECT_EQ(DecodeOf(Changed(47, {0x7f}), sample), Status::kInvalidArgument) << "longitude";
  EXPECT_EQ(DecodeOf(Changed(64, FloatBytes(3.2f)), sample), Status::kInvalidArgument) << "roll";
  EXPECT_EQ(DecodeOf(Changed(68, FloatBytes(-1.6f)), sample), Status::kInvalidArgument) << "pitch";
  EXPECT_EQ(DecodeOf(Changed(72, FloatBytes(-3.2f)), sample), Status::kInvalidArgument) << "yaw";
  EXPECT_EQ(DecodeOf(Changed(108, FloatBytes(-1.0f)), sample), Status::kInvalidArgument);
  InsSample wrong = Example();
  wrong.pitch_rad = 2.0f;
  std::array<uint8_t, kDatagram_bytes> bytes = {};
  EXPECT_EQ(Encode(wrong, 1, bytes), Status::kInvalidArgument);
}

TEST(PoseReceiver, DropsCopiesAndWhatWasOvertaken) {
  Receiver receiver;
  Bytes bytes;
  for (const uint32_t sequence : {10u, 11u, 11u, 13u, 12u, 14u}) {
    const Bytes one = Numbered(sequence);
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
  EXPECT_EQ(StampsOf(receiver, bytes), (std::vector<uint64_t>{10, 11, 13, 14}));
  EXPECT_EQ(receiver.counters().repeated, 2u);
  EXPECT_EQ(receiver.counters().missed, 1u);
  EXPECT_EQ(receiver.counters().restarts, 0u);
}

TEST(PoseReceiver, KnowsASenderThatHasBegunAnew) {
  Receiver receiver;
  EXPECT_EQ(StampsOf(receiver, Numbered(5000)).size(), 1u);
  EXPECT_TRUE(StampsOf(receiver, Numbered(4001)).empty());
  EXPECT_EQ(StampsOf(receiver, Numbered(0)).size(), 1u);
  EXPECT_EQ(receiver.counters().restarts, 1u);
}

TEST(PoseReceiver, ItsNumbersWrap) {
  Receiver receiver;
  EXPECT_EQ(StampsOf(receiver, Numbered(0xffffffffu)).size(), 1u);
  EXPECT_EQ(StampsOf(receiver, Numbered(0)).size(), 1u);
  EXPECT_EQ(receiver.counters().missed, 0u);
  EXPECT_EQ(receiver.counters().restarts, 0u);
}

TEST(PoseReceiver, FindsDatagramsHoweverTheyAreCutAndWhateverIsBetweenThem) {
  Bytes bytes;
  for (uint32_t sequence = 1; sequence <= 40; ++sequence) {
    for (uint32_t i = 0; i < sequence % 7; ++i)
      bytes.push_back(static_cast<uint8_t>("HPPDH"[i % 5]));
    const Bytes one = Numbered(sequence);
    bytes.insert(bytes.end(), one.begin(), one.end());
  }
  for (const size_t piece : {1u, 3u, 115u, 117u, 1000u, 5000u}) {
    Receiver receiver;
    size_t told = 0;
    for (size_t at = 0; at < bytes.size(); at += piece) {
      const size_t end = std::min(at + piece, bytes.size());
      told += StampsOf(receiver, {bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                  bytes.begin() + static_cast<std::ptrdiff_t>(end)})
                  .size();
    }
    EXPECT_EQ(told, 40u) << piece;
    EXPECT_EQ(receiver.counters().bytes, bytes.size());
  }
}

TEST(PoseReceiver, CountsWhatItRefuses) {
  Receiver receiver;
  EXPECT_TRUE(StampsOf(receiver, Changed(6, {4})).empty());
  EXPECT_EQ(receiver.counters().refused, 1u);
  Bytes bad = Numbered(3);
  bad[100] ^= 1;
  EXPECT_TRUE(StampsOf(receiver, bad).empty());
  EXPECT_EQ(receiver.counters().bad_crc, 1u);
  EXPECT_EQ(StampsOf(receiver, Numbered(4)).size(), 1u);
}

}  // namespace
}  // namespace hardpack::pose_datagram
