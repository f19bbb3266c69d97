// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/world/world.h"

// Features of worlds: objects made of several bodies, standing on the ground.

namespace hardpack::world {

inline constexpr Material kHardWood = {Label::kTree, Matter::kSolid, 1.0};
inline constexpr Material kLeaves = {Label::kTree, Matter::kFoliage, 0.6};
inline constexpr Material kBushLeaves = {Label::kBush, Matter::kFoliage, 1.5};
inline constexpr Material kRock = {Label::kRubble, Matter::kSolid, 1.0};
inline constexpr Material kWall = {Label::kBuilding, Matter::kSolid, 1.0};
inline constexpr Material kThing = {Label::kObject, Matter::kSolid, 1.0};
inline constexpr Material kPost = {Label::kFence, Matter::kSolid, 1.0};
inline constexpr Material kWireMesh = {Label::kFence, Matter::kMesh, 0.35};

// A box whose height counts from the ground under its middle; it extends half a metre into it.
void AddBoxOnGround(World& world, Point2 middle, double heading_rad, double length_m,
                    double width_m, double height_m, const Material& material);

// A trunk and, from 2.4 m up, a crown that lets through some rays.
void AddTree(World& world, Point2 place, double trunk_radius_m, double crown_radius_m);

void AddBush(World& world, Point2 place, double radius_m, double height_m);

// Posts of 5 cm radius each 2.5 m at most, one at either end, with wire mesh of 1.3 m height
// between them that a third of the rays end at. The outer faces of the end posts lie at the ends.
void AddFence(World& world, Point2 from, Point2 to);

// A hull of 6 x 2.2 m on a trailer, its bow to heading_rad; the hull hangs over the wheels, from
// 0.5 to 1.7 m.
void AddBoat(World& world, Point2 middle, double heading_rad);
inline constexpr double kBoatLength_m = 6.0;

// Boulders within core_m of the middle, piled up to height_m there, in growth that reaches to
// skirt_m and is 0.7 m high.
void AddRockPile(World& world, Point2 middle, double core_m, double skirt_m, double height_m,
                 Draws& draws);

}  // namespace hardpack::world
