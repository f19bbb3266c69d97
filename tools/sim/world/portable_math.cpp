// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/portable_math.h"

#include <bit>

#include "core/base/math.h"

namespace hardpack::world {
namespace {

// pi / 2 in two parts; the first has 33 significant bits, so that its products with a quarter count
// of up to 20 bits are exact.
constexpr double kHalfPiHigh = 1.57079632673412561417;
constexpr double kHalfPiLow = 6.07710050650619224932e-11;
constexpr double kRoundingShift = 6755399441055744.0;  // 1.5 * 2^52
constexpr double kLn2 = 0.69314718055994530942;

// Taylor series; on [-pi/4, pi/4] the first terms left out are below 1e-17.
double SinSeries(double x) {
  const double s = x * x;
  double sum = 1.0;
  for (int k = 17; k >= 3; k -= 2) sum = 1.0 - s / static_cast<double>(k * (k - 1)) * sum;
  return x * sum;
}
double CosSeries(double x) {
  const double s = x * x;
  double sum = 1.0;
  for (int k = 18; k >= 2; k -= 2) sum = 1.0 - s / static_cast<double>(k * (k - 1)) * sum;
  return sum;
}

}  // namespace

Turn TurnOf(double angle_rad) {
  if (!(std::abs(angle_rad) <= 1.0e5)) return {};
  const double quarters = (angle_rad * (2.0 / kPi) + kRoundingShift) - kRoundingShift;
  const double rest_rad = (angle_rad - quarters * kHalfPiHigh) - quarters * kHalfPiLow;
  const double c = CosSeries(rest_rad);
  const double s = SinSeries(rest_rad);
  switch (static_cast<int64_t>(quarters) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

// value = m 2^e with m in [sqrt(1/2), sqrt(2)); ln m = 2 atanh((m - 1) / (m + 1)).
double Log(double value) {
  if (!(value > 0.0)) return -1.0e300;
  const auto bits = std::bit_cast<uint64_t>(value);
  auto exponent = static_cast<double>(static_cast<int64_t>(bits >> 52) - 1023);
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffu) | 0x3ff0000000000000u);
  if (m > 1.41421356237309504880) {
    m *= 0.5;
    exponent += 1.0;
  }
  const double u = (m - 1.0) / (m + 1.0);
  const double s = u * u;
  double sum = 0.0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * s + 1.0 / static_cast<double>(k);
  return exponent * kLn2 + 2.0 * u * sum;
}

double Wrapped(double angle_rad) {
  if (!(std::abs(angle_rad) <= 1.0e6)) return 0.0;
  const double turns = (angle_rad / (2.0 * kPi) + kRoundingShift) - kRoundingShift;
  double wrapped = angle_rad - turns * (2.0 * kPi);
  if (wrapped > kPi) wrapped -= 2.0 * kPi;
  if (wrapped <= -kPi) wrapped += 2.0 * kPi;
  return wrapped;
}

double Angle(double y, double x) {
  return static_cast<double>(Atan2(static_cast<float>(y), static_cast<float>(x)));
}

Rotation Rotation::FromAngles(double roll_rad, double pitch_rad, double yaw_rad) {
  const Turn r = TurnOf(roll_rad);
  const Turn p = TurnOf(pitch_rad);
  const Turn y = TurnOf(yaw_rad);
  return {{y.cos * p.cos, y.cos * p.sin * r.sin - y.sin * r.cos,
           y.cos * p.sin * r.cos + y.sin * r.sin, y.sin * p.cos,
           y.sin * p.sin * r.sin + y.cos * r.cos, y.sin * p.sin * r.cos - y.cos * r.sin, -p.sin,
           p.cos * r.sin, p.cos * r.cos}};
}

double DrawNormal(uint64_t key, uint64_t index) {
  const uint64_t bits = DrawBits(key, index);
  const auto sum = static_cast<double>((bits & 0xffffu) + (bits >> 16 & 0xffffu) +
                                       (bits >> 32 & 0xffffu) + (bits >> 48));
  // Four uniform numbers have a variance of 4 / 12.
  return (sum / 65535.0 - 2.0) * 1.73205080756887729353;
}

}  // namespace hardpack::world
