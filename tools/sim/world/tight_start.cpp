// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/tight_start.h"

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

constexpr Footprint kVehicle;
constexpr double kFlank_m = kVehicle.width_m / 2.0;
constexpr double kNose_m = kVehicle.length_m / 2.0;

// A wall along the flank, which may open ahead by up to 10 degrees. Its inner face is aside_m from
// the flank at the nearest point: at the tail if it opens.
void AddWallBeside(World& world, double side, double aside_m, Draws& draws) {
  constexpr double kThick_m = 0.4;
  const double tail_m = draws.Uniform(-6.0, -1.0);
  const double end_m = draws.Uniform(0.0, 6.0);
  const double opens_rad = draws.Sign() > 0.0 ? draws.Uniform(0.0, 10.0) * kPi / 180.0 : 0.0;
  // The nearest point of the face, beside the vehicle's tail. From there it runs both ways; behind
  // the tail only so far that it does not enter the vehicle's own strip.
  const Turn turn = TurnOf(opens_rad);
  const double behind_m =
      opens_rad > 0.0 ? 0.0 : tail_m + kNose_m;  // along the wall, from the tail
  const double ahead_m = (end_m + kNose_m) / turn.cos;
  const double along_m = (behind_m + ahead_m) / 2.0;
  const double left_m = kFlank_m + aside_m;
  const Point2 middle = {-kNose_m + turn.cos * along_m - turn.sin * kThick_m / 2.0,
                         left_m + turn.sin * along_m + turn.cos * kThick_m / 2.0};
  AddBoxOnGround(world, {middle.x_m, side * middle.y_m}, side * opens_rad, ahead_m - behind_m,
                 kThick_m, draws.Uniform(0.8, 2.0), kWall);
}

void AddPostsBeside(World& world, double side, double aside_m, Draws& draws) {
  const auto posts = static_cast<int>(draws.Uniform(1.0, 4.0));
  for (int i = 0; i < posts; ++i) {
    const double radius_m = draws.Uniform(0.05, 0.3);
    const double x_m = draws.Uniform(-kNose_m, kNose_m);
    // The first one is as near as was drawn.
    const double more_m = i == 0 ? 0.0 : draws.Uniform(0.0, 0.4);
    world.AddCylinder({x_m, side * (kFlank_m + aside_m + more_m + radius_m)}, radius_m, -0.5,
                      draws.Uniform(0.8, 1.8), kPost);
  }
}

void AddBoxBeside(World& world, double side, double aside_m, Draws& draws) {
  const double length_m = draws.Uniform(0.3, 2.0);
  const double width_m = draws.Uniform(0.3, 1.5);
  const double x_m = draws.Uniform(-kNose_m - length_m / 3.0, kNose_m + length_m / 3.0);
  AddBoxOnGround(world, {x_m, side * (kFlank_m + aside_m + width_m / 2.0)}, 0.0, length_m, width_m,
                 draws.Uniform(0.8, 1.8), kThing);
}

void AddBeside(World& world, double side, Draws& draws) {
  const double aside_m = draws.Uniform(kTightLeast_m, kTightMost_m);
  const double kind = draws.Uniform(0.0, 3.0);
  if (kind < 1.0) {
    AddWallBeside(world, side, aside_m, draws);
  } else if (kind < 2.0) {
    AddPostsBeside(world, side, aside_m, draws);
  } else {
    AddBoxBeside(world, side, aside_m, draws);
  }
}

}  // namespace

void MakeTightStart(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "The start: a wall, a box or posts close beside the vehicle; the way ahead is free.";
  Draws draws(seed, 1);
  const double goal_x_m = draws.Uniform(15.0, 25.0);
  scenario.goal = {goal_x_m, draws.Uniform(-6.0, 6.0)};
  const double side = draws.Sign();
  AddBeside(scenario.world, side, draws);
  const bool is_on_both = draws.Uniform(0.0, 3.0) < 1.0;
  if (is_on_both) AddBeside(scenario.world, -side, draws);
}

}  // namespace hardpack::world
