// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/exact_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hardpack::sim {
namespace {

TEST(ExactMath, SineAndCosineAreThoseOfLibm) {
  std::mt19937_64 random(1);
  double worst = 0.0;
  for (int i = 0; i < 400'000; ++i) {
    const double unit = static_cast<double>(random() >> 11) * 0x1.0p-53;
    const double range = i % 2 == 0 ? 7.0 : kExactSinCosMaxAngle_rad;
    const double angle_rad = (2.0 * unit - 1.0) * range;
    const SinCosOf exact = ExactSinCos(angle_rad);
    worst = std::max(worst, std::abs(exact.sin - std::sin(angle_rad)));
    worst = std::max(worst, std::abs(exact.cos - std::cos(angle_rad)));
  }
  EXPECT_LE(worst, kExactSinCosMaxError);
  EXPECT_GT(worst, 0.0);  // it is not libm
}

TEST(ExactMath, MultiplesOfARightAngleAreHit) {
  for (int quarters = -4000; quarters <= 4000; ++quarters) {
    const double angle_rad = quarters * 1.57079632679489661923;
    const SinCosOf exact = ExactSinCos(angle_rad);
    EXPECT_NEAR(exact.sin, std::sin(angle_rad), kExactSinCosMaxError) << quarters;
    EXPECT_NEAR(exact.cos, std::cos(angle_rad), kExactSinCosMaxError) << quarters;
  }
}

TEST(ExactMath, SineIsOddAndCosineEvenBitForBit) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 10'000; ++i) {
    const double angle_rad = static_cast<double>(random() >> 11) * 0x1.0p-43;
    const SinCosOf ahead = ExactSinCos(angle_rad);
    const SinCosOf behind = ExactSinCos(-angle_rad);
    EXPECT_EQ(ahead.sin, -behind.sin);
    EXPECT_EQ(ahead.cos, behind.cos);
  }
}

TEST(ExactMath, NotANumberStaysOneAndHugeAnglesAreClamped) {
  EXPECT_TRUE(std::isnan(ExactSinCos(std::numeric_limits<double>::quiet_NaN()).sin));
  const SinCosOf edge = ExactSinCos(kExactSinCosMaxAngle_rad);
  EXPECT_EQ(ExactSinCos(std::numeric_limits<double>::infinity()).sin, edge.sin);
  EXPECT_EQ(ExactSinCos(-1.0e300).sin, -edge.sin);
}

}  // namespace
}  // namespace hardpack::sim
