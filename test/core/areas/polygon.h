// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <random>
#include <vector>

#include "core/areas/area.h"

// Polygons for the tests of areas, and what is true of them, in double.

namespace hardpack::testing {

struct Place {
  double x = 0.0;  // [m]
  double y = 0.0;
};

inline Area AreaOf(AreaKind kind, const std::vector<Place>& corners, float speed_mps = 0.0f) {
  Area area;
  area.kind = kind;
  area.speed_mps = speed_mps;
  for (const Place& corner : corners) {
    area.corner[area.corners].x_mm = static_cast<int32_t>(std::lround(1000.0 * corner.x));
    area.corner[area.corners].y_mm = static_cast<int32_t>(std::lround(1000.0 * corner.y));
    ++area.corners;
  }
  return area;
}

inline std::vector<Place> Box(double low_x, double low_y, double high_x, double high_y) {
  return {{low_x, low_y}, {high_x, low_y}, {high_x, high_y}, {low_x, high_y}};
}

inline std::vector<Place> CornersOf(const Area& area) {
  std::vector<Place> corners;
  for (int i = 0; i < area.corners; ++i) {
    corners.push_back({area.corner[i].x_mm / 1000.0, area.corner[i].y_mm / 1000.0});
  }
  return corners;
}

// A star about a middle: simple for any radii. Often concave.
inline Area RandomStar(std::mt19937& random, AreaKind kind, Place middle, double largest_m) {
  std::uniform_int_distribution<int> count(kMinAreaCorners, kMaxAreaCorners);
  std::uniform_real_distribution<double> share(0.15, 1.0);
  const int corners = count(random);
  std::vector<Place> places;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * M_PI * (i + 0.3 * share(random)) / corners;
    const double radius = largest_m * share(random);
    places.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
  }
  return AreaOf(kind, places);
}

// By the parity of crossings.
inline bool IsInside(const std::vector<Place>& corners, Place place) {
  bool inside = false;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Place& a = corners[i];
    const Place& b = corners[(i + 1) % corners.size()];
    if ((a.y > place.y) == (b.y > place.y)) continue;
    if (place.x < a.x + (place.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

// From a point to the segment from a to b.
inline double SegmentDistance(Place p, Place a, Place b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  const double along =
      length2 > 0.0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - along * dx, p.y - a.y - along * dy);
}

inline bool Cross(Place a, Place b, Place c, Place d) {
  const auto turn = [](Place p, Place q, Place r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  };
  return (turn(a, b, c) > 0.0) != (turn(a, b, d) > 0.0) &&
         (turn(c, d, a) > 0.0) != (turn(c, d, b) > 0.0);
}

// Distance between two closed borders; 0 where they cross. Neither may hold the other.
inline double BorderDistance(const std::vector<Place>& one, const std::vector<Place>& other) {
  double nearest = 1e9;
  for (size_t i = 0; i < one.size(); ++i) {
    const Place& a = one[i];
    const Place& b = one[(i + 1) % one.size()];
    for (size_t j = 0; j < other.size(); ++j) {
      const Place& c = other[j];
      const Place& d = other[(j + 1) % other.size()];
      if (Cross(a, b, c, d)) return 0.0;
      nearest = std::min({nearest, SegmentDistance(a, c, d), SegmentDistance(b, c, d),
                          SegmentDistance(c, a, b), SegmentDistance(d, a, b)});
    }
  }
  return nearest;
}

// How a convex shape lies to a polygon: distance from its border, and whether its first corner is
// inside.
struct TrueRelation {
  double border_m = 0.0;
  bool holds = false;      // the shape's first corner
  bool is_inside = false;  // the polygon's first corner is in the shape
};
inline TrueRelation RelationOf(const std::vector<Place>& polygon, const std::vector<Place>& shape) {
  return {BorderDistance(polygon, shape), IsInside(polygon, shape.front()),
          IsInside(shape, polygon.front())};
}

}  // namespace hardpack::testing
