// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/features.h"

#include <array>

namespace hardpack::world {
namespace {

constexpr double kRoots_m = 0.5;  // how far things reach into the ground

double GroundAt(const World& world, const Point2& place) {
  return world.GroundHeight_m(place.x_m, place.y_m);
}

}  // namespace

void AddBoxOnGround(World& world, Point2 middle, double heading_rad, double length_m,
                    double width_m, double height_m, const Material& material) {
  const double ground_m = GroundAt(world, middle);
  world.AddBox(middle, heading_rad, length_m, width_m, ground_m - kRoots_m, ground_m + height_m,
               material);
}

void AddTree(World& world, Point2 place, double trunk_radius_m, double crown_radius_m) {
  const double ground_m = GroundAt(world, place);
  const double crown_m = ground_m + 2.4 + 1.3 * crown_radius_m;
  world.AddCylinder(place, trunk_radius_m, ground_m - kRoots_m, crown_m, kHardWood);
  world.AddEllipsoid({place.x_m, place.y_m, crown_m}, crown_radius_m, 1.3 * crown_radius_m,
                     kLeaves);
}

void AddBush(World& world, Point2 place, double radius_m, double height_m) {
  // The widest part lies a third up.
  const double ground_m = GroundAt(world, place);
  world.AddEllipsoid({place.x_m, place.y_m, ground_m + height_m / 3.0}, radius_m,
                     height_m * 2.0 / 3.0, kBushLeaves);
}

void AddFence(World& world, Point2 from, Point2 to) {
  constexpr double kPostRadius_m = 0.05;
  constexpr double kHeight_m = 1.3;
  constexpr double kThickness_m = 0.02;
  constexpr double kApart_m = 2.5;
  const double x_m = to.x_m - from.x_m;
  const double y_m = to.y_m - from.y_m;
  const double length_m = std::sqrt(x_m * x_m + y_m * y_m);
  const int fields = static_cast<int>(std::ceil((length_m - 2.0 * kPostRadius_m) / kApart_m));
  const auto place = [&](double post) {
    const double along_m = kPostRadius_m + (length_m - 2.0 * kPostRadius_m) * post / fields;
    return Point2{from.x_m + x_m * along_m / length_m, from.y_m + y_m * along_m / length_m};
  };
  for (int post = 0; post <= fields; ++post) {
    const double ground_m = GroundAt(world, place(post));
    world.AddCylinder(place(post), kPostRadius_m, ground_m - kRoots_m, ground_m + kHeight_m + 0.1,
                      kPost);
  }
  const double heading_rad = Angle(y_m, x_m);
  for (int field = 0; field < fields; ++field) {
    const Point2 middle = place(field + 0.5);
    const double ground_m = GroundAt(world, middle);
    world.AddBox(middle, heading_rad, (length_m - 2.0 * kPostRadius_m) / fields, kThickness_m,
                 ground_m, ground_m + kHeight_m, kWireMesh);
  }
}

void AddBoat(World& world, Point2 middle, double heading_rad) {
  const Turn turn = TurnOf(heading_rad);
  const double ground_m = GroundAt(world, middle);
  const auto at = [&](double along_m, double left_m) {
    return Point2{middle.x_m + turn.cos * along_m - turn.sin * left_m,
                  middle.y_m + turn.sin * along_m + turn.cos * left_m};
  };
  const auto add_hull = [&](double half_width_m, double stern_m, double bow_m, double low_m,
                            double high_m) {
    const std::array<Point2, 6> outline = {at(stern_m, -half_width_m), at(0.8, -half_width_m),
                                           at(bow_m, -0.25),           at(bow_m, 0.25),
                                           at(0.8, half_width_m),      at(stern_m, half_width_m)};
    world.AddPrism(outline, ground_m + low_m, ground_m + high_m, kThing);
  };
  constexpr double kHalfLength_m = kBoatLength_m / 2.0;
  add_hull(1.1, -kHalfLength_m, kHalfLength_m, 0.9, 1.7);
  add_hull(0.8, -kHalfLength_m + 0.1, kHalfLength_m - 0.4, 0.5, 0.9);
  world.AddBox(at(-0.6, 0.0), heading_rad, 0.9, 1.3, ground_m + 1.7, ground_m + 2.3, kThing);
  world.AddBox(at(0.6, 0.0), heading_rad, 5.6, 0.12, ground_m + 0.35, ground_m + 0.5, kThing);
  for (const double left_m : {-0.85, 0.85}) {
    world.AddBox(at(-0.7, left_m), heading_rad, 0.65, 0.2, ground_m - kRoots_m, ground_m + 0.65,
                 kThing);
  }
}

void AddRockPile(World& world, Point2 middle, double core_m, double skirt_m, double height_m,
                 Draws& draws) {
  constexpr double kSkirtHeight_m = 0.7;
  const double ground_m = GroundAt(world, middle);
  const auto place_at = [&](double distance_m, double angle_rad) {
    const Turn turn = TurnOf(angle_rad);
    return Point2{middle.x_m + distance_m * turn.cos, middle.y_m + distance_m * turn.sin};
  };
  world.AddEllipsoid({middle.x_m, middle.y_m, ground_m}, 0.65 * core_m, height_m, kRock);
  // Boulders in rings, lower outward; none reaches beyond core_m.
  for (const double share : {0.35, 0.7, 0.97}) {
    const int count = static_cast<int>(2.0 * kPi * share * core_m / 1.1);
    for (int i = 0; i < count; ++i) {
      const double radius_m = draws.Uniform(0.45, 0.8);
      const double ring_m = (core_m - radius_m) * share;
      const Point2 place = place_at(ring_m, 2.0 * kPi * (i + draws.Uniform(-0.3, 0.3)) / count);
      const double top_m = height_m * (1.0 - 0.55 * share) * draws.Uniform(0.8, 1.0);
      world.AddEllipsoid({place.x_m, place.y_m, GroundAt(world, place) + top_m / 2.0}, radius_m,
                         top_m / 2.0 + 0.15, kRock);
    }
  }
  const double ring_m = (core_m + skirt_m) / 2.0;
  const double half_m = (skirt_m - core_m) / 2.0;
  const int count = static_cast<int>(2.0 * kPi * ring_m / half_m);
  for (int i = 0; i < count; ++i) {
    const Point2 place = place_at(ring_m + draws.Uniform(-0.15, 0.0), 2.0 * kPi * i / count);
    const double bush_m = kSkirtHeight_m * draws.Uniform(0.9, 1.2);
    AddBush(world, place, half_m * draws.Uniform(0.9, 1.1), bush_m);
  }
}

}  // namespace hardpack::world
