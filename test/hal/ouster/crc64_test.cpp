// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/crc64.h"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

#include "test/hal/ouster/ouster_packets.h"

namespace hardpack::ouster {
namespace {

// The check value of CRC-64/XZ, as catalogues of checksums give it; at compile time too.
constexpr uint8_t kDigits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
static_assert(Crc64(kDigits) == 0x995DC9BBDF1939FAu);

TEST(OusterCrc64, GivesTheCatalogueValue) {
  EXPECT_EQ(Crc64(std::vector<uint8_t>(kDigits, kDigits + 9)), 0x995DC9BBDF1939FAu);
  EXPECT_EQ(Crc64({}), 0u);
}

TEST(OusterCrc64, EqualsTheBitwiseOneAtEveryLengthAndOffset) {
  const unsigned seed = 7101;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::vector<uint8_t> bytes(600);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
  for (size_t offset = 0; offset < 9; ++offset) {
    for (size_t size = 0; offset + size <= bytes.size(); ++size) {
      ASSERT_EQ(Crc64({bytes.data() + offset, size}), test::SlowCrc64(bytes.data() + offset, size))
          << offset << " " << size;
    }
  }
}

TEST(OusterCrc64, CoversTheLargestPacket) {
  std::vector<uint8_t> bytes(kMaxCrcBytes, 0x5a);
  EXPECT_EQ(Crc64(bytes), test::SlowCrc64(bytes.data(), bytes.size()));
  const uint64_t before = Crc64(bytes);
  bytes.back() ^= 1;
  EXPECT_NE(Crc64(bytes), before);
}

}  // namespace
}  // namespace hardpack::ouster
