// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tools/sim/world/portable_math.h"

// Uneven ground from random heights at the knots of a net, joined smoothly.

namespace hardpack::world {

// From 0 to 1, level at both ends.
inline double Eased(double share) {
  const double u = std::clamp(share, 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

// Between -1 and 1, drawn by key and net at each whole x and y. |x|, |y| < 100,000.
inline double HeightNet(uint64_t key, uint64_t net, double x, double y) {
  const auto knot = [key, net](double column, double row) {
    const auto across = static_cast<uint64_t>(static_cast<int64_t>(column) + 100'000);
    const auto up = static_cast<uint64_t>(static_cast<int64_t>(row) + 100'000);
    return 2.0 * DrawUniform(key, net << 40 | across << 20 | up) - 1.0;
  };
  const double column = std::floor(x);
  const double row = std::floor(y);
  const double u = Eased(x - column);
  const double v = Eased(y - row);
  const double low = knot(column, row) * (1.0 - u) + knot(column + 1.0, row) * u;
  const double high = knot(column, row + 1.0) * (1.0 - u) + knot(column + 1.0, row + 1.0) * u;
  return low * (1.0 - v) + high * v;
}

}  // namespace hardpack::world
