// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/named_worlds.h"

#include <cmath>

#include "gtest/gtest.h"
#include "tools/sim/world/map_world.h"

namespace hardpack::world {
namespace {

Scenario Make(const std::string& name, uint64_t seed) {
  Scenario scenario;
  const ReadOutcome outcome = MakeScenario(name, seed, scenario);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return scenario;
}

// What a few thousand rays from the start see, as one number.
uint64_t DigestOf(const Scenario& scenario) {
  uint64_t digest = 1;
  for (int i = 0; i < 3000; ++i) {
    const Turn level = TurnOf(0.0021 * i);
    const Turn up = TurnOf(0.2 * (i % 7 - 4) / 3.0);
    const Ray ray = {{0.0, 0.0, 1.3},
                     {level.cos * up.cos, level.sin * up.cos, up.sin},
                     110.0,
                     static_cast<uint64_t>(i)};
    const Hit hit = scenario.world.Cast(ray, 1.0);
    digest = Mixed(digest ^ static_cast<uint64_t>(std::llround(hit.range_m * 1000.0)) ^
                   static_cast<uint64_t>(hit.label) << 40);
  }
  return digest;
}

TEST(NamedWorlds, SayWhatTheyAre) {
  EXPECT_GE(WorldNames().size(), 11u);
  for (const std::string& name : WorldNames()) {
    const Scenario scenario = Make(name, 1);
    EXPECT_EQ(scenario.name, name);
    EXPECT_FALSE(scenario.description.empty());
  }
  Scenario scenario;
  const ReadOutcome outcome = MakeScenario("moon", 1, scenario);
  EXPECT_FALSE(outcome.ok());
  EXPECT_NE(outcome.message.find("rock_pile"), std::string::npos) << "it lists them";
}

TEST(NamedWorlds, AreTheSameForTheSameSeedOnly) {
  for (const std::string& name : WorldNames()) {
    EXPECT_EQ(DigestOf(Make(name, 3)), DigestOf(Make(name, 3))) << name;
    if (name != "open") {
      EXPECT_NE(DigestOf(Make(name, 3)), DigestOf(Make(name, 4))) << name;
    }
  }
}

TEST(NamedWorlds, HaveRoomAtBothEnds) {
  for (const std::string& name : WorldNames()) {
    for (uint64_t seed = 0; seed < 20; ++seed) {
      const Scenario scenario = Make(name, seed);
      for (const double yaw_rad : {0.0, 0.8, 1.6}) {
        for (const Point2& end : {Point2{}, scenario.goal}) {
          const bool is_tight =
              name == "tight_start" || name == "back_out" || name.starts_with("corner");
          if (is_tight && end.x_m == 0.0) continue;
          const Contact contact = ContactOf(scenario.world, end.x_m, end.y_m, yaw_rad, 0.0);
          EXPECT_GT(contact.hard_m, 1.0) << name << " " << seed;
          EXPECT_GT(contact.person_m, 1.0) << name << " " << seed;
          EXPECT_LT(contact.slope, 0.15) << name << " " << seed;
          EXPECT_FALSE(contact.in_ditch) << name << " " << seed;
        }
      }
      EXPECT_NEAR(scenario.start.position.z_m, 0.0, 0.01) << name;
    }
  }
}

// A vehicle in the middle of the passage, along x: 2.2 m less its width, on both sides the same.
TEST(Gap, Is2p2MetersWide) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Scenario scenario = Make("gap", seed);
    const Passage gap = GapOf(seed);
    const double middle_m = (gap.fence.y_m + gap.boat.y_m) / 2.0;
    double least_m = 10.0;
    for (double x_m = gap.fence.x_m - 3.0; x_m <= gap.fence.x_m + 3.0; x_m += 0.05) {
      least_m = std::min(least_m, ContactOf(scenario.world, x_m, middle_m, 0.0, 0.0).hard_m);
    }
    EXPECT_NEAR(2.0 * least_m + 1.38, 2.2, 0.01) << seed;
    // And rays say the same: to the fence's last post and to the boat's stern.
    const double z_m = scenario.world.GroundHeight_m(gap.fence.x_m, middle_m) + 1.2;
    const auto range_m = [&](double side) {
      double nearest_m = 100.0;
      for (double x_m = gap.fence.x_m - 0.06; x_m <= gap.fence.x_m + 0.06; x_m += 0.001) {
        const Hit hit = scenario.world.Cast(Ray{{x_m, middle_m, z_m}, {0.0, side, 0.0}}, 0.0);
        if (hit.any()) nearest_m = std::min(nearest_m, hit.range_m);
      }
      return nearest_m;
    };
    EXPECT_NEAR(range_m(1.0) + range_m(-1.0), 2.2, 0.01) << seed;
  }
}

// There is no other way through: every line from the start's side to the goal's but the gap's is
// stopped.
TEST(Gap, IsTheOnlyWay) {
  const Scenario scenario = Make("gap", 2);
  const Passage gap = GapOf(2);
  const double middle_m = (gap.fence.y_m + gap.boat.y_m) / 2.0;
  for (double y_m = -30.0; y_m <= 30.0; y_m += 0.1) {
    if (std::abs(y_m - middle_m) < 0.5) continue;
    bool blocked = false;
    for (double x_m = gap.fence.x_m - 4.0; x_m <= gap.fence.x_m + 4.0; x_m += 0.2) {
      blocked |= ContactOf(scenario.world, x_m, y_m, 0.0, 0.0).touches();
    }
    EXPECT_TRUE(blocked) << y_m;
  }
}

TEST(Corridor, IsTheSameLeftAndRight) {
  const Scenario scenario = Make("corridor", 5);
  for (int i = 1; i < 300; ++i) {
    const Turn turn = TurnOf(0.01 * i);
    const Hit left = scenario.world.Cast(Ray{{0, 0, 1.3}, {turn.cos, turn.sin, 0.0}}, 0.0);
    const Hit right = scenario.world.Cast(Ray{{0, 0, 1.3}, {turn.cos, -turn.sin, 0.0}}, 0.0);
    ASSERT_EQ(left.any(), right.any());
    EXPECT_NEAR(left.range_m, right.range_m, 1.0e-9);
  }
}

TEST(Crossing, HasPeopleOnTheWay) {
  const Scenario scenario = Make("crossing", 1);
  ASSERT_EQ(scenario.world.people().size(), 6u);
  for (const Person& person : scenario.world.people()) {
    int crossings = 0;
    double fastest_mps = 0.0;
    for (double time_s = 0.0; time_s < 60.0; time_s += 0.1) {
      const Point2 now = person.At(time_s);
      const Point2 then = person.At(time_s + 0.1);
      crossings += now.y_m * then.y_m < 0.0 ? 1 : 0;
      fastest_mps = std::max(fastest_mps, std::hypot(then.x_m - now.x_m, then.y_m - now.y_m) / 0.1);
    }
    EXPECT_GE(crossings, 2);
    EXPECT_LE(fastest_mps, 2.01);
    EXPECT_GE(fastest_mps, 0.69);
  }
}

TEST(Forest, LeavesRoomBetweenTrunks) {
  const Scenario scenario = Make("forest", 1);
  std::vector<const Body*> trunks;
  for (const Body& body : scenario.world.bodies()) {
    if (body.shape == Shape::kCylinder) trunks.push_back(&body);
  }
  EXPECT_GT(trunks.size(), 150u);
  for (const Body* one : trunks) {
    for (const Body* other : trunks) {
      if (one == other) continue;
      EXPECT_GT(std::hypot(one->x_m - other->x_m, one->y_m - other->y_m), 3.0);
    }
  }
}

// Rows upward:   . S .      pixels of 0.5 m, lower left corner at (10, -1)
//                # # ?
TEST(MapWorld, HasWallsAndBushes) {
  using map_server::Occupancy;
  map_server::OccupancyMap map = {3, 2, 0.5, 10.0, -1.0, {}};
  map.pixels = {Occupancy::kHard, Occupancy::kHard, Occupancy::kUnknown,
                Occupancy::kFree, Occupancy::kSoft, Occupancy::kFree};
  const World world = WorldOfMap(map);
  ASSERT_EQ(world.bodies().size(), 2u) << "what touches is one box";
  const Hit wall = world.Cast(Ray{{5.0, -0.75, 1.0}, {1.0, 0.0, 0.0}}, 0.0);
  EXPECT_NEAR(wall.range_m, 5.0, 1.0e-9);
  EXPECT_EQ(wall.label, Label::kBuilding);
  EXPECT_NEAR(world.Cast(Ray{{15.0, -0.75, 1.0}, {-1.0, 0.0, 0.0}}, 0.0).range_m, 4.0, 1.0e-9)
      << "past the unknown pixel";
  int bushes = 0;
  for (uint64_t key = 0; key < 1000; ++key) {
    const Hit hit = world.Cast(Ray{{5.0, -0.25, 0.5}, {1.0, 0.0, 0.0}, 50.0, Mixed(key)}, 0.0);
    if (!hit.any()) continue;
    EXPECT_EQ(hit.label, Label::kBush);
    EXPECT_GE(hit.range_m, 5.5);
    EXPECT_LE(hit.range_m, 6.0);
    ++bushes;
  }
  EXPECT_GT(bushes, 300);
  EXPECT_LT(bushes, 700);
}

}  // namespace
}  // namespace hardpack::world
