// SPDX-License-Identifier: Apache-2.0
#pragma once

// Sine and cosine in double precision that give the same bits on every processor, which libm's do
// not. Built only from IEEE-754 +, -, *, / and sqrt, in a fixed order, never fused
// (-ffp-contract=off). The error relative to libm's is stated and tested (test/tools/sim).
// (core/base/math.h is the same in single precision.)

namespace hardpack::sim {

struct SinCosOf {
  double sin = 0.0;
  double cos = 1.0;
};

// Absolute error at most kExactSinCosMaxError for |angle_rad| <= kExactSinCosMaxAngle_rad; larger
// angles are clamped to that magnitude, NaN gives NaN. The sine is odd and the cosine even, bit for
// bit.
inline constexpr double kExactSinCosMaxAngle_rad = 1.0e5;
inline constexpr double kExactSinCosMaxError = 1.0e-15;
SinCosOf ExactSinCos(double angle_rad);

}  // namespace hardpack::sim
