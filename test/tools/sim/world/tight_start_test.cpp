// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/tight_start.h"

#include <algorithm>

#include "gtest/gtest.h"

namespace hardpack::world {
namespace {

// As near as it says, and the vehicle's own strip ahead is free.
TEST(TightStart, IsTightBesideAndFreeAhead) {
  int on_both_sides = 0;
  double least_m = 1.0;
  double most_m = 0.0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Scenario scenario;
    ASSERT_TRUE(MakeScenario("tight_start", seed, scenario).ok());
    const double aside_m = ContactOf(scenario.world, 0.0, 0.0, 0.0, 0.0).hard_m;
    EXPECT_GE(aside_m, kTightLeast_m - 1.0e-9) << seed;
    EXPECT_LE(aside_m, kTightMost_m + 1.0e-9) << seed;
    least_m = std::min(least_m, aside_m);
    most_m = std::max(most_m, aside_m);
    for (double x_m = 0.0; x_m < scenario.goal.x_m; x_m += 0.1) {
      EXPECT_GE(ContactOf(scenario.world, x_m, 0.0, 0.0, 0.0).hard_m, aside_m - 1.0e-6)
          << seed << " at " << x_m;
    }
    bool left = false;
    bool right = false;
    for (const Body& body : scenario.world.bodies()) {
      left |= body.y_m > 0.0;
      right |= body.y_m < 0.0;
    }
    on_both_sides += left && right ? 1 : 0;
  }
  EXPECT_LT(least_m, 0.08);
  EXPECT_GT(most_m, 0.45);
  EXPECT_GT(on_both_sides, 15);
  EXPECT_LT(on_both_sides, 60);
}

}  // namespace
}  // namespace hardpack::world
