// SPDX-License-Identifier: Apache-2.0
// What stands no higher than half a metre, from the lidar's beams to the cells of the map: what is
// firm is hard from where the beams resolve it on, and stays so; grass, slopes and labels change
// nothing about it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "test/core/autonomy/perception_scene.h"

namespace hardpack::perception {
namespace {

constexpr double kThing_m = 25.0;
constexpr uint8_t kLowObstacle = Costmap::kHard | Costmap::kSoft;

// The vehicle comes nearer at 2 m/s, to so many metres before the middle of a thing.
std::unique_ptr<Chain> Approach(const std::vector<Body>& bodies, double to_m,
                                bool with_labels = false, double pitch_rad = 0.0,
                                double way_m = 4.0) {
  auto chain = std::make_unique<Chain>(with_labels, Sector{12.0});
  chain->world.bodies = bodies;
  const double begin_m = kThing_m - to_m - way_m;
  chain->truth = [=](double t) {
    Pose pose;
    pose.x = begin_m + std::min(2.0 * t, way_m);
    pose.pitch = pitch_rad;
    return pose;
  };
  // What nobody has measured.
  chain->odometry = [=](double t) {
    Pose pose;
    pose.x = begin_m + std::min(2.0 * t, way_m);
    return pose;
  };
  chain->RunUntil(way_m / 2.0);
  // Until the labels have come.
  if (with_labels) chain->RunUntil(way_m / 2.0 + 0.3);
  chain->Build();
  return chain;
}

constexpr Area kThere = {24.2, -1.6, 26.2, 1.6};

struct Thing {
  const char* name;
  std::vector<Body> bodies;
  double seen_from_m;  // where it has to be hard
  int cells;           // so many at least
};

std::vector<Thing> LowThings() {
  std::vector<Thing> things;
  // The beams are 0.0092 rad apart: one meets what stands above 0.08 m of 0.2 m up to 13 m away.
  for (const auto& [high_m, from_m] : {std::pair{0.2, 11.5}, {0.3, 15.0}, {0.4, 18.0}}) {
    things.push_back({"a rock", {Box({24.75, -0.25, 0.0}, {25.25, 0.25, high_m})}, from_m, 2});
  }
  for (const double high_m : {0.2, 0.3, 0.45}) {
    things.push_back({"a step", {Box({25.0, -1.5, 0.0}, {26.0, 1.5, high_m})}, 11.5, 12});
  }
  things.push_back({"a log", {Box({24.9, -1.5, 0.0}, {25.1, 1.5, 0.2}, kTreeCode)}, 11.5, 12});
  // Between two beams it is not seen: no gap between its cells is as wide as the vehicle.
  things.push_back({"a wire", {Box({24.99, -1.5, 0.34}, {25.01, 1.5, 0.36})}, 8.0, 3});
  things.push_back(
      {"a lying person", {Box({24.8, -0.85, 0.0}, {25.2, 0.85, 0.2}, kDirtCode)}, 11.5, 6});
  things.push_back({"a stump", {Cylinder(25.0, 0.0, 0.15, 0.25, kTreeCode)}, 9.0, 1});
  return things;
}

// SR-LOW01 low things are obstacles from where the beams resolve them.
TEST(LowThings, AreHardFromWhereTheBeamsResolveThem) {
  for (const Thing& thing : LowThings()) {
    SCOPED_TRACE(std::string(thing.name) + ", " + std::to_string(thing.bodies[0].high.z) + " m");
    const auto chain = Approach(thing.bodies, thing.seen_from_m);
    EXPECT_GE(chain->Count(kThere, Costmap::kHard), thing.cells) << chain->Picture(kThere);
  }
}

// A wire of 20 mm at 0.35 m, about the middle of the things, at an angle to the line across the
// way.
std::vector<Body> SlantedWire(double angle_deg) {
  constexpr double kHalf_m = 0.01;
  constexpr double kLength_m = 2.0;
  std::vector<Body> pieces;
  for (double at_m = -kLength_m / 2.0; at_m <= kLength_m / 2.0; at_m += kHalf_m) {
    const double x = kThing_m + at_m * std::sin(angle_deg * kDegree_rad);
    const double y = at_m * std::cos(angle_deg * kDegree_rad);
    pieces.push_back(Box({x - kHalf_m, y - kHalf_m, 0.34}, {x + kHalf_m, y + kHalf_m, 0.36}));
  }
  return pieces;
}

// From single returns of beam after beam, or of one column. No gap between the cells is as wide as
// the vehicle.
// SR-LOW05 wires are obstacles however they lie.
TEST(LowThings, WiresAreHardHoweverTheyLie) {
  for (const double angle_deg : {15.0, 30.0, 45.0, 60.0, 75.0, 85.0}) {
    SCOPED_TRACE(std::to_string(angle_deg) + " degrees");
    const auto chain = Approach(SlantedWire(angle_deg), 5.5);
    EXPECT_GE(chain->Count(kThere, Costmap::kHard), 3) << chain->Picture(kThere);
  }
}

// Up to where the lowest beam has long passed over it, and with a lidar that points half a degree
// up or down.
// SR-LOW01
TEST(LowThings, StayHardInTheBlindCone) {
  for (const Thing& thing : LowThings()) {
    for (const double pitch_deg : {-0.5, 0.0, 0.5}) {
      SCOPED_TRACE(std::string(thing.name) + ", " + std::to_string(thing.bodies[0].high.z) +
                   " m, " + std::to_string(pitch_deg) + " deg");
      const auto chain = Approach(thing.bodies, 2.0, false, pitch_deg * kDegree_rad, 9.0);
      EXPECT_GE(chain->Count(kThere, Costmap::kHard), thing.cells) << chain->Picture(kThere);
    }
  }
}

// SR-LOW04 labels do not lower what geometry saw.
TEST(LowThings, NoLabelMakesThemGroundVoidOrSky) {
  for (const uint8_t code : {kVoidCode, kDirtCode}) {
    for (Thing thing : LowThings()) {
      SCOPED_TRACE(std::string(thing.name) + " with code " + std::to_string(code));
      for (Body& body : thing.bodies) body.code = code;
      const auto chain = Approach(thing.bodies, 7.0, true);
      EXPECT_GE(chain->Count(kThere, Costmap::kHard), thing.cells) << chain->Picture(kThere);
    }
  }
}

// A fence of 1.2 m, a branch from 1.2 to 1.5 m and somebody who stands, all of it void, sky or
// ground by their labels.
// SR-LOW04
TEST(LowThings, NoLabelTakesAwayWhatStands) {
  const std::vector<Body> bodies = {Box({24.98, -1.5, 0.0}, {25.02, -0.9, 1.2}),
                                    Box({24.92, -0.5, 1.2}, {25.08, 0.3, 1.5}),
                                    Cylinder(25.0, 1.0, 0.25, 1.75, kPersonCode)};
  const Area fence = {25.0, -1.4, 25.2, -1.0};
  const Area branch = {24.8, -0.4, 25.2, 0.2};
  const Area person = {24.8, 0.8, 25.2, 1.2};
  for (const uint8_t code : {kVoidCode, kSkyCode, kDirtCode, kGrassCode}) {
    SCOPED_TRACE("code " + std::to_string(code));
    std::vector<Body> named = bodies;
    for (Body& body : named) body.code = code;
    const auto chain = Approach(named, 8.0, true);
    EXPECT_GE(chain->Count(fence, Costmap::kHard), 1) << chain->Picture(kThere);
    EXPECT_GE(chain->Count(branch, Costmap::kHard), 2) << chain->Picture(kThere);
    EXPECT_GE(chain->Count(person, Costmap::kHard), 2) << chain->Picture(kThere);
  }
}

// SR-LOW03 grass is none, but it is told from bare ground: it may hide what is lower.
TEST(LowThings, GrassIsGrowthAndNoObstacle) {
  for (const double high_m : {0.25, 0.4}) {
    for (const double free_path_m : {0.3, 0.6}) {
      SCOPED_TRACE(std::to_string(high_m) + " m, " + std::to_string(free_path_m) + " m deep");
      Body grass = Box({6.0, -3.0, 0.0}, {14.0, 3.0, high_m}, kGrassCode);
      grass.free_path_m = free_path_m;
      Chain chain(false, Sector{40.0});
      chain.world.bodies = {grass};
      chain.truth = [](double t) {
        Pose pose;
        pose.x = 2.0 * t;
        return pose;
      };
      constexpr Area kGrass = {6.0, -3.0, 14.0, 3.0};
      for (int i = 1; i <= 4; ++i) {
        chain.RunUntil(i);
        chain.Build();
        // As dense as a hedge, some of it looks firm by chance: two blocks, of 1200 cells.
        const int by_chance = free_path_m < 0.5 ? 8 : 0;
        EXPECT_LE(chain.Count(kGrass, kLowObstacle), by_chance) << chain.Picture(kGrass);
      }
      EXPECT_GE(chain.Count({8.0, -2.0, 13.0, 2.0}, Costmap::kGrowth), 25 * 20 / 2);
    }
  }
}

// Waves of 0.1 m across the way, 1.5 m long.
TEST(LowThings, WavesOfTheGroundAreNone) {
  std::vector<std::pair<double, double>> profile = {{-1000.0, 0.0}, {4.0, 0.0}};
  for (int i = 0; i < 200; ++i) {
    const double way_m = 4.0 + 0.15 * i;
    profile.emplace_back(way_m, 0.05 * (1.0 - std::cos(2.0 * kPi_rad * 0.15 * i / 1.5)));
  }
  profile.emplace_back(1000.0, profile.back().second);
  World world;
  world.ground = Ground(profile, 0.0);
  Chain chain(false, Sector{25.0});
  chain.world = world;
  chain.truth = [&](double t) {
    Pose pose;
    pose.x = 1.5 * t;
    // On four wheels, which even waves out.
    pose.z = 0.5 * (world.ground.HeightAt(pose.x - 0.46, 0.0) +
                    world.ground.HeightAt(pose.x + 0.46, 0.0));
    return pose;
  };
  for (int i = 1; i <= 3; ++i) {
    chain.RunUntil(i);
    chain.Build();
    // As far as the vehicle needs to see at any speed.
    const Area way = {1.5 * i, -2.0, 1.5 * i + 12.0, 2.0};
    EXPECT_EQ(chain.Count(way, kLowObstacle), 0) << chain.Picture(way);
  }
}

}  // namespace
}  // namespace hardpack::perception
