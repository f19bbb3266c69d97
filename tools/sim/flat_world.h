// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/scene/world.h"

// A level world of upright bodies, seen by a lidar that stands upright: rays that share a heading
// meet the bodies' outlines at the same level distances, so that each heading is worked out once
// and each beam then costs a few comparisons. That makes a revolution of 1024 x 64 rays cheap
// enough to be cast while it turns (tools/scene has what rays in general need).

namespace hardpack::sim {

struct FlatWorld {
  std::vector<scene::Box> boxes;
  std::vector<scene::Cylinder> cylinders;
};

// Where a heading crosses a body's outline.
struct Crossing {
  double enter_m = 0.0;  // level distances, 0 <= enter_m < leave_m
  double leave_m = 0.0;
  double low_m = 0.0;  // of the body, above the ground
  double high_m = 0.0;
};

struct Point2 {
  double x_m = 0.0;
  double y_m = 0.0;
};

// Of a level ray with a direction of length 1; in no order.
void FindCrossings(const FlatWorld& world, const Point2& origin, const Point2& direction,
                   std::vector<Crossing>& crossings);

// The level distance at which a ray from origin_z_m above the ground, rising by `slope` a metre of
// level distance, meets a body or the ground (z = 0); negative: neither within reach_m.
double MeetLevel_m(const std::vector<Crossing>& crossings, double origin_z_m, double slope,
                   double reach_m);

// Whether an upright rectangle (centre, half length along heading, half width) and a body overlap
// anywhere above 0.1 m; bodies are taken by their outlines' corners and middles, so this tells
// collisions in tests, no contact forces.
bool Collides(const FlatWorld& world, const Point2& center, double heading_rad,
              double half_length_m, double half_width_m);

}  // namespace hardpack::sim
