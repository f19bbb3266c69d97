// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "config/parameters.h"

// The vehicle's outline and a cell's square for tests, in double, by edges and corners alone: no
// separating axes, as core/safety/outline.h has them, and no discs.

namespace hardpack {

struct TestPoint {
  double x = 0.0;
  double y = 0.0;
};

// Anticlockwise.
using Quad = std::array<TestPoint, 4>;

// The outline of a vehicle whose axle's centre is at x, y.
inline Quad OutlineQuad(const VehicleParams& vehicle, double x, double y, double theta_rad) {
  const double front = 0.5 * double{vehicle.length_m} - double{vehicle.axle_offset_m};
  const double rear = front - double{vehicle.length_m};
  const double half = 0.5 * double{vehicle.width_m};
  const double c = std::cos(theta_rad);
  const double s = std::sin(theta_rad);
  const auto at = [&](double ahead, double left) {
    return TestPoint{x + c * ahead - s * left, y + s * ahead + c * left};
  };
  return {at(rear, -half), at(front, -half), at(front, half), at(rear, half)};
}

inline Quad BoxQuad(double low_x, double low_y, double high_x, double high_y) {
  return {{{low_x, low_y}, {high_x, low_y}, {high_x, high_y}, {low_x, high_y}}};
}

inline bool IsInside(const Quad& quad, const TestPoint& p) {
  for (size_t i = 0; i < 4; ++i) {
    const TestPoint& a = quad[i];
    const TestPoint& b = quad[(i + 1) % 4];
    if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < 0.0) return false;
  }
  return true;
}

inline double ToSegment(const TestPoint& p, const TestPoint& a, const TestPoint& b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double share =
      std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(p.x - a.x - share * dx, p.y - a.y - share * dy);
}

inline bool Cross(const TestPoint& a, const TestPoint& b, const TestPoint& c, const TestPoint& d) {
  const auto side = [](const TestPoint& p, const TestPoint& q, const TestPoint& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  };
  return side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
}

// 0 where they overlap.
inline double DistanceBetween(const Quad& a, const Quad& b) {
  double nearest = 1e9;
  for (size_t i = 0; i < 4; ++i) {
    if (IsInside(a, b[i]) || IsInside(b, a[i])) return 0.0;
    for (size_t k = 0; k < 4; ++k) {
      const TestPoint& a0 = a[i];
      const TestPoint& a1 = a[(i + 1) % 4];
      const TestPoint& b0 = b[k];
      const TestPoint& b1 = b[(k + 1) % 4];
      if (Cross(a0, a1, b0, b1)) return 0.0;
      nearest = std::min({nearest, ToSegment(a0, b0, b1), ToSegment(b0, a0, a1)});
    }
  }
  return nearest;
}

}  // namespace hardpack
