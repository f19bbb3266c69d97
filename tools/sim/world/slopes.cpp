// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/slopes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/sim/world/features.h"
#include "tools/sim/world/height_net.h"

namespace hardpack::world {
namespace {

constexpr Bounds kBounds = {-30.0, -50.0, 90.0, 50.0};

double TanOf(double angle_deg) {
  const Turn turn = TurnOf(angle_deg * kPi / 180.0);
  return turn.sin / turn.cos;
}

// Height on a slope that begins at 0 and is `length_m` long, its two edges rounded over 1 m each.
double Ramp_m(double along_m, double length_m, double steep) {
  constexpr double kRound_m = 1.0;
  // The integral of a slope that rises to `steep` over kRound_m.
  const auto begun_m = [](double way_m) {
    if (way_m <= 0.0) return 0.0;
    if (way_m >= kRound_m) return way_m - 0.5 * kRound_m;
    return 0.5 * way_m * way_m / kRound_m;
  };
  return steep * (begun_m(along_m + 0.5 * kRound_m) - begun_m(along_m + 0.5 * kRound_m - length_m));
}

struct Making {
  Draws draws;
  double given_deg;  // negative: draw it
  uint64_t seed;

  double Steepness(double low_deg, double high_deg) {
    const double drawn_deg = draws.Uniform(low_deg, high_deg);
    return TanOf(given_deg >= 0.0 ? given_deg : drawn_deg);
  }
};

template <typename Height>
void Lay(Scenario& scenario, const Bounds& bounds, const Height& height_m) {
  scenario.world = World(bounds, Terrain(bounds, height_m));
}

void MakeSideSlope(Making& making, Scenario& scenario) {
  scenario.description = "A hillside across the way, with level ground along its foot.";
  scenario.goal = {42.0, 0.0};
  const double steep = making.Steepness(5.0, 35.0);
  const double side = making.draws.Sign();
  const double foot_m = making.draws.Uniform(3.0, 5.0);  // beside the straight way
  constexpr double kHigh_m = 5.0;
  Lay(scenario, kBounds, [=](double x_m, double y_m) {
    const double begins = Eased((x_m - 5.0) / 8.0);
    const double ends = Eased((39.0 - x_m) / 8.0);
    return begins * ends * Ramp_m(side * y_m + foot_m, kHigh_m / std::max(steep, 0.05), steep);
  });
}

void MakeDownhillStop(Making& making, Scenario& scenario) {
  scenario.description = "Down a slope to a building that stands on the goal.";
  const double steep = making.Steepness(5.0, 20.0);
  const double begin_m = making.draws.Uniform(-12.0, -8.0);
  const double wall_m = making.draws.Uniform(26.0, 34.0);
  const double length_m = wall_m + 1.0 - begin_m;
  scenario.goal = {wall_m + 0.5, 0.0};
  Lay(scenario, kBounds,
      [=](double x_m, double /*y_m*/) { return -Ramp_m(x_m - begin_m, length_m, steep); });
  AddBoxOnGround(scenario.world, {wall_m + 1.5, 0.0}, kPi / 2.0, 98.0, 3.0, 1.8, kWall);
}

void MakeCrest(Making& making, Scenario& scenario) {
  scenario.description = "Up a slope, three metres along its top, and down again.";
  const double up = making.Steepness(6.0, 18.0);
  const double down = making.Steepness(6.0, 18.0);
  const double begin_m = making.draws.Uniform(6.0, 9.0);
  const double high_m = making.draws.Uniform(2.0, 3.5);
  const double up_m = high_m / std::max(up, 0.02);
  const double down_m = high_m / std::max(down, 0.02);
  const double falls_m = begin_m + up_m + 3.0;
  scenario.goal = {falls_m + down_m + 8.0, 0.0};
  const Bounds bounds = {-30.0, -50.0, scenario.goal.x_m + 50.0, 50.0};
  Lay(scenario, bounds, [=](double x_m, double /*y_m*/) {
    return Ramp_m(x_m - begin_m, up_m, up) - Ramp_m(x_m - falls_m, down_m, down);
  });
}

void MakeRidge(Making& making, Scenario& scenario) {
  scenario.description = "A narrow ridge across the way, with a gap in it.";
  scenario.goal = {40.0, 0.0};
  const double steep = making.Steepness(34.0, 40.0);
  const double high_m = making.draws.Uniform(0.9, 1.4);
  const double x_at_m = making.draws.Uniform(16.0, 22.0);
  const double gap_m = making.draws.UniformOnEitherSide(6.0, 11.0);
  Lay(scenario, kBounds, [=](double x_m, double y_m) {
    const double beside_m = high_m - steep * std::abs(x_m - x_at_m);
    const double stands = Eased((std::abs(y_m - gap_m) - 2.5) / 2.0);
    return stands * std::max(beside_m, 0.0);
  });
}

void MakeWashout(Making& making, Scenario& scenario) {
  scenario.description = "A ditch across the way on a slope; one end of it can be driven around.";
  scenario.goal = {38.0, 0.0};
  const double steep = making.Steepness(4.0, 10.0) * making.draws.Sign();
  const double side = making.draws.Sign();
  const double x_m = making.draws.Uniform(16.0, 21.0);
  const double end_m = making.draws.Uniform(6.0, 9.0);
  const double askew_m = making.draws.Uniform(-2.0, 2.0);
  const double half_width_m = making.draws.Uniform(0.7, 1.4);
  const double depth_m = making.draws.Uniform(0.7, 1.2);
  const Ditch ditch = {{x_m, side * end_m}, {x_m + askew_m, -side * 60.0}, half_width_m, depth_m};
  Lay(scenario, kBounds, [&](double place_x_m, double place_y_m) {
    return (steep < 0.0 ? -1.0 : 1.0) * Ramp_m(place_x_m - 6.0, 28.0, std::abs(steep)) -
           ditch.Depth_m(place_x_m, place_y_m);
  });
  scenario.world.AddDitch(ditch);
}

void MakeRuts(Making& making, Scenario& scenario) {
  scenario.description = "Two ruts, a vehicle's track apart, at a small angle to the way.";
  scenario.goal = {40.0, 0.0};
  const double steep = making.Steepness(8.0, 20.0);  // of a rut's sides
  const double along = making.draws.Uniform(-0.15, 0.15);
  const double at_m = making.draws.Uniform(-1.0, 1.0);
  constexpr double kHalfTrack_m = 0.56;
  constexpr double kHalfWidth_m = 0.45;
  Lay(scenario, kBounds, [=](double x_m, double y_m) {
    const double beside_m = std::abs(y_m - at_m - along * (x_m - 20.0)) - kHalfTrack_m;
    const double into_m = std::max(kHalfWidth_m - std::abs(beside_m), 0.0);
    const double lasts = Eased((x_m - 5.0) / 3.0) * Eased((38.0 - x_m) / 3.0);
    return -lasts * std::min(steep * into_m, 0.2);
  });
}

void MakeRough(Making& making, Scenario& scenario) {
  scenario.description = "Rough ground: waves of random heights, a few metres long.";
  scenario.goal = {44.0, 0.0};
  const double steep = making.Steepness(6.0, 16.0);
  const uint64_t key = KeyOf(making.seed, Stream::kWorld);
  constexpr double kWave_m = 3.0;
  // Between two knots at -1 and 1, Eased is steepest in the middle: 1.5 times the mean.
  const double amplitude_m = steep * kWave_m / 3.0;
  Lay(scenario, kBounds, [=](double x_m, double y_m) {
    const double from_start_m = std::sqrt(x_m * x_m + y_m * y_m);
    return amplitude_m * HeightNet(key, 0, x_m / kWave_m, y_m / kWave_m) *
           Eased((from_start_m - 2.0) / 4.0);
  });
}

void MakeMud(Making& making, Scenario& scenario) {
  scenario.description = "A slope across the way, with a slippery patch on it.";
  scenario.goal = {40.0, 0.0};
  const double steep = making.Steepness(2.0, 7.0);
  const double side = making.draws.Sign();
  const double x_m = making.draws.Uniform(16.0, 22.0);
  const double y_m = making.draws.Uniform(-2.0, 2.0);
  const double radius_m = making.draws.Uniform(3.0, 5.0);
  const double friction = making.draws.Uniform(0.08, 0.2);
  Lay(scenario, kBounds, [=](double /*x_m*/, double place_y_m) {
    return Ramp_m(side * place_y_m + 15.0, 30.0, steep) - Ramp_m(15.0, 30.0, steep);
  });
  scenario.world.AddPatch({{x_m, y_m}, radius_m, friction});
}

void MakeRolling(Making& making, Scenario& scenario) {
  scenario.description = "Smooth hills, 20 to 30 m from one to the next, for 140 m.";
  scenario.goal = {140.0, 0.0};
  const double steep = making.Steepness(6.0, 14.0);
  const double wave_m = making.draws.Uniform(10.0, 15.0);
  const uint64_t key = KeyOf(making.seed, Stream::kWorld);
  const double amplitude_m = steep * wave_m / 3.0;
  constexpr Bounds kLong = {-30.0, -50.0, 170.0, 50.0};
  Lay(scenario, kLong, [=](double x_m, double y_m) {
    const double from_start_m = std::sqrt(x_m * x_m + y_m * y_m);
    return amplitude_m * HeightNet(key, 0, x_m / wave_m, y_m / wave_m) *
           Eased((from_start_m - 2.0) / 8.0);
  });
}

struct Maker {
  const char* name;
  void (*make)(Making& making, Scenario& scenario);
};
constexpr Maker kMakers[] = {
    {"side_slope", MakeSideSlope}, {"downhill_stop", MakeDownhillStop},
    {"crest", MakeCrest},          {"ridge", MakeRidge},
    {"washout", MakeWashout},      {"ruts", MakeRuts},
    {"rough", MakeRough},          {"mud", MakeMud},
    {"rolling", MakeRolling},
};

}  // namespace

const std::vector<std::string>& SlopeNames() {
  static const auto names = [] {
    std::vector<std::string> made;
    made.reserve(std::size(kMakers));
    for (const Maker& maker : kMakers) made.emplace_back(maker.name);
    return made;
  }();
  return names;
}

void GiveFriction(uint64_t seed, World& world) {
  Draws draws(seed, 3);
  world.SetFriction(draws.Uniform(kLeastFriction, kMostFriction));
}

bool MakeSlope(std::string_view name, uint64_t seed, std::optional<double> steepness_deg,
               Scenario& scenario) {
  for (const Maker& maker : kMakers) {
    if (name != maker.name) continue;
    scenario = Scenario{};
    scenario.name = maker.name;
    Making making = {Draws(seed, 1), steepness_deg.value_or(-1.0), seed};
    maker.make(making, scenario);
    GiveFriction(seed, scenario.world);
    return true;
  }
  return false;
}

}  // namespace hardpack::world
