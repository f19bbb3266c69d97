// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/shard.h"

#include <gtest/gtest.h>

namespace hardpack::experiment {
namespace {

TEST(Shard, GivesEverySeedToExactlyOne) {
  for (int64_t count = 1; count <= 9; ++count) {
    for (uint64_t seed = 0; seed < 100; ++seed) {
      int owners = 0;
      for (int64_t number = 1; number <= count; ++number) {
        owners += Shard{number, count}.Has(seed) ? 1 : 0;
      }
      EXPECT_EQ(owners, 1);
    }
  }
}

TEST(Shard, IsRead) {
  Shard shard;
  ASSERT_TRUE(ParseShard("3/8", shard).ok());
  EXPECT_EQ(shard.number, 3);
  EXPECT_EQ(shard.count, 8);
}

TEST(Shard, IsRefusedWhenItIsNone) {
  for (const char* text : {"", "3", "/", "3/", "/8", "0/8", "9/8", "-1/8", "3/0", "3/8x", "3 /8",
                           "1/999999999", "99999999999999999999/1"}) {
    Shard shard;
    const ReadOutcome outcome = ParseShard(text, shard);
    EXPECT_FALSE(outcome.ok()) << text;
    EXPECT_NE(outcome.message.find("K/N"), std::string::npos);
  }
}

}  // namespace
}  // namespace hardpack::experiment
