// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/math.h"

// The elementary functions against those of double, and where over a set of floats they are worst.
// The quick tests take samples, the slow ones every float of the range. Double's own errors are
// less than a hundred-millionth of the bounds.

namespace hardpack::exact {

// The largest error of a set of results, and the argument that gave it. A result that is not finite
// counts as an infinite error.
struct Worst {
  double error = -1.0;
  float at = 0.0f;

  void Take(double new_error, float argument) {
    const bool is_number = new_error == new_error;
    if (is_number && new_error <= error) return;
    error = is_number ? new_error : INFINITY;
    at = argument;
  }
  void Take(const Worst& other) {
    if (other.error > error) *this = other;
  }
};

// pair: SinCos(angle_rad).
inline void TakeSinCos(float angle_rad, const SinCosPair& pair, Worst& worst) {
  const double exact_rad = static_cast<double>(angle_rad);
  worst.Take(std::abs(static_cast<double>(pair.sin) - std::sin(exact_rad)), angle_rad);
  worst.Take(std::abs(static_cast<double>(pair.cos) - std::cos(exact_rad)), angle_rad);
}

inline void TakeSinCos(float angle_rad, Worst& worst) {
  TakeSinCos(angle_rad, SinCos(angle_rad), worst);
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
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  const double exact_rad = static_cast<double>(angle_rad);
  const double turns = std::round(exact_rad / kTurn_rad);
  const double difference =
      std::abs(static_cast<double>(WrapAngle(angle_rad)) - (exact_rad - kTurn_rad * turns));
  // The two ends of (-pi, pi] are the same direction.
  worst.Take(std::min(difference, std::abs(difference - kTurn_rad)), angle_rad);
}

inline float FromBits(uint32_t bits) {
  return std::bit_cast<float>(bits);
}
inline uint32_t BitsOf(float value) {
  return std::bit_cast<uint32_t>(value);
}

}  // namespace hardpack::exact
