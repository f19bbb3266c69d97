// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "hal/vectornav/crc16.h"
#include "hal/vectornav/encode.h"
#include "hal/vectornav/vectornav.h"
#include "test/hal/vectornav/vectornav_messages.h"

// Streams of random messages of every kind, sound and spoilt: what is told of them is, to the bit,
// what it was when it was last changed on purpose.

namespace hardpack::vectornav {
namespace {

// The same numbers everywhere, 32 bits of them.
class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  uint32_t operator()() { return static_cast<uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

// A number as text, in any form, now and then none.
std::string AnyNumber(Random& random, uint32_t below) {
  if (random() % 60 == 0) return random() % 2 == 0 ? "" : "1.2.3";
  std::string text = random() % 3 == 0 ? "-" : random() % 8 == 0 ? "+" : "";
  text += std::to_string(random() % below);
  if (random() % 5 != 0) text += ".";
  const uint32_t decimals = random() % 12;
  for (uint32_t i = 0; i < decimals && text.back() != '-'; ++i) {
    if (text.find('.') == std::string::npos) break;
    text += static_cast<char>('0' + random() % 10);
  }
  return text;
}

std::vector<uint8_t> AnyLine(Random& random) {
  constexpr uint32_t kBelow[] = {700'000, 2'500, 0,   370, 95, 370, 92, 185,
                                 9'000,   200,   200, 200, 90, 100, 50};
  std::string body = random() % 40 == 0 ? "VNYMR" : "VNINS";
  for (const uint32_t below : kBelow) {
    body += ",";
    if (below == 0) {  // the status, in hexadecimal
      for (int i = 0; i < 4; ++i) body += "0123456789ABCDEFabcdef"[random() % 22];
    } else {
      body += AnyNumber(random, below);
    }
  }
  if (random() % 40 == 0) body += ",1";
  return test::Bytes(test::Line(body));
}

void Seal(std::vector<uint8_t>& message) {
  size_t size = 0;
  if (!IsUsable(BinaryMessageSize(message, size))) return;
  message.resize(size, 0x40);
  const uint32_t crc = test::SlowCrc16(std::span<const uint8_t>(message).subspan(1, size - 3));
  message[size - 2] = static_cast<uint8_t>(crc >> 8);
  message[size - 1] = static_cast<uint8_t>(crc & 0xff);
}

// Any groups with any of their fields, and numbers that are small as a rule.
std::vector<uint8_t> AnyBinary(Random& random) {
  std::vector<uint8_t> message = {0xfa};
  const auto groups = static_cast<uint8_t>(random() % 4 == 0 ? random() % 128 : 1u << random() % 7);
  message.push_back(groups);
  for (int group = 0; group < 7; ++group) {
    if ((groups >> group & 1) == 0) continue;
    message.push_back(static_cast<uint8_t>(random() & random()));
    message.push_back(static_cast<uint8_t>(random() & random() & (group == 3 ? 0 : 0x3f)));
  }
  while (message.size() < kMaxBinaryBytes) {
    const auto number = static_cast<float>(static_cast<int>(random() % 400) - 200) * 0.5f;
    const double wide = random() % 2 == 0 ? 30.6 : -96.25;
    uint8_t bytes[8] = {};
    const bool is_wide = random() % 3 == 0;
    if (is_wide) std::memcpy(bytes, &wide, 8);
    if (!is_wide) std::memcpy(bytes, &number, 4);
    message.insert(message.end(), bytes, bytes + (is_wide ? 8 : 4));
    if (random() % 30 == 0) message.push_back(static_cast<uint8_t>(random()));
  }
  Seal(message);
  return message;
}

float AnyWithin(Random& random, float limit) {
  return (static_cast<float>(random() % 20001) / 10000.0f - 1.0f) * limit;
}

InsSample AnySample(Random& random) {
  InsSample sample;
  sample.has_timestamp = random() % 4 != 0;
  sample.timestamp_ns = random();
  sample.has_gps_time = random() % 2 == 0;
  sample.gps_time_ns = 1'300'000'000'000'000'000u + uint64_t{random()} * 1000u;
  sample.has_attitude = random() % 4 != 0;
  sample.roll_rad = AnyWithin(random, 3.1f);
  sample.pitch_rad = AnyWithin(random, 1.5f);
  sample.yaw_rad = AnyWithin(random, 3.1f);
  sample.has_angular_rate = random() % 4 != 0;
  sample.angular_rate = {AnyWithin(random, 3.0f), AnyWithin(random, 3.0f), 0.25f};
  sample.has_position = random() % 4 != 0;
  sample.latitude_ndeg = static_cast<int64_t>(random() % 180'000) * 1'000'003 - 90'000'000'000;
  sample.longitude_ndeg = static_cast<int64_t>(random() % 360'000) * 1'000'003 - 180'000'000'000;
  sample.altitude_m = AnyWithin(random, 4000.0f);
  sample.has_velocity = random() % 4 != 0;
  sample.velocity_ned = {AnyWithin(random, 9.0f), AnyWithin(random, 9.0f), -0.5f};
  sample.has_status = random() % 4 != 0;
  sample.status.mode = static_cast<InsMode>(random() % 4);
  sample.status.gnss_fix = random() % 2 == 0;
  sample.status.gnss_heading = random() % 2 == 0;
  sample.status.imu_error = random() % 8 == 0;
  sample.status.word = static_cast<uint16_t>(random());
  return sample;
}

std::vector<uint8_t> AnyEncoded(Random& random) {
  const InsSample sample = AnySample(random);
  std::vector<uint8_t> message(kMaxBinaryBytes);
  size_t size = 0;
  const Status status =
      random() % 2 == 0 ? EncodeBinary(sample, message, size) : EncodeAscii(sample, message, size);
  message.resize(IsUsable(status) ? size : 0);
  return message;
}

std::vector<uint8_t> AnyMessage(Random& random) {
  std::vector<uint8_t> message;
  const uint32_t kind = random() % 8;
  if (kind < 3) message = AnyLine(random);
  if (kind >= 3 && kind < 5) message = AnyBinary(random);
  if (kind >= 5) message = AnyEncoded(random);
  if (random() % 8 == 0 && !message.empty()) {  // spoilt
    const uint32_t how = random() % 3;
    const size_t at = random() % message.size();
    if (how == 0) message[at] ^= static_cast<uint8_t>(1u << random() % 8);
    if (how == 1) message.resize(at);
    if (how == 2) message.insert(message.begin() + static_cast<ptrdiff_t>(at), 2, 0xfa);
  }
  return message;
}

// FNV-1a, 64 bits.
void Mix(const std::string& text, uint64_t& hash) {
  for (const char letter : text) {
    hash = (hash ^ static_cast<uint8_t>(letter)) * 1099511628211u;
  }
}

TEST(VectornavRecorded, TellsAsItDid) {
  uint64_t hash = 14695981039346656037u;
  uint64_t samples = 0;
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    StreamParser parser;
    for (int datagram = 0; datagram < 200; ++datagram) {
      std::vector<uint8_t> bytes;
      const uint32_t messages = 1 + random() % 4;
      for (uint32_t i = 0; i < messages; ++i) {
        const std::vector<uint8_t> message = AnyMessage(random);
        bytes.insert(bytes.end(), message.begin(), message.end());
      }
      parser.BeginTick(static_cast<int>(1 + random() % 12));
      std::vector<InsSample> told;
      const size_t taken = parser.Feed(bytes);
      InsSample sample;
      while (IsUsable(parser.Next(sample))) told.push_back(sample);
      samples += told.size();
      Mix(std::to_string(taken) + " " + test::BitsOfAll(told) + test::Text(parser.counters()),
          hash);
    }
  }
  EXPECT_GT(samples, 2000u);
  EXPECT_EQ(hash, 0x3d222cf2c28ffac8u) << "0x" << std::hex << hash << "u";
}

// Each message by itself: the statuses too.
TEST(VectornavRecorded, RefusesAsItDid) {
  uint64_t hash = 14695981039346656037u;
  Random random(77);
  for (int i = 0; i < 6000; ++i) {
    const std::vector<uint8_t> message = AnyMessage(random);
    InsSample sample;
    size_t size = 0;
    const Status binary = DecodeBinary(message, sample);
    const Status ascii = DecodeAscii(message, sample);
    const Status sized = BinaryMessageSize(message, size);
    Mix(std::to_string(static_cast<int>(binary)) + " " + std::to_string(static_cast<int>(ascii)) +
            " " + std::to_string(static_cast<int>(sized)) + " " + std::to_string(size) + " " +
            std::string(message.begin(), message.end()) + test::Bits(sample),
        hash);
  }
  EXPECT_EQ(hash, 0x9af3fb1c842eae5du) << "0x" << std::hex << hash << "u";
}

}  // namespace
}  // namespace hardpack::vectornav
