// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"

#include <bit>
#include <cstdint>

namespace hardpack {
namespace {

// pi / 2 in three parts. The first two have at most 9 significant bits, so that their products with
// a quarter count of up to 13 bits are exact in float32, and the subtractions too: what is left
// shrinks as fast as its last bit does (Cody and Waite's reduction). The third is the rest,
// rounded.
constexpr float kHalfPiHigh = 1.5703125f;                // 201 / 2^7
constexpr float kHalfPiMiddle = 4.8351287841796875e-4f;  // 507 / 2^20
constexpr float kHalfPiLow = 3.1391647e-7f;              // pi / 2 - high - middle
constexpr float kQuartersPerRad = 0.63661977236758134308f;
constexpr float kTurnsPerRad = 0.15915494309189533577f;

// Adding this to a number below 2^22 leaves the nearest integer (ties to even) in the low bits of
// the sum; subtracting it again gives that integer as a float.
constexpr float kRoundingShift = 12582912.0f;  // 1.5 * 2^23

constexpr float kTanPiOver8 = 0.41421356237309504880f;
constexpr float kQuarterPi = 0.78539816339744830962f;

float ClampAngle(float angle_rad) {
  const float number = angle_rad == angle_rad ? angle_rad : 0.0f;
  return Clamp(number, -kSinCosMaxAngle_rad, kSinCosMaxAngle_rad);
}

float MinusQuarters(float angle_rad, float quarters) {
  return ((angle_rad - quarters * kHalfPiHigh) - quarters * kHalfPiMiddle) - quarters * kHalfPiLow;
}

// Taylor series; on [-pi/4, pi/4] the first terms left out are below 2e-9 and 3e-10.
float SinPolynomial(float x) {
  const float s = x * x;
  return x +
         x * s *
             (-1.0f / 6.0f + s * (1.0f / 120.0f + s * (-1.0f / 5040.0f + s * (1.0f / 362880.0f))));
}

float CosPolynomial(float x) {
  const float s = x * x;
  return 1.0f - 0.5f * s +
         s * s *
             (1.0f / 24.0f +
              s * (-1.0f / 720.0f + s * (1.0f / 40320.0f - s * (1.0f / 3628800.0f))));
}

// Interpolates (atan(x) / x - 1) / x^2 at the Chebyshev points of x^2 in [0, tan^2(pi/8)];
// the error of atan is below 1e-9 there.
float AtanPolynomial(float x) {
  const float s = x * x;
  return x + x * s *
                 (-0.3333333176116626f +
                  s * (0.19999540483500666f +
                       s * (-0.14263955595225897f +
                            s * (0.10743731471265837f + s * -0.06451928161206197f))));
}

// value, its sign changed where bit 1 of `flags` is set.
float FlipSign(float value, uint32_t flags) {
  return std::bit_cast<float>(std::bit_cast<uint32_t>(value) ^ ((flags & 2u) << 30));
}

}  // namespace

SinCosPair SinCos(float angle_rad) {
  const float angle = ClampAngle(angle_rad);
  const float shifted = angle * kQuartersPerRad + kRoundingShift;
  const uint32_t quarter = std::bit_cast<uint32_t>(shifted);  // its low bits
  const float rest_rad = MinusQuarters(angle, shifted - kRoundingShift);
  const float s = SinPolynomial(rest_rad);
  const float c = CosPolynomial(rest_rad);
  const bool odd = (quarter & 1u) != 0;
  return {FlipSign(odd ? c : s, quarter), FlipSign(odd ? s : c, quarter + 1u)};
}

float Sin(float angle_rad) {
  return SinCos(angle_rad).sin;
}
float Cos(float angle_rad) {
  return SinCos(angle_rad).cos;
}

float Atan2(float y, float x) {
  if (!IsFinite(x) || !IsFinite(y)) return 0.0f;
  const float ax = Abs(x);
  const float ay = Abs(y);
  const float high = Max(ax, ay);
  if (high == 0.0f) return 0.0f;
  const float ratio = Min(ax, ay) / high;  // [0, 1]
  float angle = ratio > kTanPiOver8 ? kQuarterPi + AtanPolynomial((ratio - 1.0f) / (ratio + 1.0f))
                                    : AtanPolynomial(ratio);
  if (ay > ax) angle = kHalfPi - angle;
  if (x < 0.0f) angle = kPi - angle;
  return y < 0.0f ? -angle : angle;
}

float WrapAngle(float angle_rad) {
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  const float angle = ClampAngle(angle_rad);
  const float turns = (angle * kTurnsPerRad + kRoundingShift) - kRoundingShift;
  const float wrapped = MinusQuarters(angle, 4.0f * turns);
  // Half a turn, give or take a rounding, may have come out on the wrong side.
  if (wrapped > kPi) return wrapped - kTwoPi;
  if (wrapped <= -kPi) return wrapped + kTwoPi;
  return wrapped;
}

}  // namespace hardpack
