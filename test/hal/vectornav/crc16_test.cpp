// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/crc16.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "test/hal/vectornav/vectornav_messages.h"

namespace hardpack::vectornav {
namespace {

std::vector<uint8_t> RandomBytes(std::mt19937& random, size_t count) {
  std::vector<uint8_t> bytes(count);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
  return bytes;
}

TEST(Crc16, IsTheCatalogues) {
  EXPECT_EQ(Crc16(test::Bytes("123456789")), 0x31c3);
  EXPECT_EQ(Crc16({}), 0);
}

TEST(Crc16, IsTheRemainderOfItsPolynomial) {
  std::mt19937 random(1);
  for (size_t size = 0; size <= kMaxCrcBytes; size += 1 + size / 8) {
    const std::vector<uint8_t> bytes = RandomBytes(random, size);
    ASSERT_EQ(Crc16(bytes), test::SlowCrc16(bytes)) << size;
  }
}

TEST(Crc16, IsZeroOverAMessageAndItsCrc) {
  std::mt19937 random(2);
  std::vector<uint8_t> bytes = RandomBytes(random, 80);
  const uint32_t crc = Crc16(bytes);
  bytes.push_back(static_cast<uint8_t>(crc >> 8));
  bytes.push_back(static_cast<uint8_t>(crc & 0xff));
  EXPECT_EQ(Crc16(bytes), 0);
}

TEST(Crc16, OfAPartFollowsFromThoseAtItsEnds) {
  constexpr uint32_t kSeed = 3;
  std::mt19937 random(kSeed);
  const std::vector<uint8_t> stream = RandomBytes(random, 3000);
  std::vector<uint16_t> crc = {0};
  for (const uint8_t byte : stream) crc.push_back(Crc16Step(crc.back(), byte));
  for (size_t size = 0; size <= kMaxCrcBytes; ++size) {
    const size_t begin = random() % (stream.size() - size + 1);
    const std::span<const uint8_t> part = std::span(stream).subspan(begin, size);
    ASSERT_EQ(Crc16Between(crc[begin], crc[begin + size], size), test::SlowCrc16(part))
        << "seed " << kSeed << ", " << size << " bytes from " << begin;
  }
}

}  // namespace
}  // namespace hardpack::vectornav
