// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/thicket.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "gtest/gtest.h"

namespace hardpack::world {
namespace {

Scenario Make(uint64_t seed) {
  Scenario scenario;
  EXPECT_TRUE(MakeScenario("thicket", seed, scenario).ok());
  return scenario;
}

// From a point to the nearest body, by the bodies themselves.
double Clearance_m(const World& world, double x_m, double y_m) {
  double least_m = 100.0;
  for (const Body& body : world.bodies()) {
    if (body.shape == Shape::kCylinder) {
      least_m = std::min(least_m, std::hypot(x_m - body.x_m, y_m - body.y_m) - body.radius_m);
      continue;
    }
    // Of an upright prism: the distance to its nearest side, if no corner is nearer.
    const auto sides = world.SidesOf(body);
    double outside_m = -100.0;
    double to_edge_m = 100.0;
    for (size_t i = 0; i < sides.size(); ++i) {
      const Side& side = sides[i];
      const Point2 next = sides[(i + 1) % sides.size()].corner;
      outside_m = std::max(outside_m, side.normal_x * x_m + side.normal_y * y_m - side.offset_m);
      const double dx_m = next.x_m - side.corner.x_m;
      const double dy_m = next.y_m - side.corner.y_m;
      const double along =
          std::clamp(((x_m - side.corner.x_m) * dx_m + (y_m - side.corner.y_m) * dy_m) /
                         (dx_m * dx_m + dy_m * dy_m),
                     0.0, 1.0);
      to_edge_m = std::min(to_edge_m, std::hypot(side.corner.x_m + along * dx_m - x_m,
                                                 side.corner.y_m + along * dy_m - y_m));
    }
    least_m = std::min(least_m, outside_m < 0.0 ? 0.0 : to_edge_m);
  }
  return least_m;
}

// A search of its own, on another grid than the generator's and over the bodies as they stand.
bool HasWay(const Scenario& scenario, double half_gap_m) {
  constexpr double kStep_m = 0.08;
  constexpr int kColumns = 490;
  constexpr int kRows = 175;
  const auto place = [](int index) {
    return Point2{-1.0 + index % kColumns * kStep_m, (index / kColumns - kRows / 2) * kStep_m};
  };
  std::vector<uint8_t> seen(static_cast<size_t>(kRows) * kColumns);
  std::vector<int> open = {kRows / 2 * kColumns + 13};
  while (!open.empty()) {
    const int index = open.back();
    open.pop_back();
    if (index < 0 || index >= kRows * kColumns) continue;
    uint8_t& was_seen = seen[static_cast<size_t>(index)];
    if (was_seen != 0) continue;
    was_seen = 1;
    const Point2 here = place(index);
    if (Clearance_m(scenario.world, here.x_m, here.y_m) < half_gap_m) continue;
    if (std::hypot(here.x_m - scenario.goal.x_m, here.y_m - scenario.goal.y_m) < 0.1) return true;
    if (index % kColumns > 0) open.push_back(index - 1);
    if (index % kColumns < kColumns - 1) open.push_back(index + 1);
    open.push_back(index - kColumns);
    open.push_back(index + kColumns);
  }
  return false;
}

TEST(Thicket, HasAWayOfTheHalfGap) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    // The grid of this search is another one: a point of it is up to 0.04 m beside the way.
    EXPECT_TRUE(HasWay(Make(seed), kThicketHalfGap_m)) << seed;
  }
}

TEST(Thicket, GoesFromSparseToBarelyPassable) {
  size_t least = 10'000;
  size_t most = 0;
  int barely = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const Scenario scenario = Make(seed);
    least = std::min(least, scenario.world.bodies().size());
    most = std::max(most, scenario.world.bodies().size());
    barely += HasWay(scenario, kThicketHalfGap_m + 0.4) ? 0 : 1;
  }
  EXPECT_LT(least, 80u);
  EXPECT_GT(most, 200u);
  EXPECT_GE(barely, 5);
  EXPECT_LE(barely, 25);
}

// Nothing leads around it: from the outside of one wall's end to the other's all is closed but the
// side of the goal.
TEST(Thicket, IsNotDrivenAround) {
  const Scenario scenario = Make(1);
  for (double x_m = -5.0; x_m <= 41.0; x_m += 0.5) {
    for (const double side : {-1.0, 1.0}) {
      EXPECT_LT(Clearance_m(scenario.world, x_m, side * 7.1), 0.2);
    }
  }
}

}  // namespace
}  // namespace hardpack::world
