// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/back_out.h"

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

constexpr Footprint kVehicle;
constexpr double kNose_m = kVehicle.length_m / 2.0;
constexpr double kThick_m = 0.3;
// What the vehicle may stand beside the alley's middle by.
constexpr double kAside_m = 0.12;

}  // namespace

void MakeBackOut(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "The start: nose first in a blind alley too narrow to turn in; the way out is behind.";
  Draws draws(seed, 1);
  const double width_m = draws.Uniform(kAlleyLeast_m, kAlleyMost_m);
  const double middle_y_m = draws.Uniform(-kAside_m, kAside_m);
  const double end_x_m = kNose_m + draws.Uniform(kAlleyEndLeast_m, kAlleyEndMost_m);
  const double open_x_m = -draws.Uniform(3.0, 14.0);
  const double height_m = draws.Uniform(0.8, 2.0);
  const double length_m = end_x_m - open_x_m + kThick_m;
  for (const double side : {-1.0, 1.0}) {
    const double y_m = middle_y_m + side * (width_m + kThick_m) / 2.0;
    AddBoxOnGround(scenario.world, {(end_x_m + kThick_m + open_x_m) / 2.0, y_m}, 0.0, length_m,
                   kThick_m, height_m, kWall);
  }
  AddBoxOnGround(scenario.world, {end_x_m + kThick_m / 2.0, middle_y_m}, kPi / 2.0,
                 width_m + 2.0 * kThick_m, kThick_m, height_m, kWall);
  // In every other seed beyond the closed end: out, and around the alley.
  const bool is_beyond = draws.Sign() > 0.0;
  const double x_m =
      is_beyond ? end_x_m + draws.Uniform(5.0, 10.0) : open_x_m - draws.Uniform(5.0, 10.0);
  scenario.goal = {x_m, draws.Uniform(-6.0, 6.0)};
}

}  // namespace hardpack::world
