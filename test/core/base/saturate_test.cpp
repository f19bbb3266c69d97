// SPDX-License-Identifier: Apache-2.0
#include "core/base/saturate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "gtest/gtest.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

int32_t Saturated(double value) {
  if (std::isnan(value)) return 0;
  return static_cast<int32_t>(std::clamp(value, -2147483648.0, 2147483647.0));
}

void ExpectAsDouble(float value) {
  const double exact_value = static_cast<double>(value);
  ASSERT_EQ(FloorToInt(value), Saturated(std::floor(exact_value))) << value;
  ASSERT_EQ(RoundToInt(value), Saturated(std::round(exact_value))) << value;
}

TEST(Saturate, AgreesWithDoubleOverAllFloats) {
  for (uint64_t bits = 0; bits < (uint64_t{1} << 32); bits += 4099) {
    ExpectAsDouble(std::bit_cast<float>(static_cast<uint32_t>(bits)));
  }
}

// Whole numbers, halves, and the floats next to them.
TEST(Saturate, AgreesWithDoubleWhereTheResultChanges) {
  for (int half = -4000; half <= 4000; ++half) {
    const float value = static_cast<float>(half) * 0.5f;
    ExpectAsDouble(value);
    ExpectAsDouble(std::nextafter(value, kInfinity));
    ExpectAsDouble(std::nextafter(value, -kInfinity));
  }
  for (int exponent = -30; exponent <= 40; ++exponent) {
    for (const float sign : {-1.0f, 1.0f}) {
      const float value = std::ldexp(sign, exponent);
      ExpectAsDouble(value);
      ExpectAsDouble(value + 0.5f);
      ExpectAsDouble(std::nextafter(value, kInfinity));
      ExpectAsDouble(std::nextafter(value, -kInfinity));
    }
  }
}

TEST(Saturate, RoundsHalvesAwayFromZero) {
  EXPECT_EQ(RoundToInt(0.5f), 1);
  EXPECT_EQ(RoundToInt(-0.5f), -1);
  EXPECT_EQ(RoundToInt(2.5f), 3);
  EXPECT_EQ(RoundToInt(-2.5f), -3);
  EXPECT_EQ(RoundToInt(std::nextafter(0.5f, 0.0f)), 0);
}

TEST(Saturate, GivesTheNearestEndBeyondTheRange) {
  EXPECT_EQ(FloorToInt(2147483648.0f), INT32_MAX);
  EXPECT_EQ(FloorToInt(2147483520.0f), 2147483520);
  EXPECT_EQ(FloorToInt(-2147483648.0f), INT32_MIN);
  EXPECT_EQ(FloorToInt(-2147483904.0f), INT32_MIN);
  EXPECT_EQ(RoundToInt(kInfinity), INT32_MAX);
  EXPECT_EQ(RoundToInt(-kInfinity), INT32_MIN);
}

TEST(Saturate, GivesZeroForNan) {
  EXPECT_EQ(FloorToInt(kNaN), 0);
  EXPECT_EQ(RoundToInt(-kNaN), 0);
}

TEST(Saturate, ConvertsInConstantExpressions) {
  static_assert(FloorToInt(-0.25f) == -1);
  static_assert(RoundToInt(1.0e20f) == INT32_MAX);
}

TEST(ClampInt, KeepsTheNearestEnd) {
  EXPECT_EQ(ClampInt(-5, -3, 7), -3);
  EXPECT_EQ(ClampInt(8, -3, 7), 7);
  EXPECT_EQ(ClampInt(2, -3, 7), 2);
  EXPECT_EQ(ClampInt(INT32_MIN, INT32_MIN, INT32_MAX), INT32_MIN);
}

}  // namespace
}  // namespace hardpack
