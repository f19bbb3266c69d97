// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/sim/world/named_worlds.h"

// The world `low`: what stands no higher than half a metre, in and beside the way, on a vehicle
// whose lidar was mounted a little askew and that dips its nose when it brakes.

namespace hardpack::world {

// Lower than this, the vehicle passes over it; nothing in the way of `low` is (but its pebbles).
inline constexpr double kLeastLow_m = 0.2;

void MakeLow(uint64_t seed, Scenario& scenario);

// The same without the low things, for comparison.
void MakeLowBare(uint64_t seed, Scenario& scenario);

// Low things by themselves, standing on the ground; heading_rad is that of the length.

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
