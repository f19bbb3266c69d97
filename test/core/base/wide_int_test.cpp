// SPDX-License-Identifier: Apache-2.0
#include "core/base/wide_int.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace hardpack {
namespace {

constexpr int64_t kLargestInt64 = std::numeric_limits<int64_t>::max();

// --- Divide
// ---------------------------------------------------------------------------------------

TEST(WideInt, DividesAtTheEndsOfTheRange) {
  for (const int64_t dividend :
       {int64_t{0}, int64_t{1}, int64_t{65535}, int64_t{65536}, int64_t{0xffffffff},
        int64_t{0x100000000}, kLargestInt64 - 1, kLargestInt64}) {
    for (const int32_t divisor : {1, 2, 3, 5, 1024, 32767, 32768, 65534, 65535}) {
      const Division division = Divide(dividend, divisor);
      EXPECT_EQ(division.quotient, dividend / divisor) << dividend << " / " << divisor;
      EXPECT_EQ(division.remainder, dividend % divisor) << dividend << " % " << divisor;
    }
  }
}

TEST(WideInt, DividesAsTheProcessorDoes) {
  constexpr unsigned kSeed = 20261121;
  std::mt19937_64 random(kSeed);
  for (int trial = 0; trial < 1'000'000; ++trial) {
    // Every magnitude is as likely as every other.
    const auto dividend = static_cast<int64_t>(random() >> (1 + random() % 63));
    const auto divisor = static_cast<int32_t>(1 + random() % kMaxDivisor);
    const Division division = Divide(dividend, divisor);
    ASSERT_EQ(division.quotient, dividend / divisor) << dividend << " / " << divisor;
    ASSERT_EQ(division.remainder, dividend % divisor) << dividend << " % " << divisor;
  }
}

// --- ToFloat
// --------------------------------------------------------------------------------------

TEST(WideInt, GivesTheFloatNearAnyValue) {
  constexpr unsigned kSeed = 20261122;
  std::mt19937_64 random(kSeed);
  for (int trial = 0; trial < 1'000'000; ++trial) {
    const uint64_t value = random() >> (random() % 64);
    const double exact = static_cast<double>(value);
    const double error = std::abs(static_cast<double>(ToFloat(value)) - exact);
    if (value < (1u << 24)) {
      ASSERT_EQ(error, 0.0) << value;
    } else {
      ASSERT_LE(error, exact * 0x1p-22) << value;
    }
  }
  EXPECT_EQ(ToFloat(std::numeric_limits<uint64_t>::max()), 0x1p64f);
}

}  // namespace
}  // namespace hardpack
