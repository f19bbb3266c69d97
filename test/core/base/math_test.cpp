// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "gtest/gtest.h"
#include "test/core/base/exact_angles.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using exact::BitsOf;
using exact::FromBits;
using exact::Worst;

using RandomBits = std::independent_bits_engine<std::mt19937, 32, uint32_t>;

using testing::kInfinity;
using testing::kNaN;
constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();

// The float nearest to each multiple of pi / 4 up to the largest angle, and its neighbours: there
// the quarters change and the results are nearest to 0.
template <typename Visit>
void AroundEighthTurns(Visit visit) {
  constexpr uint32_t kNeighbours = 12;
  const int last = static_cast<int>(kSinCosMaxAngle_rad / (std::numbers::pi / 4));
  for (int eighth = 1; eighth <= last; ++eighth) {
    const uint32_t middle = BitsOf(static_cast<float>(eighth * (std::numbers::pi / 4)));
    for (uint32_t bits = middle - kNeighbours; bits <= middle + kNeighbours; ++bits) {
      const float angle_rad = FromBits(bits);
      if (angle_rad > kSinCosMaxAngle_rad) return;
      visit(angle_rad);
      visit(-angle_rad);
    }
  }
}

TEST(SinCos, IsWithinItsErrorOverTheWholeRange) {
  Worst worst;
  const uint32_t last = BitsOf(kSinCosMaxAngle_rad);
  for (uint32_t bits = 0; bits <= last; bits += 1009) exact::TakeSinCos(FromBits(bits), worst);
  exact::TakeSinCos(kSinCosMaxAngle_rad, worst);
  EXPECT_LE(worst.error, kSinCosMaxError) << "at " << worst.at;
}

TEST(SinCos, IsWithinItsErrorWhereQuartersChange) {
  Worst worst;
  AroundEighthTurns([&](float angle_rad) { exact::TakeSinCos(angle_rad, worst); });
  EXPECT_LE(worst.error, kSinCosMaxError) << "at " << worst.at;
}

TEST(SinCos, IsWithinItsErrorAtAnglesThatVehiclesTurn) {
  Worst worst;
  for (uint32_t bits = BitsOf(0.125f); bits <= BitsOf(8.0f); bits += 61) {
    exact::TakeSinCos(FromBits(bits), worst);
    exact::TakeSinCos(-FromBits(bits), worst);
  }
  EXPECT_LE(worst.error, kSinCosMaxError) << "at " << worst.at;
}

TEST(SinCos, SineIsOddAndCosineEven) {
  AroundEighthTurns([](float angle_rad) {
    const SinCosPair there = SinCos(angle_rad);
    const SinCosPair opposite = SinCos(-angle_rad);
    ASSERT_EQ(opposite.sin, -there.sin) << angle_rad;
    ASSERT_EQ(opposite.cos, there.cos) << angle_rad;
  });
}

TEST(SinCos, GivesTheQuartersTheirValues) {
  const SinCosPair zero = SinCos(0.0f);
  EXPECT_EQ(zero.sin, 0.0f);
  EXPECT_EQ(zero.cos, 1.0f);
  const SinCosPair quarter = SinCos(kHalfPi);
  EXPECT_EQ(quarter.sin, 1.0f);
  EXPECT_NEAR(quarter.cos, 0.0f, kSinCosMaxError);
  const SinCosPair half = SinCos(kPi);
  EXPECT_NEAR(half.sin, 0.0f, kSinCosMaxError);
  EXPECT_EQ(half.cos, -1.0f);
  const SinCosPair three_quarters = SinCos(-kHalfPi);
  EXPECT_EQ(three_quarters.sin, -1.0f);
  EXPECT_NEAR(three_quarters.cos, 0.0f, kSinCosMaxError);
}

TEST(SinCos, OfATinyAngleIsTheAngleItself) {
  for (const float angle_rad : {kSmallest, 1.0e-38f, 1.0e-20f, 1.0e-5f}) {
    EXPECT_EQ(Sin(angle_rad), angle_rad);
    EXPECT_EQ(Cos(angle_rad), 1.0f);
  }
}

TEST(SinCos, ClampsWhatIsTooLargeAndTakesNanAsZero) {
  const SinCosPair end = SinCos(kSinCosMaxAngle_rad);
  for (const float angle_rad : {8192.001f, 1.0e9f, kLargest, kInfinity}) {
    EXPECT_EQ(Sin(angle_rad), end.sin) << angle_rad;
    EXPECT_EQ(Cos(angle_rad), end.cos) << angle_rad;
    EXPECT_EQ(Sin(-angle_rad), -end.sin) << angle_rad;
  }
  EXPECT_EQ(Sin(kNaN), 0.0f);
  EXPECT_EQ(Cos(kNaN), 1.0f);
}

TEST(Atan2, IsWithinItsErrorForRatiosInAllOctants) {
  Worst worst;
  for (uint32_t bits = 0; bits <= BitsOf(1.0f); bits += 1013) {
    exact::TakeOctants(FromBits(bits), worst);
  }
  for (uint32_t bits = BitsOf(0.25f); bits <= BitsOf(1.0f); bits += 31) {
    exact::TakeOctants(FromBits(bits), worst);
  }
  exact::TakeOctants(1.0f, worst);
  EXPECT_LE(worst.error, kAtan2MaxError_rad) << "at " << worst.at;
}

long double Atan2Error(float y, float x) {
  const long double exact_rad =
      std::atan2(static_cast<long double>(y), static_cast<long double>(x));
  return std::abs(Atan2(y, x) - exact_rad);
}

// Any finite bit patterns: subnormals and the largest numbers are as likely as others.
TEST(Atan2, IsWithinItsErrorForAnyVector) {
  constexpr uint32_t kSeed = 20240611;
  RandomBits random(kSeed);
  for (int i = 0; i < 400000; ++i) {
    const float x = FromBits(random());
    const float y = FromBits(random());
    if (!IsFinite(x) || !IsFinite(y)) continue;
    ASSERT_LE(Atan2Error(y, x), kAtan2MaxError_rad) << "seed " << kSeed << ": " << y << ", " << x;
  }
}

TEST(Atan2, IsWithinItsErrorForVectorsOfAVehiclesSize) {
  constexpr uint32_t kSeed = 20240612;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(-60.0f, 60.0f);
  for (int i = 0; i < 400000; ++i) {
    const float x = coordinate(random);
    const float y = coordinate(random);
    ASSERT_LE(Atan2Error(y, x), kAtan2MaxError_rad) << "seed " << kSeed << ": " << y << ", " << x;
  }
}

// The quotient of the two underflows, or their sum overflows.
TEST(Atan2, IsWithinItsErrorAtTheEndsOfTheFloats) {
  const float ends[] = {kSmallest, 3 * kSmallest, 1.1754944e-38f, 1.0e-30f,
                        1.0f,      1.0e30f,       kLargest / 2,   FromBits(BitsOf(kLargest) - 1),
                        kLargest};
  for (const float x : ends) {
    for (const float y : ends) {
      EXPECT_LE(Atan2Error(y, x), kAtan2MaxError_rad) << y << ", " << x;
      EXPECT_LE(Atan2Error(-y, x), kAtan2MaxError_rad) << y << ", " << x;
      EXPECT_LE(Atan2Error(y, -x), kAtan2MaxError_rad) << y << ", " << x;
      EXPECT_LE(Atan2Error(-y, -x), kAtan2MaxError_rad) << y << ", " << x;
    }
  }
}

//        y
//   pi/2 |
//  pi ---+--- 0   x
//        | -pi/2
TEST(Atan2, GivesTheAxesTheirValues) {
  EXPECT_EQ(Atan2(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(Atan2(2.0f, 0.0f), kHalfPi);
  EXPECT_EQ(Atan2(0.0f, -2.0f), kPi);
  EXPECT_EQ(Atan2(-0.0f, -2.0f), kPi);
  EXPECT_EQ(Atan2(-2.0f, 0.0f), -kHalfPi);
  EXPECT_EQ(Atan2(0.0f, 0.0f), 0.0f);
}

TEST(Atan2, IsOddInY) {
  RandomBits random(7);
  for (int i = 0; i < 100000; ++i) {
    const float x = FromBits(random());
    const float y = FromBits(random());
    if (y == 0.0f) continue;
    ASSERT_EQ(Atan2(-y, x), -Atan2(y, x)) << y << ", " << x;
  }
}

TEST(Atan2, GivesZeroForWhatIsNotFinite) {
  for (const float bad : {kInfinity, -kInfinity, kNaN}) {
    EXPECT_EQ(Atan2(bad, 1.0f), 0.0f);
    EXPECT_EQ(Atan2(1.0f, bad), 0.0f);
    EXPECT_EQ(Atan2(bad, bad), 0.0f);
  }
}

TEST(WrapAngle, LeavesAnglesOfTheRangeAsTheyAre) {
  for (uint32_t bits = 0; bits <= BitsOf(kPi); bits += 1021) {
    const float angle_rad = FromBits(bits);
    ASSERT_EQ(WrapAngle(angle_rad), angle_rad);
    ASSERT_EQ(WrapAngle(-angle_rad), -angle_rad);
  }
  EXPECT_EQ(WrapAngle(kPi), kPi);
  EXPECT_EQ(WrapAngle(-kPi), kPi);
}

TEST(WrapAngle, IsWithinItsErrorAndItsRange) {
  Worst worst;
  const auto take = [&](float angle_rad) {
    exact::TakeWrap(angle_rad, worst);
    ASSERT_GT(WrapAngle(angle_rad), -kPi) << angle_rad;
    ASSERT_LE(WrapAngle(angle_rad), kPi) << angle_rad;
  };
  AroundEighthTurns(take);
  for (uint32_t bits = BitsOf(3.0f); bits <= BitsOf(kSinCosMaxAngle_rad); bits += 101) {
    take(FromBits(bits));
    take(-FromBits(bits));
  }
  EXPECT_LE(worst.error, kWrapAngleMaxError_rad) << "at " << worst.at;
}

TEST(WrapAngle, StaysInRangeForWhatIsTooLarge) {
  for (const float angle_rad : {8192.001f, 1.0e9f, kLargest, kInfinity}) {
    EXPECT_EQ(WrapAngle(angle_rad), WrapAngle(kSinCosMaxAngle_rad)) << angle_rad;
    EXPECT_EQ(WrapAngle(-angle_rad), WrapAngle(-kSinCosMaxAngle_rad)) << angle_rad;
  }
  EXPECT_EQ(WrapAngle(kNaN), 0.0f);
}

TEST(Sqrt, IsCorrectlyRounded) {
  for (uint32_t bits = 1; bits < BitsOf(kInfinity); bits += 1019) {
    const float value = FromBits(bits);
    // The double root of a float, rounded once more, is the float root (Figueroa, 1995).
    ASSERT_EQ(Sqrt(value), static_cast<float>(std::sqrt(static_cast<double>(value)))) << value;
  }
}

TEST(Sqrt, GivesZeroForNegativeNumbersAndNan) {
  EXPECT_EQ(Sqrt(0.0f), 0.0f);
  EXPECT_EQ(Sqrt(-1.0f), 0.0f);
  EXPECT_EQ(Sqrt(-kInfinity), 0.0f);
  EXPECT_EQ(Sqrt(kNaN), 0.0f);
  EXPECT_EQ(Sqrt(kInfinity), kInfinity);
}

TEST(IsFinite, IsFalseForInfinitiesAndNansOnly) {
  EXPECT_TRUE(IsFinite(0.0f));
  EXPECT_TRUE(IsFinite(-kLargest));
  EXPECT_TRUE(IsFinite(kSmallest));
  EXPECT_FALSE(IsFinite(kInfinity));
  EXPECT_FALSE(IsFinite(-kInfinity));
  EXPECT_FALSE(IsFinite(kNaN));
  EXPECT_FALSE(IsFinite(-kNaN));
  EXPECT_FALSE(IsFinite(std::numeric_limits<float>::signaling_NaN()));
}

TEST(Clamp, KeepsTheNearestEnd) {
  EXPECT_EQ(Clamp(-2.0f, -1.0f, 3.0f), -1.0f);
  EXPECT_EQ(Clamp(2.0f, -1.0f, 3.0f), 2.0f);
  EXPECT_EQ(Clamp(kInfinity, -1.0f, 3.0f), 3.0f);
  EXPECT_EQ(Min(1.0f, -1.0f), -1.0f);
  EXPECT_EQ(Max(1.0f, -1.0f), 1.0f);
  EXPECT_EQ(Abs(-1.5f), 1.5f);
  EXPECT_EQ(Abs(1.5f), 1.5f);
}

}  // namespace
}  // namespace hardpack
