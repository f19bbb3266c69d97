// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/exact_math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hardpack::sim {
namespace {

// Half of pi in parts, so that a small multiple of the first has no rounding error ([CW]).
constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
constexpr double kHalfPiMiddle = 6.07710050630396597660e-11;
constexpr double kHalfPiLow = 2.02226624871116645580e-21;

constexpr size_t kFactorials = 20;
constexpr std::array<double, kFactorials> InverseFactorials() {
  std::array<double, kFactorials> values = {};
  double factorial = 1.0;
  for (size_t i = 0; i < kFactorials; ++i) {
    if (i > 0) factorial *= static_cast<double>(i);
    values[i] = 1.0 / factorial;
  }
  return values;
}
constexpr std::array<double, kFactorials> kInverseFactorial = InverseFactorials();

// The nearest whole number; of |value| < 2^51.
double Nearest(double value) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52
  return value + kShift - kShift;
}

// Series in r^2 from the term of power `last` down to that of `first`, both even or both odd, with
// alternating signs, without the factor r^first.
double AlternatingSeries(double r2, size_t first, size_t last) {
  double sum = kInverseFactorial[last];
  for (size_t power = last; power > first; power -= 2) {
    sum = kInverseFactorial[power - 2] - r2 * sum;
  }
  return sum;
}

}  // namespace

SinCosOf ExactSinCos(double angle_rad) {
  constexpr double kQuartersPerRad = 0.63661977236758134308;
  const double magnitude = std::min(std::abs(angle_rad), kExactSinCosMaxAngle_rad);
  if (std::isnan(angle_rad)) return {angle_rad, angle_rad};
  const double quarters = Nearest(magnitude * kQuartersPerRad);
  const double r =
      ((magnitude - quarters * kHalfPiHigh) - quarters * kHalfPiMiddle) - quarters * kHalfPiLow;
  const double r2 = r * r;
  const double sine = r - r * r2 * AlternatingSeries(r2, 3, 17);
  const double cosine = 1.0 - r2 * AlternatingSeries(r2, 2, 18);
  SinCosOf result;
  switch (static_cast<int64_t>(quarters) & 3) {
    case 0:
      result = {sine, cosine};
      break;
    case 1:
      result = {cosine, -sine};
      break;
    case 2:
      result = {-sine, -cosine};
      break;
    default:
      result = {-cosine, sine};
      break;
  }
  if (std::signbit(angle_rad)) result.sin = -result.sin;
  return result;
}

}  // namespace hardpack::sim
