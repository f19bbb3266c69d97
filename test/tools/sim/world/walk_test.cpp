// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hardpack::world {
namespace {

constexpr double kStep_s = 0.001;

double Apart(Point2 a, Point2 b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

World WorldWith(Point2 from, Point2 to, double walk_s) {
  World world;
  Person person;
  person.places = {{0.0, from.x_m, from.y_m}, {walk_s, to.x_m, to.y_m}};
  world.AddPerson(person);
  return world;
}

struct Walked {
  double nearest_m = 1e9;  // to the outline, from the person's surface
  double fastest_mps = 0.0;
  double low_x_m = 1e9;
  double high_x_m = -1e9;
  Point2 end;
};

// A vehicle that stands in the origin, or drives along x from x0_m at speed_mps.
Walked Walk(World& world, double end_s, double yaw_rad, double x0_m = 0.0, double speed_mps = 0.0) {
  Walked walked;
  Point2 before = world.PersonAt(0, 0.0);
  for (int step = 1; step * kStep_s <= end_s; ++step) {
    const double time_s = step * kStep_s;
    const Bystander vehicle = {{x0_m + speed_mps * time_s, 0.0}, yaw_rad, speed_mps == 0.0, {}};
    LetPeopleWalk(world, time_s, kStep_s, vehicle);
    const Point2 now = world.PersonAt(0, time_s);
    const Contact contact = ContactOf(world, vehicle.place.x_m, vehicle.place.y_m, yaw_rad, time_s);
    walked.nearest_m = std::min(walked.nearest_m, contact.person_m);
    walked.fastest_mps = std::max(walked.fastest_mps, Apart(now, before) / kStep_s);
    walked.low_x_m = std::min(walked.low_x_m, now.x_m);
    walked.high_x_m = std::max(walked.high_x_m, now.x_m);
    before = now;
  }
  walked.end = before;
  return walked;
}

TEST(LetPeopleWalk, AWayThatNoVehicleIsNearIsWalkedAsItIs) {
  World world = WorldWith({0.1, -3.0}, {0.3, 7.0}, 9.0);
  for (int step = 1; step <= 12000; ++step) {
    const double time_s = step * kStep_s;
    LetPeopleWalk(world, time_s, kStep_s, {{4.0, 0.0}, 0.3, step % 2 == 0, {}});
    const Point2 planned = world.people()[0].At(time_s);
    ASSERT_EQ(world.PersonAt(0, time_s).x_m, planned.x_m);
    ASSERT_EQ(world.PersonAt(0, time_s).y_m, planned.y_m);
  }
}

TEST(LetPeopleWalk, SomebodyWhoseWayLeadsThroughAStandingVehicleGoesRoundItsRear) {
  for (const double yaw_rad : {0.0, 0.4, -0.3}) {
    World world = WorldWith({0.2, -4.0}, {-0.1, 4.0}, 6.0);
    const Walked walked = Walk(world, 14.0, yaw_rad);
    EXPECT_GE(walked.nearest_m, kKeptFromVehicle_m - 0.01) << yaw_rad;
    EXPECT_LE(walked.fastest_mps, kHurry_mps + 1e-6) << yaw_rad;
    EXPECT_LT(walked.low_x_m, -0.76) << "not behind it";
    EXPECT_LT(walked.high_x_m, 1.0) << "before it";
    EXPECT_NEAR(walked.end.x_m, -0.1, 1e-9) << yaw_rad;
    EXPECT_NEAR(walked.end.y_m, 4.0, 1e-9) << yaw_rad;
  }
}

TEST(LetPeopleWalk, NobodyComesNearerFromAnywhere) {
  Draws draws(7);
  for (int i = 0; i < 200; ++i) {
    const double from_rad = draws.Uniform(-3.1, 3.1);
    const Turn from = TurnOf(from_rad);
    const Turn to = TurnOf(from_rad + draws.Uniform(2.2, 4.0));
    World world = WorldWith({4.0 * from.cos, 4.0 * from.sin}, {4.0 * to.cos, 4.0 * to.sin},
                            draws.Uniform(4.0, 10.0));
    const Point2 goal = world.people()[0].At(100.0);
    const Walked walked = Walk(world, 24.0, draws.Uniform(-3.1, 3.1));
    ASSERT_GE(walked.nearest_m, kKeptFromVehicle_m - 0.01) << i;
    ASSERT_LE(walked.fastest_mps, kHurry_mps + 1e-6) << i;
    EXPECT_LE(Apart(walked.end, goal), 1e-9) << "number " << i << " did not get round";
  }
}

TEST(LetPeopleWalk, TheyWaitForAVehicleThatDrivesPast) {
  World world = WorldWith({0.0, -4.0}, {0.0, 4.0}, 6.0);
  const Walked walked = Walk(world, 8.0, 0.0, -3.0, 1.0);
  EXPECT_GE(walked.nearest_m, kKeptFromVehicle_m - 0.01);
  EXPECT_NEAR(walked.low_x_m, 0.0, 1e-9) << "nor do they go round it";
  EXPECT_NEAR(walked.end.y_m, 4.0, 1e-9);
}

TEST(LetPeopleWalk, NobodyJumpsOutOfTheWay) {
  World world = WorldWith({2.0, 0.1}, {2.0, 0.1}, 1.0);
  const Walked walked = Walk(world, 3.0, 0.0, 0.0, 1.0);
  EXPECT_LT(walked.nearest_m, 0.0);
  EXPECT_EQ(walked.fastest_mps, 0.0);
}

}  // namespace
}  // namespace hardpack::world
