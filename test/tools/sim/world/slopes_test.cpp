// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/slopes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/sim/world/tilt.h"

namespace hardpack::world {
namespace {

constexpr double kDegree_rad = kPi / 180.0;

Scenario OnSlope(const std::string& name, uint64_t seed) {
  Scenario scenario;
  const ReadOutcome outcome = MakeScenario(name, seed, scenario);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return scenario;
}

// The steepest ground on the straight way, in degrees.
double SteepestOnWay_deg(const Scenario& scenario) {
  double steepest = 0.0;
  for (double x_m = 0.0; x_m < scenario.goal.x_m; x_m += 0.1) {
    const Vector normal = scenario.world.GroundAt(x_m, 0.0).normal;
    const double level = std::sqrt(normal.x_m * normal.x_m + normal.y_m * normal.y_m);
    steepest = std::max(steepest, std::atan2(level, normal.z_m) / kDegree_rad);
  }
  return steepest;
}

TEST(Slopes, HaveFrictionAndRoomAtBothEnds) {
  for (const std::string& name : SlopeNames()) {
    for (uint64_t seed = 1; seed <= 20; ++seed) {
      const Scenario scenario = OnSlope(name, seed);
      EXPECT_EQ(scenario.name, name);
      EXPECT_GE(scenario.world.friction(), kLeastFriction);
      EXPECT_LE(scenario.world.friction(), kMostFriction);
      // A building stands on the goal of downhill_stop.
      const Point2 goal = name == "downhill_stop" ? Point2{} : scenario.goal;
      for (const Point2& end : {Point2{}, goal}) {
        const Contact contact = ContactOf(scenario.world, end.x_m, end.y_m, 0.0, 0.0);
        EXPECT_GT(contact.hard_m, 1.0) << name << " " << seed;
        EXPECT_LT(contact.slope, 0.4) << name << " " << seed;
        EXPECT_FALSE(contact.in_ditch || contact.grounds()) << name << " " << seed;
      }
    }
  }
}

TEST(Slopes, AreAsSteepAsTheyAreTold) {
  for (const double told_deg : {8.0, 15.0}) {
    const std::string angle = ":" + std::to_string(static_cast<int>(told_deg));
    for (uint64_t seed = 1; seed <= 10; ++seed) {
      EXPECT_NEAR(SteepestOnWay_deg(OnSlope("downhill_stop" + angle, seed)), told_deg, 0.1);
      EXPECT_NEAR(SteepestOnWay_deg(OnSlope("crest" + angle, seed)), told_deg, 0.1);
      EXPECT_NEAR(SteepestOnWay_deg(OnSlope("mud" + angle, seed)), told_deg, 0.1);
    }
  }
  EXPECT_LT(SteepestOnWay_deg(OnSlope("side_slope:0", 1)), 0.01);
}

// Its building stands on the slope and on the goal, and nothing leads around it.
TEST(Slopes, ADownhillStopIsClosedByABuildingOnTheSlope) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Scenario scenario = OnSlope("downhill_stop:15", seed);
    const Body& wall = scenario.world.bodies().front();
    EXPECT_LT(ContactOf(scenario.world, scenario.goal.x_m, 0.0, 0.0, 0.0).hard_m, 0.0);
    EXPECT_NEAR(ContactOf(scenario.world, wall.x_m - 3.0, 0.0, 0.0, 0.0).slope,
                std::tan(15.0 * kDegree_rad), 0.03);
    for (const double y_m : {-48.0, -20.0, 0.0, 20.0, 48.0}) {
      EXPECT_LT(ContactOf(scenario.world, wall.x_m, y_m, 0.0, 0.0).hard_m, 0.0);
    }
  }
}

// A vehicle across it rests on it with its underside; through the gap it drives.
TEST(Slopes, ARidgeGroundsAVehicleThatDrivesOverIt) {
  int grounds = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Scenario scenario = OnSlope("ridge:38", seed);
    bool does = false;
    for (double x_m = 10.0; x_m < 30.0; x_m += 0.05) {
      does |= ContactOf(scenario.world, x_m, 0.0, 0.0, 0.0).grounds();
    }
    grounds += does ? 1 : 0;
  }
  EXPECT_EQ(grounds, 10);
}

TEST(Slopes, MudIsSlipperyWithinItsPatchOnly) {
  const Scenario scenario = OnSlope("mud", 3);
  ASSERT_EQ(scenario.world.patches().size(), 1u);
  const Patch& patch = scenario.world.patches().front();
  EXPECT_LE(patch.friction, 0.2);
  EXPECT_EQ(scenario.world.FrictionAt(patch.middle.x_m, patch.middle.y_m), patch.friction);
  EXPECT_EQ(scenario.world.FrictionAt(0.0, 0.0), scenario.world.friction());
  EXPECT_NEAR(
      FrictionUnder(scenario.world, patch.middle.x_m + patch.radius_m, patch.middle.y_m, 0.0),
      0.5 * (patch.friction + scenario.world.friction()), 1.0e-9)
      << "two wheels on each";
}

// By the angle that it is told, in a direction of its seed; what stands in it stands as it stood.
TEST(Tilt, TurnsAWorldIntoOneOnASlope) {
  for (const char* name : {"gap", "thicket", "crossing", "corner_ditch"}) {
    const Scenario level = OnSlope(name, 2);
    const Scenario tilted = OnSlope(std::string(name) + ":10", 2);
    EXPECT_FALSE(level.world.has_friction());
    EXPECT_TRUE(tilted.world.has_friction());
    EXPECT_NEAR(ContactOf(tilted.world, 0.0, 0.0, 0.7, 0.0).slope, std::tan(10.0 * kDegree_rad),
                0.02);
    EXPECT_EQ(tilted.world.people().size(), level.world.people().size());
    for (double x_m = -5.0; x_m < 40.0; x_m += 0.7) {
      for (double y_m = -10.0; y_m < 10.0; y_m += 0.7) {
        const Contact before = ContactOf(level.world, x_m, y_m, 0.3, 0.0);
        const Contact after = ContactOf(tilted.world, x_m, y_m, 0.3, 0.0);
        ASSERT_EQ(before.in_ditch, after.in_ditch) << name;
        if (before.slope > 0.1) continue;  // with a wheel on a bank it looks over what is far
        // Of what it stands in, each piece has an outline of its own.
        if (before.hard_m <= 0.0) {
          ASSERT_LE(after.hard_m, 0.0) << name << " " << x_m << " " << y_m;
        } else if (before.hard_m < 3.0) {
          ASSERT_NEAR(before.hard_m, after.hard_m, 1.0e-6) << name << " " << x_m << " " << y_m;
        }
      }
    }
  }
}

TEST(Tilt, RefusesAnglesItDoesNotHave) {
  Scenario scenario;
  for (const char* name : {"gap:", "gap:x", "gap:21", "gap:-1", "gap:nan", "gap:5deg",
                           "side_slope:41", ":5", "moon:5"}) {
    EXPECT_FALSE(MakeScenario(name, 1, scenario).ok()) << name;
  }
  EXPECT_EQ(BaseName("gap:5"), "gap");
  EXPECT_EQ(BaseName("gap"), "gap");
}

}  // namespace
}  // namespace hardpack::world
