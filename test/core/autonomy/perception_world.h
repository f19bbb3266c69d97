// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

// A world of simple bodies and a ray through it, in double precision and independent of core: what
// a lidar of the perception tests looks at. Odom frame, metres, seconds.

namespace hardpack::perception {

inline constexpr double kNothing = std::numeric_limits<double>::infinity();

using Random = std::mt19937_64;

struct Point {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

inline Point operator+(const Point& a, const Point& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Point operator-(const Point& a, const Point& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Point operator*(double s, const Point& a) {
  return {s * a.x, s * a.y, s * a.z};
}

struct Ray {
  Point origin;
  Point direction;  // length 1
};

// Codes of RELLIS-3D.
enum Code : uint8_t {
  kVoidCode = 0,
  kDirtCode = 1,
  kGrassCode = 3,
  kTreeCode = 4,
  kSkyCode = 7,
  kObjectCode = 9,
  kPersonCode = 17,
  kBushCode = 19,
};

struct Hit {
  double distance_m = kNothing;
  uint8_t code = kSkyCode;
};

// Where a ray is inside something; empty when enter >= exit.
struct Interval {
  double enter = 0.0;
  double exit = kNothing;

  void Keep(const Interval& other) {
    enter = std::max(enter, other.enter);
    exit = std::min(exit, other.exit);
  }
};

// Along one axis: low <= at + step t <= high.
inline Interval BetweenPlanes(double at, double step, double low, double high) {
  if (std::abs(step) < 1e-12) return at < low || at > high ? Interval{0.0, -1.0} : Interval{};
  const double t0 = (low - at) / step;
  const double t1 = (high - at) / step;
  return {std::min(t0, t1), std::max(t0, t1)};
}

// a t^2 + 2 b t + c <= 0.
inline Interval BetweenRoots(double a, double b, double c) {
  if (a < 1e-12) return c <= 0.0 ? Interval{} : Interval{0.0, -1.0};
  const double discriminant = b * b - a * c;
  if (discriminant <= 0.0) return {0.0, -1.0};
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

// A solid or porous thing, standing or walking.
struct Body {
  enum class Shape { kBox, kCylinder, kSphere };

  Shape shape = Shape::kBox;
  Point low;  // of its bounding box at time 0; a cylinder stands upright in it
  Point high;
  uint8_t code = kObjectCode;
  double free_path_m = 0.0;   // 0: solid; else rays get so deep into it on average
  Point velocity;             // [m/s]
  double until_s = kNothing;  // taken away then

  Point MiddleAt(double time_s) const { return 0.5 * (low + high) + time_s * velocity; }

  Interval Inside(const Ray& ray, double time_s) const {
    const Point from = ray.origin - MiddleAt(time_s);
    const Point half = 0.5 * (high - low);
    const Point& d = ray.direction;
    Interval inside;
    if (shape == Shape::kSphere) {
      const double b = from.x * d.x + from.y * d.y + from.z * d.z;
      const double c = from.x * from.x + from.y * from.y + from.z * from.z - half.x * half.x;
      inside.Keep(BetweenRoots(1.0, b, c));
      return inside;
    }
    inside.Keep(BetweenPlanes(from.z, d.z, -half.z, half.z));
    if (shape == Shape::kCylinder) {
      const double c = from.x * from.x + from.y * from.y - half.x * half.x;
      inside.Keep(BetweenRoots(d.x * d.x + d.y * d.y, from.x * d.x + from.y * d.y, c));
      return inside;
    }
    inside.Keep(BetweenPlanes(from.x, d.x, -half.x, half.x));
    inside.Keep(BetweenPlanes(from.y, d.y, -half.y, half.y));
    return inside;
  }
};

// Whether there is a leaf somewhere: a world of little cubes, of which a share is filled. The same
// place is always the same, as it is with leaves when there is no wind.
inline constexpr double kLeaf_m = 0.06;
inline bool IsLeaf(const Point& at, double free_path_m) {
  uint64_t key = 0;
  for (const double along : {at.x, at.y, at.z}) {
    const auto step = static_cast<int64_t>(std::floor(along / kLeaf_m));
    key = (key ^ static_cast<uint64_t>(step)) * 0x9e3779b97f4a7c15u;
    key ^= key >> 29;
  }
  key *= 0xbf58476d1ce4e5b9u;
  // A ray through a cube stays in it for two thirds of its side on average.
  const double filled = 1.0 - std::exp(-kLeaf_m * 2.0 / 3.0 / free_path_m);
  return static_cast<double>(key >> 11) * 0x1p-53 < filled;
}

// How far a ray gets into leaves; kNothing: through.
inline double ThroughLeaves(const Ray& ray, const Interval& inside, double free_path_m) {
  constexpr double kStep_m = 0.015;
  for (double at = inside.enter + 0.5 * kStep_m; at < inside.exit; at += kStep_m) {
    if (IsLeaf(ray.origin + at * ray.direction, free_path_m)) return at;
  }
  return kNothing;
}

inline Body Box(const Point& low, const Point& high, uint8_t code = kObjectCode) {
  Body body;
  body.low = low;
  body.high = high;
  body.code = code;
  return body;
}

inline Body Cylinder(double x, double y, double radius, double top, uint8_t code) {
  Body body = Box({x - radius, y - radius, 0.0}, {x + radius, y + radius, top}, code);
  body.shape = Body::Shape::kCylinder;
  return body;
}

// A sphere that rests on the ground, of leaves.
inline Body Bush(double x, double y, double height, double free_path) {
  const double r = 0.5 * height;
  Body body = Box({x - r, y - r, 0.0}, {x + r, y + r, height}, kBushCode);
  body.shape = Body::Shape::kSphere;
  body.free_path_m = free_path;
  return body;
}

inline Body Person(double x, double y, const Point& velocity) {
  Body body = Cylinder(x, y, 0.25, 1.8, kPersonCode);
  body.velocity = velocity;
  return body;
}

// Ground as a profile that is drawn along one direction: kinks, steps and walls, exactly.
class Ground {
 public:
  // (way along the direction, height), the way never falling; heading of the direction.
  Ground(std::vector<std::pair<double, double>> profile, double heading_rad)
      : profile_(std::move(profile)), cos_(std::cos(heading_rad)), sin_(std::sin(heading_rad)) {}

  static Ground Flat() { return Ground({{-1000.0, 0.0}, {1000.0, 0.0}}, 0.0); }

  double HeightAt(double x, double y) const {
    const double way = x * cos_ + y * sin_;
    for (size_t i = 1; i < profile_.size(); ++i) {
      const auto& [u0, z0] = profile_[i - 1];
      const auto& [u1, z1] = profile_[i];
      if (way < u1) return z0 + (z1 - z0) * (way - u0) / (u1 - u0);
    }
    return profile_.back().second;
  }

  double DistanceTo(const Ray& ray) const {
    const double u = ray.origin.x * cos_ + ray.origin.y * sin_;
    const double du = ray.direction.x * cos_ + ray.direction.y * sin_;
    const double dz = ray.direction.z;
    double nearest = kNothing;
    for (size_t i = 1; i < profile_.size(); ++i) {
      const double au = profile_[i - 1].first - u;
      const double az = profile_[i - 1].second - ray.origin.z;
      const double eu = profile_[i].first - profile_[i - 1].first;
      const double ez = profile_[i].second - profile_[i - 1].second;
      const double across = du * ez - dz * eu;
      if (std::abs(across) < 1e-12) continue;
      const double t = (au * ez - az * eu) / across;
      const double share = (au * dz - az * du) / across;
      if (t > 0.0 && share >= 0.0 && share <= 1.0) nearest = std::min(nearest, t);
    }
    return nearest;
  }

 private:
  std::vector<std::pair<double, double>> profile_;
  double cos_;
  double sin_;
};

struct World {
  Ground ground = Ground::Flat();
  std::vector<Body> bodies;
  double rain_share = 0.0;  // of the beams that end in a drop
  double rain_from_m = 1.0;
  double rain_to_m = 15.0;

  Hit Look(const Ray& ray, double time_s, Random& random) const {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    Hit nearest;
    nearest.distance_m = ground.DistanceTo(ray);
    if (nearest.distance_m < kNothing) nearest.code = kDirtCode;
    for (const Body& body : bodies) {
      if (time_s >= body.until_s) continue;
      const Interval inside = body.Inside(ray, time_s);
      if (inside.enter >= inside.exit || inside.enter >= nearest.distance_m) continue;
      const double at =
          body.free_path_m > 0.0 ? ThroughLeaves(ray, inside, body.free_path_m) : inside.enter;
      if (at < nearest.distance_m) nearest = {at, body.code};
    }
    if (rain_share > 0.0 && share(random) < rain_share) {
      const double drop = rain_from_m + (rain_to_m - rain_from_m) * share(random);
      if (drop < nearest.distance_m) nearest = {drop, kVoidCode};
    }
    return nearest;
  }
};

}  // namespace hardpack::perception
