// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/corner.h"

#include <cmath>

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

constexpr double kThick_m = 0.3;
constexpr double kHigh_m = 2.0;
constexpr double kBegin_m = -6.0;  // of the lane, which a wall closes there
constexpr double kLane_m = 22.0;   // from its middle behind the corner to its open end

struct Corner {
  double side = 1.0;    // to the left: 1
  double x_m = 0.0;     // of the middle of the lane behind it
  double half_m = 0.0;  // of its width
};

void AddWall(World& world, Point2 from, Point2 to) {
  const double length_x_m = to.x_m - from.x_m;
  const double length_y_m = to.y_m - from.y_m;
  const double length_m = std::abs(length_x_m) + std::abs(length_y_m);  // along one axis
  AddBoxOnGround(world, {(from.x_m + to.x_m) / 2.0, (from.y_m + to.y_m) / 2.0},
                 length_x_m == 0.0 ? kPi / 2.0 : 0.0, length_m, kThick_m, kHigh_m, kWall);
}

void AddWalls(World& world, const Corner& corner) {
  const double face_m = corner.half_m + kThick_m / 2.0;
  const double inner_x_m = corner.x_m - face_m;
  const double outer_x_m = corner.x_m + face_m;
  const double inner_y_m = corner.side * face_m;
  const double outer_y_m = -inner_y_m;
  const double end_y_m = corner.side * kLane_m;
  AddWall(world, {kBegin_m, inner_y_m}, {inner_x_m + kThick_m / 2.0, inner_y_m});
  AddWall(world, {kBegin_m, outer_y_m}, {outer_x_m + kThick_m / 2.0, outer_y_m});
  AddWall(world, {inner_x_m, inner_y_m}, {inner_x_m, end_y_m});
  AddWall(world, {outer_x_m, outer_y_m}, {outer_x_m, end_y_m});
  AddWall(world, {kBegin_m, inner_y_m}, {kBegin_m, outer_y_m});
}

Corner Begin(Draws& draws, Scenario& scenario) {
  const Corner corner = {draws.Sign(), draws.Uniform(14.0, 18.0), draws.Uniform(1.4, 1.7)};
  scenario.goal = {corner.x_m, corner.side * (kLane_m + 3.0)};
  return corner;
}

}  // namespace

void MakeCorner(uint64_t seed, Scenario& scenario) {
  scenario.description = "A lane between walls that turns by 90 degrees.";
  Draws draws(seed, 1);
  AddWalls(scenario.world, Begin(draws, scenario));
}

void MakeCornerDitch(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "A lane between walls that turns by 90 degrees, and a ditch behind the corner.";
  Draws draws(seed, 1);
  const Corner corner = Begin(draws, scenario);
  const double half_width_m = draws.Uniform(0.5, 0.9);
  // From where the inner wall's corner hides all of it to where some is seen from the corner.
  const double y_m = corner.side * (corner.half_m + half_width_m + draws.Uniform(0.0, 3.0));
  const double askew_m = draws.Uniform(-0.5, 0.5);
  const Ditch ditch = {{corner.x_m - 4.0, y_m - askew_m},
                       {corner.x_m + 4.0, y_m + askew_m},
                       half_width_m,
                       draws.Uniform(0.6, 1.2)};
  constexpr Bounds kBounds = {-30.0, -50.0, 60.0, 50.0};
  scenario.world = World(kBounds, Terrain(kBounds, [&](double place_x_m, double place_y_m) {
                           return -ditch.Depth_m(place_x_m, place_y_m);
                         }));
  scenario.world.AddDitch(ditch);
  AddWalls(scenario.world, corner);
}

}  // namespace hardpack::world
