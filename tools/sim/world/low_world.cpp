// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/low_world.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

constexpr Bounds kLowBounds = {-30.0, -50.0, 90.0, 50.0};
constexpr Material kLogWood = {Label::kLog, Matter::kSolid, 1.0};
constexpr Material kLyingBody = {Label::kPerson, Matter::kSolid, 1.0};
constexpr Material kGrassBlades = {Label::kGrass, Matter::kFoliage, 1.7};

// Waves of some centimetres, even where the vehicle starts.
double WaveHeight_m(double x_m, double y_m, const std::array<double, 4>& phase) {
  const auto wave = [](double along, double length_m) {
    return TurnOf(2.0 * kPi * along / length_m).sin;
  };
  const double from_start_m = std::sqrt(x_m * x_m + y_m * y_m);
  const double height_m = 0.025 * wave(x_m + 0.4 * y_m + phase[0], 9.0) +
                          0.025 * wave(y_m - 0.3 * x_m + phase[1], 7.0) +
                          0.008 * wave(x_m + phase[2], 2.3) + 0.008 * wave(y_m + phase[3], 1.9);
  return height_m * std::clamp((from_start_m - 2.0) / 6.0, 0.0, 1.0);
}

void MakeGround(uint64_t seed, Scenario& scenario) {
  Draws draws(seed, 1);
  std::array<double, 4> phase = {};
  for (double& part : phase) part = draws.Uniform(0.0, 9.0);
  scenario.world = World(kLowBounds, Terrain(kLowBounds, [=](double x_m, double y_m) {
                           return WaveHeight_m(x_m, y_m, phase);
                         }));
  scenario.goal = {45.0, 0.0};
  constexpr double kMount_rad = 0.5 * kPi / 180.0;
  constexpr double kDip_rad = 3.0 * kPi / 180.0;
  scenario.mount_roll_rad = draws.Uniform(-kMount_rad, kMount_rad);
  scenario.mount_pitch_rad = draws.Uniform(-kMount_rad, kMount_rad);
  scenario.brake_pitch_rad = draws.Uniform(0.0, kDip_rad);
  for (int i = 0; i < 8; ++i) {
    AddTree(scenario.world, {draws.Uniform(-5.0, 45.0), draws.UniformOnEitherSide(13.0, 18.0)}, 0.2,
            1.6);
  }
  // Growth of up to 0.4 m, and pebbles that the vehicle passes over: no reason to leave the way.
  for (int i = 0; i < 2; ++i) {
    const Point2 middle = {draws.Uniform(8.0, 40.0), draws.Uniform(-6.0, 6.0)};
    AddBoxOnGround(scenario.world, middle, draws.Uniform(0.0, kPi), draws.Uniform(2.0, 5.0),
                   draws.Uniform(2.0, 4.0), draws.Uniform(0.25, 0.4), kGrassBlades);
  }
  for (int i = 0; i < 30; ++i) {
    const Point2 place = {draws.Uniform(3.0, 44.0), draws.Uniform(-8.0, 8.0)};
    AddRock(scenario.world, place, draws.Uniform(0.04, 0.12), draws.Uniform(0.03, 0.08), draws);
  }
}

// One thing, no lower than kLeastLow_m; its radius_m as seen from above must not be exceeded.
void AddLowThing(World& world, Point2 place, double radius_m, Draws& draws) {
  const double height_m = draws.Uniform(kLeastLow_m + 0.01, 0.45);
  const double heading_rad = draws.Uniform(0.0, kPi);
  const double kind = draws.Uniform(0.0, 8.0);
  if (kind < 3.0) {
    AddRock(world, place, draws.Uniform(0.22, 0.45), height_m, draws);
  } else if (kind < 4.0) {
    const double thickness_m = draws.Uniform(kLeastLow_m + 0.02, 0.35);
    AddLog(world, place, heading_rad, draws.Uniform(1.0, 2.0 * radius_m), thickness_m);
  } else if (kind < 5.0) {
    AddBoxOnGround(world, place, heading_rad, draws.Uniform(1.5, 2.0 * radius_m), 0.3, height_m,
                   kThing);
  } else if (kind < 6.0) {
    const double ground_m = world.GroundHeight_m(place.x_m, place.y_m);
    world.AddCylinder(place, draws.Uniform(0.12, 0.25), ground_m - 0.5, ground_m + height_m,
                      kHardWood);
  } else if (kind < 7.0) {
    AddWire(world, place, heading_rad, draws.Uniform(1.0, 2.0 * radius_m), 0.35,
            draws.Uniform(0.02, 0.03));
  } else {
    AddLyingPerson(world, place, heading_rad, draws.Uniform(kLeastLow_m + 0.01, 0.28));
  }
}

void AddLowThings(uint64_t seed, Scenario& scenario) {
  constexpr double kReach_m = 1.5;  // of a thing from its middle
  constexpr double kApart_m = 6.3;  // of two middles: 3.3 m between any two things
  constexpr double kFreeEnd_m = 5.5;
  constexpr int kTries = 300;
  Draws draws(seed, 2);
  std::vector<Point2> places;
  for (int i = 0; i < kTries; ++i) {
    // The first ones in the straight way.
    const double aside_m = places.size() < 3 ? 1.0 : 12.0;
    const Point2 place = {draws.Uniform(7.0, 44.0), draws.Uniform(-aside_m, aside_m)};
    const auto is_near = [&](const Point2& other, double apart_m) {
      const double x_m = place.x_m - other.x_m;
      const double y_m = place.y_m - other.y_m;
      return x_m * x_m + y_m * y_m < apart_m * apart_m;
    };
    if (is_near({}, kFreeEnd_m) || is_near(scenario.goal, kFreeEnd_m)) continue;
    if (std::any_of(places.begin(), places.end(),
                    [&](const Point2& other) { return is_near(other, kApart_m); })) {
      continue;
    }
    places.push_back(place);
    AddLowThing(scenario.world, place, kReach_m, draws);
  }
}

}  // namespace

void AddRock(World& world, Point2 place, double radius_m, double height_m, Draws& draws) {
  constexpr int kCorners = 7;
  const double ground_m = world.GroundHeight_m(place.x_m, place.y_m);
  const double first_rad = draws.Uniform(0.0, 2.0 * kPi);
  const double narrower = draws.Uniform(0.6, 0.9);
  std::array<Point2, kCorners> low;
  std::array<Point2, kCorners> high;
  for (size_t i = 0; i < kCorners; ++i) {
    // On a circle, so that the outline is convex wherever they fall.
    const double share = (static_cast<double>(i) + draws.Uniform(-0.3, 0.3)) / kCorners;
    const Turn turn = TurnOf(first_rad + 2.0 * kPi * share);
    low[i] = {place.x_m + radius_m * turn.cos, place.y_m + radius_m * turn.sin};
    high[i] = {place.x_m + narrower * radius_m * turn.cos,
               place.y_m + narrower * radius_m * turn.sin};
  }
  const double shoulder_m = ground_m + draws.Uniform(0.4, 0.8) * height_m;
  world.AddPrism(low, ground_m - 0.5, shoulder_m, kRock);
  world.AddPrism(high, shoulder_m - 0.01, ground_m + height_m, kRock);
}

void AddLog(World& world, Point2 middle, double heading_rad, double length_m, double thickness_m) {
  const double ground_m = world.GroundHeight_m(middle.x_m, middle.y_m);
  const auto add = [&](double width, double low, double high) {
    world.AddBox(middle, heading_rad, length_m, width * thickness_m, ground_m + low * thickness_m,
                 ground_m + high * thickness_m, kLogWood);
  };
  add(0.7, 0.0, 0.15);
  add(0.94, 0.15, 0.32);
  add(1.0, 0.32, 0.68);
  add(0.94, 0.68, 0.85);
  add(0.7, 0.85, 1.0);
}

void AddWire(World& world, Point2 middle, double heading_rad, double length_m, double height_m,
             double thickness_m) {
  const double ground_m = world.GroundHeight_m(middle.x_m, middle.y_m);
  const Turn turn = TurnOf(heading_rad);
  for (const double end : {-0.5, 0.5}) {
    const Point2 place = {middle.x_m + end * length_m * turn.cos,
                          middle.y_m + end * length_m * turn.sin};
    world.AddCylinder(place, 0.03, ground_m - 0.5, ground_m + height_m + 0.05, kPost);
  }
  world.AddBox(middle, heading_rad, length_m, thickness_m, ground_m + height_m - thickness_m / 2.0,
               ground_m + height_m + thickness_m / 2.0, kPost);
}

void AddLyingPerson(World& world, Point2 middle, double heading_rad, double height_m) {
  const double ground_m = world.GroundHeight_m(middle.x_m, middle.y_m);
  const Turn turn = TurnOf(heading_rad);
  const auto add = [&](double along_m, double length_m, double width_m, double high_m) {
    const Point2 place = {middle.x_m + along_m * turn.cos, middle.y_m + along_m * turn.sin};
    world.AddBox(place, heading_rad, length_m, width_m, ground_m - 0.1, ground_m + high_m,
                 kLyingBody);
  };
  add(-0.45, 0.80, 0.32, 0.65 * height_m);  // legs
  add(0.22, 0.55, 0.46, height_m);
  add(0.66, 0.24, 0.17, 0.9 * height_m);  // head
}

void MakeLow(uint64_t seed, Scenario& scenario) {
  MakeGround(seed, scenario);
  scenario.description =
      "Rocks, logs, kerbs, stumps, wires and lying people, 0.2 to 0.45 m high, in the way.";
  AddLowThings(seed, scenario);
}

void MakeLowBare(uint64_t seed, Scenario& scenario) {
  MakeGround(seed, scenario);
  scenario.description = "The world `low` without the low objects, for comparison.";
}

}  // namespace hardpack::world
