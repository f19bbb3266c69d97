// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/sim/world/named_worlds.h"

// The world `low`: objects no higher than half a metre, in and beside the path, for a vehicle whose
// lidar is mounted slightly askew and whose nose dips when it brakes.

namespace hardpack::world {

// The vehicle passes over anything lower; in `low` only the pebbles are.
inline constexpr double kLeastLow_m = 0.2;

void MakeLow(uint64_t seed, Scenario& scenario);

// The same without the low objects, for comparison.
void MakeLowBare(uint64_t seed, Scenario& scenario);

// Single low objects, standing on the ground; heading_rad is the direction of the length.

// Irregular, narrower towards its top.
void AddRock(World& world, Point2 place, double radius_m, double height_m, Draws& draws);
// Round: lying on its side.
void AddLog(World& world, Point2 middle, double heading_rad, double length_m, double thickness_m);
// Straight, between two stakes.
void AddWire(World& world, Point2 middle, double heading_rad, double length_m, double height_m,
             double thickness_m);
// 1.7 m long, its chest as high as height_m.
void AddLyingPerson(World& world, Point2 middle, double heading_rad, double height_m);

}  // namespace hardpack::world
