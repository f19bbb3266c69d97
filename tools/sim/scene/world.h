// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

// A small off-road world of simple bodies for ray casting. It replaces a recording: the
// demonstration, the benchmarks and the tests need nothing but the project. Frame: odom, metres, z
// up; the vehicle stands at the origin, facing +x.

namespace hardpack::scene {

using Vector = std::array<double, 3>;

// Classes of the RELLIS-3D ontology, as recordings of the paper's vehicle are labelled.
enum Label : int {
  kVoid = 0,
  kGrass = 3,
  kTree = 4,
  kObject = 9,
  kBuilding = 12,
  kPerson = 17,
  kFence = 18,
  kBush = 19,
};

struct Box {
  Vector low;
  Vector high;
  Label label;
};

struct Cylinder {  // upright
  double x_m, y_m, radius_m;
  double low_m, high_m;
  Label label;
};

struct Sphere {
  Vector center;
  double radius_m;
  Label label;
  double share_seen = 1.0;  // of the rays that hit it; the others pass through the leaves
};

struct Hit {
  double distance_m = 0.0;
  Label label = kVoid;
};

struct World {
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  std::vector<Sphere> spheres;

  // Height of the ground: a slope of a few percent with gentle waves, 0 at the origin.
  static double Ground(double x_m, double y_m);

  // The first thing that the ray hits within reach_m. direction has length 1. luck, within 0 .. 1,
  // decides whether leaves stop it.
  std::optional<Hit> Cast(const Vector& origin, const Vector& direction, double reach_m,
                          double luck) const;
};

// The demonstration: a fence with a gap of 3.8 m, a bush beside it, trees, boxes, a hut and a
// person, and the mast on the vehicle's own rear deck.
World DemoWorld();

}  // namespace hardpack::scene
