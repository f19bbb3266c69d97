// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/back_out.h"

#include <algorithm>

#include "gtest/gtest.h"

namespace hardpack::world {
namespace {

// Closed ahead, too narrow to turn in, and the vehicle's own strip behind it is free.
TEST(BackOut, LeadsOutBehindTheVehicleOnly) {
  int beyond = 0;
  double narrowest_m = 10.0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Scenario scenario;
    ASSERT_TRUE(MakeScenario("back_out", seed, scenario).ok());
    const auto clear_m = [&](double x_m, double yaw_rad) {
      return ContactOf(scenario.world, x_m, 0.0, yaw_rad, 0.0).hard_m;
    };
    EXPECT_GE(clear_m(0.0, 0.0), 0.13) << seed;
    double ahead_m = 10.0;
    for (double x_m = 0.0; x_m <= kAlleyEndMost_m + 0.1; x_m += 0.1) {
      ahead_m = std::min(ahead_m, clear_m(x_m, 0.0));
    }
    EXPECT_LE(ahead_m, 0.0) << seed;
    for (double x_m = -25.0; x_m < 0.0; x_m += 0.1) {
      EXPECT_GE(clear_m(x_m, 0.0), 0.13) << seed << " at " << x_m;
    }
    // Across the alley.
    EXPECT_LE(clear_m(0.0, 0.8), 0.27) << seed;
    narrowest_m = std::min(narrowest_m, clear_m(-1.0, 0.0));
    beyond += scenario.goal.x_m > 0.0 ? 1 : 0;
  }
  EXPECT_LT(narrowest_m, 0.17);
  EXPECT_GT(beyond, 30);
  EXPECT_LT(beyond, 70);
}

}  // namespace
}  // namespace hardpack::world
