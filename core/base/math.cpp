// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"

#include "core/base/saturate.h"

namespace hardpack {
namespace {

// pi / 2 in four parts of at most 10 significant bits (the last has 24), so that a quarter count of
// up to 14 bits times each of the first three is exact in float32 (Cody and Waite's reduction).
constexpr float kHalfPiPart1 = 1.5703125f;
constexpr float kHalfPiPart2 = 0.00048351287841796875f;
constexpr float kHalfPiPart3 = 3.1385570764541626e-07f;
constexpr float kHalfPiPart4 = 6.0766e-11f;
constexpr float kTwoOverPi = 0.63661977236758134308f;

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

constexpr float kTanPiOver8 = 0.41421356237309504880f;
constexpr float kQuarterPi = 0.78539816339744830962f;

}  // namespace

SinCosPair SinCos(float angle_rad) {
  if (!(angle_rad == angle_rad)) return {0.0f, 1.0f};
  const float angle = Clamp(angle_rad, -kSinCosMaxAngle_rad, kSinCosMaxAngle_rad);
  const int32_t quarter = RoundToInt(angle * kTwoOverPi);
  const float k = static_cast<float>(quarter);
  const float r =
      (((angle - k * kHalfPiPart1) - k * kHalfPiPart2) - k * kHalfPiPart3) - k * kHalfPiPart4;
  const float s = SinPolynomial(r);
  const float c = CosPolynomial(r);
  switch (static_cast<uint32_t>(quarter) & 3u) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
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
  float angle = angle_rad;
  if (!(Abs(angle) <= 3.0f * kPi)) {
    const SinCosPair pair = SinCos(angle_rad);
    return Atan2(pair.sin, pair.cos);
  }
  if (angle > kPi) angle -= kTwoPi;
  if (angle <= -kPi) angle += kTwoPi;
  return angle;
}

float Sqrt(float value) {
  return value > 0.0f ? __builtin_sqrtf(value) : 0.0f;
}

}  // namespace hardpack
