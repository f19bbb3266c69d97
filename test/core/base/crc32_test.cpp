// SPDX-License-Identifier: Apache-2.0
#include "core/base/crc32.h"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

namespace hardpack {
namespace {

using Bytes = std::vector<uint8_t>;

// Bit by bit, as the standard says it.
uint32_t SlowCrc32(const Bytes& bytes) {
  uint64_t rest = 0xffffffffu;
  for (const uint8_t byte : bytes) {
    rest ^= byte;
    for (int bit = 0; bit < 8; ++bit) rest = rest % 2 == 1 ? rest / 2 ^ 0xedb88320u : rest / 2;
  }
  return static_cast<uint32_t>(rest) ^ 0xffffffffu;
}

// The algorithm's check value.
TEST(Crc32, IsThatOfEthernetAndZip) {
  constexpr std::string_view kDigits = "123456789";
  const Bytes bytes(kDigits.begin(), kDigits.end());
  EXPECT_EQ(Crc32<9>(bytes), 0xcbf43926u);
  EXPECT_EQ(Crc32<9>({}), 0u);
  for (size_t cut = 0; cut <= bytes.size(); ++cut) {
    const uint32_t first = ExtendCrc32<9>(0, std::span(bytes).first(cut));
    EXPECT_EQ(ExtendCrc32<9>(first, std::span(bytes).subspan(cut)), 0xcbf43926u);
  }
}

TEST(Crc32, IsThatOfTheBits) {
  std::mt19937 random(3);
  for (size_t size = 0; size < 300; ++size) {
    Bytes bytes(size);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    ASSERT_EQ(Crc32<300>(bytes), SlowCrc32(bytes));
  }
}

}  // namespace
}  // namespace hardpack
