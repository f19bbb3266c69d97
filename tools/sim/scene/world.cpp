// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/scene/world.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hardpack::scene {
namespace {

constexpr double kNear_m = 0.05;

// The nearest distance along the ray, or nothing.
using Distance = std::optional<double>;

// Slab method: the ray is inside the box while it is between all three pairs of planes.
Distance Meet(const Box& box, const Vector& origin, const Vector& direction) {
  double enter = kNear_m;
  double leave = 1.0e9;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1.0e-12) {
      if (origin[axis] < box.low[axis] || origin[axis] > box.high[axis]) return {};
      continue;
    }
    double first = (box.low[axis] - origin[axis]) / direction[axis];
    double second = (box.high[axis] - origin[axis]) / direction[axis];
    if (first > second) std::swap(first, second);
    enter = std::max(enter, first);
    leave = std::min(leave, second);
  }
  return enter <= leave && enter > kNear_m ? Distance(enter) : Distance();
}

// The smaller root of a t^2 + 2 b t + c = 0 that lies ahead.
Distance NearRoot(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (a < 1.0e-12 || discriminant < 0.0) return {};
  const double root = (-b - std::sqrt(discriminant)) / a;
  return root > kNear_m ? Distance(root) : Distance();
}

Distance Meet(const Cylinder& cylinder, const Vector& origin, const Vector& direction) {
  const double x_m = origin[0] - cylinder.x_m;
  const double y_m = origin[1] - cylinder.y_m;
  const Distance distance = NearRoot(direction[0] * direction[0] + direction[1] * direction[1],
                                     x_m * direction[0] + y_m * direction[1],
                                     x_m * x_m + y_m * y_m - cylinder.radius_m * cylinder.radius_m);
  if (!distance) return {};
  const double z_m = origin[2] + *distance * direction[2];
  return z_m >= cylinder.low_m && z_m <= cylinder.high_m ? distance : Distance();
}

Distance Meet(const Sphere& sphere, const Vector& origin, const Vector& direction) {
  double along = 0.0;
  double square = -sphere.radius_m * sphere.radius_m;
  for (size_t axis = 0; axis < 3; ++axis) {
    const double offset = origin[axis] - sphere.center[axis];
    along += offset * direction[axis];
    square += offset * offset;
  }
  return NearRoot(1.0, along, square);
}

// The ground has no closed form: walk until below it, then halve.
Distance MeetGround(const Vector& origin, const Vector& direction, double reach_m) {
  const auto above_m = [&](double t) {
    return origin[2] + t * direction[2] -
           World::Ground(origin[0] + t * direction[0], origin[1] + t * direction[1]);
  };
  constexpr double kStride_m = 0.5;
  constexpr int kHalvings = 24;
  for (double far = kStride_m; far <= reach_m; far += kStride_m) {
    if (above_m(far) > 0.0) continue;
    double near = far - kStride_m;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (near + far) / 2.0;
      (above_m(middle) > 0.0 ? near : far) = middle;
    }
    return near;
  }
  return {};
}

void Take(const Distance& distance, Label label, std::optional<Hit>& nearest) {
  if (distance && (!nearest || *distance < nearest->distance_m)) nearest = Hit{*distance, label};
}

void AddTree(World& world, double x_m, double y_m, double trunk_radius_m, double crown_radius_m) {
  const double ground_m = World::Ground(x_m, y_m);
  const double crown_m = ground_m + 2.4 + crown_radius_m;
  world.cylinders.push_back({x_m, y_m, trunk_radius_m, ground_m - 0.5, crown_m, kTree});
  world.spheres.push_back({{x_m, y_m, crown_m}, crown_radius_m, kTree, 0.6});
}

void AddBush(World& world, double x_m, double y_m, double radius_m) {
  world.spheres.push_back(
      {{x_m, y_m, World::Ground(x_m, y_m) + 0.3 * radius_m}, radius_m, kBush, 0.7});
}

void AddBox(World& world, double x_m, double y_m, const Vector& size_m, Label label) {
  const double ground_m = World::Ground(x_m, y_m);
  world.boxes.push_back({{x_m - size_m[0] / 2.0, y_m - size_m[1] / 2.0, ground_m - 0.5},
                         {x_m + size_m[0] / 2.0, y_m + size_m[1] / 2.0, ground_m + size_m[2]},
                         label});
}

// Boards along y at x_m, in pieces, so that it follows the ground.
void AddFence(World& world, double x_m, double from_y_m, double to_y_m) {
  constexpr double kPiece_m = 1.0;
  for (double y_m = from_y_m; y_m < to_y_m - 1.0e-9; y_m += kPiece_m) {
    const double piece_m = std::min(kPiece_m, to_y_m - y_m);
    AddBox(world, x_m, y_m + piece_m / 2.0, {0.08, piece_m, 1.3}, kFence);
  }
}

}  // namespace

double World::Ground(double x_m, double y_m) {
  return 0.03 * x_m + 0.35 * std::sin(0.12 * x_m) * std::cos(0.10 * y_m) -
         0.20 * std::sin(0.15 * y_m);
}

std::optional<Hit> World::Cast(const Vector& origin, const Vector& direction, double reach_m,
                               double luck) const {
  std::optional<Hit> nearest;
  Take(MeetGround(origin, direction, reach_m), kGrass, nearest);
  for (const Box& box : boxes) Take(Meet(box, origin, direction), box.label, nearest);
  for (const Cylinder& cylinder : cylinders) {
    Take(Meet(cylinder, origin, direction), cylinder.label, nearest);
  }
  for (const Sphere& sphere : spheres) {
    if (luck < sphere.share_seen) Take(Meet(sphere, origin, direction), sphere.label, nearest);
  }
  return nearest && nearest->distance_m <= reach_m ? nearest : std::nullopt;
}

World DemoWorld() {
  World world;
  AddFence(world, 13.0, -14.0, 2.2);
  AddFence(world, 13.0, 6.0, 16.0);
  AddBush(world, 8.5, 0.6, 1.0);
  AddBush(world, 18.5, 6.6, 1.2);
  AddBush(world, -6.0, -7.0, 1.3);
  AddBox(world, 19.0, -1.0, {2.2, 4.6, 1.5}, kObject);  // a boat on its trailer, say
  AddBox(world, 6.5, -4.5, {1.2, 1.2, 0.9}, kObject);
  AddBox(world, -9.0, 11.0, {5.0, 4.0, 3.0}, kBuilding);
  for (const auto& [x_m, y_m] : {std::pair{10.0, 10.5},
                                 {17.5, 11.0},
                                 {24.0, -6.0},
                                 {25.5, 8.0},
                                 {3.0, -11.0},
                                 {-3.5, 8.0},
                                 {-12.0, -3.0},
                                 {28.0, 0.5}}) {
    AddTree(world, x_m, y_m, 0.18, 1.5);
  }
  const double person_ground_m = World::Ground(6.0, 9.0);
  world.cylinders.push_back(
      {6.0, 9.0, 0.22, person_ground_m - 0.1, person_ground_m + 1.55, kPerson});
  world.spheres.push_back({{6.0, 9.0, person_ground_m + 1.66}, 0.13, kPerson});
  world.boxes.push_back({{-0.75, -0.25, 0.9}, {-0.55, 0.25, 1.75}, kVoid});  // the vehicle's mast
  return world;
}

}  // namespace hardpack::scene
