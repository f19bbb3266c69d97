// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/binary64.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/base/math.h"

// Held against the host's double arithmetic.

namespace hardpack::vectornav {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr int64_t kUntouched = 77;

uint64_t BitsOf(double value) {
  return std::bit_cast<uint64_t>(value);
}

// value * 1e9 to the nearest integer, halves away from zero, of |value| < 2^21: `taken` is what
// rounding took from the product, and decides where the rounded product lies half way.
int64_t HostBillionths(double value) {
  const double product = value * 1e9;
  const double taken = std::fma(value, 1e9, -product);
  double whole = std::nearbyint(product);
  const double rest = product - whole;
  const bool negative = std::signbit(value);
  if (rest == 0.5 && (taken > 0 || (taken == 0 && !negative))) whole += 1;
  if (rest == -0.5 && (taken < 0 || (taken == 0 && negative))) whole -= 1;
  return static_cast<int64_t>(whole);
}

int64_t Billionths(double value) {
  int64_t billionths = kUntouched;
  EXPECT_EQ(BillionthsFromBinary64(BitsOf(value), billionths), Status::kOk) << value;
  return billionths;
}

// Every magnitude from the smallest to the largest, and the neighbours of each power of two.
std::vector<double> ManyDoubles(uint32_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> values = {0.0, -0.0, 1.0, 90.0, 180.0, 1e-9, 0.5e-9, 1.5e-9, 2.5e-9};
  for (int exponent = -1074; exponent <= 1023; ++exponent) {
    const double power = std::ldexp(1.0, exponent);
    values.insert(values.end(), {power, std::nextafter(power, 0.0), std::nextafter(power, 1e308)});
    for (int i = 0; i < 20; ++i) {
      const auto fraction = static_cast<double>(random() >> 11) * 0x1p-53;
      values.push_back(std::ldexp(1.0 + fraction, exponent));
    }
  }
  const size_t positive = values.size();
  for (size_t i = 0; i < positive; ++i) values.push_back(-values[i]);
  return values;
}

TEST(Binary64, DegreesBecomeNanodegrees) {
  EXPECT_EQ(Billionths(30.6187351), 30'618'735'100);
  EXPECT_EQ(Billionths(-96.3365), -96'336'500'000);
  EXPECT_EQ(Billionths(90.0), 90'000'000'000);
  EXPECT_EQ(Billionths(-180.0), -180'000'000'000);
  EXPECT_EQ(Billionths(0.0), 0);
  EXPECT_EQ(Billionths(-0.0), 0);
}

// 2^-10 = 976562.5 e-9, which a double holds exactly.
TEST(Binary64, HalvesGoAwayFromZero) {
  EXPECT_EQ(Billionths(0x1p-10), 976'563);
  EXPECT_EQ(Billionths(-0x1p-10), -976'563);
  EXPECT_EQ(Billionths(3 * 0x1p-10), 2'929'688);
  EXPECT_EQ(Billionths(std::nextafter(0x1p-10, 0.0)), 976'562);
}

TEST(Binary64, BillionthsAreTheHostsForManyDoubles) {
  constexpr uint32_t kSeed = 5;
  for (const double value : ManyDoubles(kSeed)) {
    if (std::abs(value) >= 0x1p21) continue;
    ASSERT_EQ(Billionths(value), HostBillionths(value))
        << "seed " << kSeed << ", " << std::hexfloat << value;
  }
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> degrees(-180.0, 180.0);
  for (int i = 0; i < 200'000; ++i) {
    const double value = degrees(random);
    ASSERT_EQ(Billionths(value), HostBillionths(value)) << "seed " << kSeed << ", " << value;
  }
}

TEST(Binary64, WhatAnIntegerDoesNotHoldIsRefused) {
  int64_t billionths = kUntouched;
  for (const double value : ManyDoubles(6)) {
    if (std::abs(value) < 9.3e9) continue;
    ASSERT_EQ(BillionthsFromBinary64(BitsOf(value), billionths), Status::kCapacityExceeded)
        << value;
  }
  EXPECT_EQ(Billionths(9.2e9), 9'200'000'000'000'000'000);
  EXPECT_EQ(Billionths(-9.2e9), -9'200'000'000'000'000'000);
  EXPECT_EQ(billionths, kUntouched);
}

TEST(Binary64, WhatIsNotFiniteIsRefused) {
  int64_t billionths = kUntouched;
  for (const uint64_t bits : {BitsOf(kInfinite), BitsOf(-kInfinite), BitsOf(std::nan("")),
                              0x7ff0000000000001u, 0xffffffffffffffffu}) {
    EXPECT_EQ(BillionthsFromBinary64(bits, billionths), Status::kNotFinite);
  }
  EXPECT_EQ(billionths, kUntouched);
}

TEST(Binary64, FloatsAreTheHosts) {
  constexpr uint32_t kSeed = 7;
  for (const double value : ManyDoubles(kSeed)) {
    // The host's conversion is undefined beyond the largest float's rounding range.
    const bool too_large = std::abs(value) >= 0x1.ffffffp127;
    const float host = too_large ? std::copysign(std::numeric_limits<float>::infinity(),
                                                 static_cast<float>(value > 0 ? 1 : -1))
                                 : static_cast<float>(value);
    ASSERT_EQ(std::bit_cast<uint32_t>(FloatFromBinary64(BitsOf(value))),
              std::bit_cast<uint32_t>(host))
        << "seed " << kSeed << ", " << std::hexfloat << value;
  }
  EXPECT_TRUE(std::isnan(FloatFromBinary64(BitsOf(std::nan("")))));
  EXPECT_TRUE(std::isnan(FloatFromBinary64(0x7ff0000000000001u)));
  EXPECT_EQ(FloatFromBinary64(BitsOf(-kInfinite)), -std::numeric_limits<float>::infinity());
}

// The float's last bit: halves between two floats go to the even one.
TEST(Binary64, HalvesBetweenFloatsGoToTheEvenOne) {
  EXPECT_EQ(FloatFromBinary64(BitsOf(1.0 + 0x1p-24)), 1.0f);
  EXPECT_EQ(FloatFromBinary64(BitsOf(1.0 + 3 * 0x1p-24)), 1.0f + 0x1p-22f);
  EXPECT_EQ(FloatFromBinary64(BitsOf(0x1p-150)), 0.0f);
  EXPECT_EQ(FloatFromBinary64(BitsOf(3 * 0x1p-150)), 0x1p-148f);
}

// strtod is correctly rounded: the text of n / 1e9 is exact.
TEST(Binary64, FromBillionthsIsTheNearest) {
  constexpr uint32_t kSeed = 8;
  std::mt19937_64 random(kSeed);
  std::vector<int64_t> values = {
      0, 1, -1, 5, 999'999'999, 1'000'000'000, 90'000'000'000, INT64_MAX, -INT64_MAX, INT64_MIN};
  for (int bits = 1; bits < 64; ++bits) {
    for (int i = 0; i < 500; ++i) {
      const auto value = static_cast<int64_t>(random() >> bits);
      values.insert(values.end(), {value, -value});
    }
  }
  for (const int64_t value : values) {
    const double nearest = std::strtod((std::to_string(value) + "e-9").c_str(), nullptr);
    ASSERT_EQ(Binary64FromBillionths(value), BitsOf(nearest)) << "seed " << kSeed << ", " << value;
  }
}

TEST(Binary64, BillionthsOfTheGlobeSurviveTheWayThereAndBack) {
  constexpr uint32_t kSeed = 9;
  std::mt19937_64 random(kSeed);
  std::uniform_int_distribution<int64_t> angle(-180'000'000'000, 180'000'000'000);
  for (int i = 0; i < 100'000; ++i) {
    const int64_t value = angle(random);
    int64_t back = kUntouched;
    ASSERT_EQ(BillionthsFromBinary64(Binary64FromBillionths(value), back), Status::kOk);
    ASSERT_EQ(back, value) << "seed " << kSeed;
  }
}

TEST(Binary64, FromFloatIsExact) {
  std::mt19937 random(10);
  std::vector<uint32_t> patterns = {0u,          0x80000000u, 1u,          0x007fffffu,
                                    0x00800000u, 0x7f7fffffu, 0x7f800000u, 0xff800000u};
  for (int i = 0; i < 100'000; ++i) patterns.push_back(static_cast<uint32_t>(random()));
  for (const uint32_t pattern : patterns) {
    const auto value = std::bit_cast<float>(pattern);
    if (std::isnan(value)) continue;
    ASSERT_EQ(Binary64FromFloat(value), BitsOf(static_cast<double>(value))) << value;
  }
  EXPECT_TRUE(std::isnan(std::bit_cast<double>(Binary64FromFloat(std::nanf("")))));
}

}  // namespace
}  // namespace hardpack::vectornav
