// SPDX-License-Identifier: Apache-2.0
#pragma once

// Elementary functions with bit-identical results on every processor and compiler, unlike libm.
// Built only from IEEE-754 single-precision +, -, *, / and sqrt, which are correctly rounded
// everywhere, in a fixed order, with no fused operations (-ffp-contract=off). They are meant for
// geometry: the stated and tested (test/core/base) errors are absolute.

namespace hardpack {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kTwoPi = 6.28318530717958647692f;
inline constexpr float kHalfPi = 1.57079632679489661923f;
inline constexpr float kRadPerDeg = 0.01745329251994329577f;

struct SinCosPair {
  float sin;
  float cos;
};

// Sine and cosine. Absolute error at most kSinCosMaxError for |angle_rad| <= kSinCosMaxAngle_rad.
// Larger angles, including infinite ones, are clamped to that magnitude, and NaN counts as 0:
// callers validate angles first. sin(-a) = -sin(a) and cos(-a) = cos(a), bit for bit.
inline constexpr float kSinCosMaxAngle_rad = 8192.0f;
inline constexpr float kSinCosMaxError = 9.5e-8f;
SinCosPair SinCos(float angle_rad);
float Sin(float angle_rad);
float Cos(float angle_rad);

// Angle of the vector (x, y), in [-pi, pi]; Atan2(0, 0) is 0. Error at most kAtan2MaxError_rad,
// including for subnormal and the largest arguments. Atan2(-y, x) = -Atan2(y, x), bit for bit; the
// sign of a zero is ignored. Arguments that are not finite give 0: callers validate first.
inline constexpr float kAtan2MaxError_rad = 3.0e-7f;
float Atan2(float y, float x);

// The same angle in (-kPi, kPi]: unchanged if it is already there; otherwise reduced by a multiple
// of 2 pi, with an error of at most kWrapAngleMaxError_rad for |angle_rad| <= kSinCosMaxAngle_rad.
// Larger angles and NaN as in SinCos.
inline constexpr float kWrapAngleMaxError_rad = 3.0e-7f;
float WrapAngle(float angle_rad);

// Square root; correctly rounded on every target. Negative or NaN gives 0: callers validate first.
// Inline: it is one instruction.
inline float Sqrt(float value) {
  return value > 0.0f ? __builtin_sqrtf(value) : 0.0f;
}

// The same for values that cannot be negative: no check, so that a surrounding loop can be
// vectorised. Negative or NaN gives NaN.
inline float SqrtUnchecked(float value) {
  return __builtin_sqrtf(value);
}

constexpr float Squared(float value) {
  return value * value;
}

// Clears the sign: one instruction, also for four values at once.
constexpr float Abs(float value) {
  return __builtin_fabsf(value);
}
constexpr float Min(float a, float b) {
  return b < a ? b : a;
}
constexpr float Max(float a, float b) {
  return a < b ? b : a;
}
constexpr float Clamp(float value, float low, float high) {
  return value < low ? low : (high < value ? high : value);
}

// True for every number except NaN and the infinities. Tests the bits, so that no compiler flag can
// remove it.
constexpr bool IsFinite(float value) {
  return (__builtin_bit_cast(unsigned, value) & 0x7f800000u) != 0x7f800000u;
}

}  // namespace hardpack
