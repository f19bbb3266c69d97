// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/portable_math.h"

#include <cmath>
#include <limits>

#include "gtest/gtest.h"

namespace hardpack::world {
namespace {

TEST(PortableMath, TurnsAsLibmDoes) {
  for (int i = -200'000; i <= 200'000; ++i) {
    const double angle_rad = 0.000731 * i;
    const Turn turn = TurnOf(angle_rad);
    ASSERT_NEAR(turn.cos, std::cos(angle_rad), 2.0e-15) << angle_rad;
    ASSERT_NEAR(turn.sin, std::sin(angle_rad), 2.0e-15) << angle_rad;
  }
}

TEST(PortableMath, MakesNothingOfAnglesThatAreNone) {
  for (const double angle_rad : {std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity(), -1.0e6}) {
    EXPECT_EQ(TurnOf(angle_rad).cos, 1.0);
    EXPECT_EQ(TurnOf(angle_rad).sin, 0.0);
  }
}

TEST(PortableMath, TakesLogarithms) {
  for (double value = 1.0e-16; value < 1.0e6; value *= 1.0137) {
    ASSERT_NEAR(Log(value), std::log(value), 1.0e-15 * (1.0 + std::abs(std::log(value)))) << value;
  }
  EXPECT_EQ(Log(1.0), 0.0);
  EXPECT_LT(Log(0.0), -1.0e200);
}

TEST(PortableMath, WrapsToHalfATurn) {
  for (const double angle_rad : {0.0, 3.1, -3.1, 3.2, -3.2, 100.0, -12345.6}) {
    EXPECT_NEAR(Wrapped(angle_rad), std::remainder(angle_rad, 2.0 * M_PI), 1.0e-9) << angle_rad;
  }
}

// Rz(yaw) Ry(pitch) Rx(roll): pitch lowers the front, roll raises the left.
TEST(PortableMath, RotatesAsTheFramesSay) {
  const Vector front = Rotation::FromAngles(0.0, 0.1, 0.0).Apply({1.0, 0.0, 0.0});
  EXPECT_NEAR(front.z_m, -std::sin(0.1), 1.0e-15);
  const Vector left = Rotation::FromAngles(0.1, 0.0, 0.0).Apply({0.0, 1.0, 0.0});
  EXPECT_NEAR(left.z_m, std::sin(0.1), 1.0e-15);
  const Vector ahead = Rotation::FromAngles(0.2, 0.0, M_PI / 2.0).Apply({1.0, 0.0, 0.0});
  EXPECT_NEAR(ahead.y_m, 1.0, 1.0e-15);
}

TEST(PortableMath, DrawsEvenlyAndNormally) {
  constexpr int kDraws = 100'000;
  const uint64_t key = KeyOf(7, Stream::kRange);
  double sum = 0.0, squares = 0.0, normal_sum = 0.0, normal_squares = 0.0;
  for (uint64_t i = 0; i < kDraws; ++i) {
    const double even = DrawUniform(key, i);
    ASSERT_GE(even, 0.0);
    ASSERT_LT(even, 1.0);
    sum += even;
    squares += even * even;
    const double normal = DrawNormal(key, i);
    normal_sum += normal;
    normal_squares += normal * normal;
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 0.004);
  EXPECT_NEAR(squares / kDraws, 1.0 / 3.0, 0.004);
  EXPECT_NEAR(normal_sum / kDraws, 0.0, 0.013);
  EXPECT_NEAR(normal_squares / kDraws, 1.0, 0.02);
}

TEST(PortableMath, DrawsTheSameForTheSameKeyOnly) {
  EXPECT_EQ(DrawBits(KeyOf(1, Stream::kIns), 5), DrawBits(KeyOf(1, Stream::kIns), 5));
  EXPECT_NE(DrawBits(KeyOf(1, Stream::kIns), 5), DrawBits(KeyOf(2, Stream::kIns), 5));
  EXPECT_NE(DrawBits(KeyOf(1, Stream::kIns), 5), DrawBits(KeyOf(1, Stream::kRange), 5));
  EXPECT_NE(DrawBits(KeyOf(1, Stream::kIns), 5), DrawBits(KeyOf(1, Stream::kIns), 6));
}

}  // namespace
}  // namespace hardpack::world
