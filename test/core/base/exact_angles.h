// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/math.h"

// The elementary functions against wider ones, and where over a set of floats they are worst. The
// quick tests take samples, the slow ones every float of the range.

namespace hardpack::exact {

inline constexpr long double kPi = std::numbers::pi_v<long double>;

// The largest error of a set of results, and the argument that gave it. A result that is not finite
// counts as an infinite error.
struct Worst {
  long double error = -1.0L;
  float at = 0.0f;

  void Take(long double new_error, float argument) {
    const bool is_number = new_error == new_error;
    if (is_number && new_error <= error) return;
    error = is_number ? new_error : INFINITY;
    at = argument;
  }
  void Take(const Worst& other) {
    if (other.error > error) *this = other;
  }
};

// Against double, whose own error of 2^-53 is less than a hundred-millionth of the bounds: long
// double takes longer, and there are two thousand million angles.
inline void TakeSinCos(float angle_rad, Worst& worst) {
  const SinCosPair pair = SinCos(angle_rad);
  const double exact_rad = static_cast<double>(angle_rad);
  worst.Take(std::abs(static_cast<double>(pair.sin) - std::sin(exact_rad)), angle_rad);
  worst.Take(std::abs(static_cast<double>(pair.cos) - std::cos(exact_rad)), angle_rad);
}

// One ratio of [0, 1] in the four octants of the upper half plane: there the quotient inside Atan2
// is the ratio itself.
inline void TakeOctants(float ratio, Worst& worst) {
  constexpr double kHalfTurn_rad = std::numbers::pi;
  const double angle_rad = std::atan(static_cast<double>(ratio));
  const auto take = [&](float result_rad, double exact_rad) {
    worst.Take(std::abs(static_cast<double>(result_rad) - exact_rad), ratio);
  };
  take(Atan2(ratio, 1.0f), angle_rad);
  take(Atan2(1.0f, ratio), kHalfTurn_rad / 2 - angle_rad);
  take(Atan2(ratio, -1.0f), ratio > 0.0f ? kHalfTurn_rad - angle_rad : kHalfTurn_rad);
  take(Atan2(1.0f, -ratio), kHalfTurn_rad / 2 + angle_rad);
}

inline void TakeWrap(float angle_rad, Worst& worst) {
  const long double exact_rad = angle_rad;
  const long double turns = std::round(exact_rad / (2 * kPi));
  const long double difference = std::abs(WrapAngle(angle_rad) - (exact_rad - 2 * kPi * turns));
  // The two ends of (-pi, pi] are the same direction.
  worst.Take(std::min(difference, std::abs(difference - 2 * kPi)), angle_rad);
}

inline float FromBits(uint32_t bits) {
  return std::bit_cast<float>(bits);
}
inline uint32_t BitsOf(float value) {
  return std::bit_cast<uint32_t>(value);
}

}  // namespace hardpack::exact
