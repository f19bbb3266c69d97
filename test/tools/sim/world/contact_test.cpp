// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/contact.h"

#include <cmath>

#include "gtest/gtest.h"
#include "tools/sim/world/features.h"

// The outline is 1.52 x 1.38 m: 0.76 m to the front, 0.69 m to either side.

namespace hardpack::world {
namespace {

double Hard(const World& world, double x_m, double y_m, double yaw_rad = 0.0) {
  return ContactOf(world, x_m, y_m, yaw_rad, 0.0).hard_m;
}

TEST(Contact, IsFarFromNothing) {
  const Contact contact = ContactOf(World(), 1.0, 2.0, 0.3, 0.0);
  EXPECT_EQ(contact.hard_m, Contact::kFar_m);
  EXPECT_EQ(contact.person_m, Contact::kFar_m);
  EXPECT_FALSE(contact.touches() || contact.in_ditch || contact.too_steep());
  EXPECT_EQ(contact.slope, 0.0);
}

TEST(Contact, MeasuresToBoxes) {
  World world;
  world.AddBox({5.5, 0.0}, 0.0, 1.0, 2.0, -0.5, 1.0, kThing);
  EXPECT_NEAR(Hard(world, 0.0, 0.0), 4.24, 1.0e-9);
  EXPECT_NEAR(Hard(world, 4.3, 0.0), -0.06, 1.0e-9);
  EXPECT_NEAR(Hard(world, 4.3, 0.0, M_PI / 2.0), 0.01, 1.0e-9) << "across it is narrower";
  // Corner to corner: 0.24 ahead, 0.31 to the side.
  EXPECT_NEAR(Hard(world, 4.0, 2.0), std::hypot(0.24, 0.31), 1.0e-9);
  // A corner of the turned outline towards the face.
  const double reach_m = std::hypot(0.76, 0.69);
  EXPECT_NEAR(Hard(world, 3.0, 0.0, -std::atan2(0.69, 0.76)), 2.0 - reach_m, 1.0e-9);
  EXPECT_TRUE(ContactOf(world, 5.5, 0.0, 0.7, 0.0).touches()) << "in the middle of it";
}

TEST(Contact, MeasuresToTreesAndRocks) {
  World world;
  AddTree(world, {0.0, 5.0}, 0.2, 1.5);
  EXPECT_NEAR(Hard(world, 0.0, 0.0), 5.0 - 0.69 - 0.2, 1.0e-9);
  EXPECT_NEAR(Hard(world, 0.5, 4.6), -0.26 - 0.2, 1.0e-9);
  World rock;
  // At the height of its middle, 2 m, it is 2 m wide; where the vehicle's top is, less.
  rock.AddEllipsoid({5.0, 0.0, 2.0}, 2.0, 1.0, kRock);
  const double radius_m = 2.0 * std::sqrt(1.0 - 0.25);
  EXPECT_NEAR(Hard(rock, 0.0, 0.0), 5.0 - 0.76 - radius_m, 1.0e-9);
}

TEST(Contact, DrivesOverAndUnder) {
  World world;
  world.AddBox({0.0, 0.0}, 0.0, 1.0, 1.0, -0.5, 0.05, kThing);
  world.AddBox({0.0, 0.0}, 0.0, 1.0, 1.0, 1.6, 2.0, kThing);
  EXPECT_EQ(Hard(world, 0.0, 0.0), Contact::kFar_m);
}

TEST(Contact, MeetsFencesButNotLeaves) {
  World world;
  AddFence(world, {3.0, -5.0}, {3.0, 5.0});
  AddBush(world, {0.0, 1.0}, 0.8, 1.0);
  const Contact contact = ContactOf(world, 0.0, 0.0, 0.0, 0.0);
  EXPECT_NEAR(contact.hard_m, 3.0 - 0.76 - 0.05, 1.0e-6) << "a post";
  EXPECT_NEAR(contact.foliage_m, 1.0 - 0.69 - 0.8, 0.05);
  EXPECT_FALSE(contact.touches());
  EXPECT_TRUE(ContactOf(world, 2.4, 1.25, 0.0, 0.0).touches()) << "the mesh";
}

// A rock of 0.2 m beside the lower wheels lies 0.1 m lower than the ground under the middle.
TEST(Contact, MeetsWhatIsLowOnASlope) {
  constexpr Bounds kAround = {-10.0, -10.0, 10.0, 10.0};
  World world(kAround, Terrain(kAround, [](double, double y_m) { return 0.3 * y_m; }));
  AddBoxOnGround(world, {0.0, -0.9}, 0.0, 0.6, 0.6, 0.2, kRock);
  EXPECT_TRUE(ContactOf(world, 0.0, 0.0, 0.0, 0.0).touches());
  EXPECT_NEAR(Hard(world, 0.0, 0.5), 0.9 - 0.3 + 0.5 - 0.69, 1.0e-6);
}

TEST(Contact, MeetsPeopleAtTheirTime) {
  World world;
  Person person;
  person.places = {{0.0, 0.0, 4.0}, {4.0, 0.0, 0.0}};
  world.AddPerson(person);
  EXPECT_NEAR(ContactOf(world, 0.0, 0.0, 0.0, 1.0).person_m, 3.0 - 0.69 - 0.25, 1.0e-9);
  EXPECT_TRUE(ContactOf(world, 0.0, 0.0, 0.0, 3.5).touches());
  EXPECT_EQ(ContactOf(world, 0.0, 0.0, 0.0, 3.5).hard_m, Contact::kFar_m);
}

TEST(Contact, TellsDitchesAndSlopes) {
  const Ditch ditch = {{10.0, -5.0}, {10.0, 5.0}, 1.5, 1.0};
  World world({}, Terrain({}, [&](double x_m, double y_m) {
                return (x_m < 0.0 ? -1.2 * x_m : 0.0) - ditch.Depth_m(x_m, y_m);
              }));
  world.AddDitch(ditch);
  EXPECT_NEAR(world.GroundHeight_m(10.0, 0.0), -1.0, 1.0e-6);
  EXPECT_NEAR(world.GroundHeight_m(11.0, 0.0), -0.5, 1.0e-6) << "half way up the bank";
  EXPECT_EQ(ditch.Depth_m(10.0, 6.5), 0.0) << "beyond its end";
  EXPECT_FALSE(ContactOf(world, 8.0, 0.0, 0.0, 0.0).in_ditch);
  EXPECT_TRUE(ContactOf(world, 9.0, 0.0, 0.0, 0.0).in_ditch) << "its front wheels";
  EXPECT_FALSE(ContactOf(world, 5.0, 0.0, 0.0, 0.0).too_steep());
  const Contact on_slope = ContactOf(world, -5.0, 0.0, 0.4, 0.0);
  EXPECT_NEAR(on_slope.slope, 1.2, 1.0e-6);
  EXPECT_NEAR(on_slope.under_wheel, 1.2, 1.0e-6);
  EXPECT_TRUE(on_slope.too_steep());
}

TEST(StandingPose, LiesOnThePlaneUnderTheWheels) {
  const World world({}, Terrain({}, [](double x_m, double y_m) { return 0.1 * x_m - 0.2 * y_m; }));
  for (const double yaw_rad : {0.0, 1.0, -2.5}) {
    const BodyPose pose = StandingPose(world, 3.0, -4.0, yaw_rad);
    EXPECT_NEAR(pose.position.z_m, 1.1, 1.0e-6);
    const Vector up =
        Rotation::FromAngles(pose.roll_rad, pose.pitch_rad, pose.yaw_rad).Apply({0.0, 0.0, 1.0});
    EXPECT_NEAR(up.x_m / up.z_m, -0.1, 1.0e-5);
    EXPECT_NEAR(up.y_m / up.z_m, 0.2, 1.0e-5);
  }
}

// A vehicle whose place is its rear axle.
TEST(Contact, OfAnOutlineThatIsAheadOfTheVehiclesPlace) {
  const Footprint footprint = {2.0, 1.4, 0.6, 0.6, 0.6, 0.6};
  World world;
  AddBoxOnGround(world, {3.0, 0.0}, 0.0, 1.0, 1.0, 1.4, kThing);
  EXPECT_NEAR(ContactOf(world, 0.0, 0.0, 0.0, 0.0, footprint).hard_m, 2.5 - 1.6, 1.0e-9);
  EXPECT_NEAR(ContactOf(world, 6.0, 0.0, kPi, 0.0, footprint).hard_m, 2.5 - 1.6, 1.0e-9);
  EXPECT_NEAR(ContactOf(world, 5.0, 0.0, 0.0, 0.0, footprint).hard_m, 1.5 - 0.4, 1.0e-9);
  const World slope({}, Terrain({}, [](double x_m, double y_m) { return 0.1 * x_m - 0.2 * y_m; }));
  const BodyPose pose = StandingPose(slope, 3.0, -4.0, 0.7, footprint);
  EXPECT_NEAR(pose.position.z_m, 1.1, 1.0e-6) << "at its place, not at its middle";
}

}  // namespace
}  // namespace hardpack::world
