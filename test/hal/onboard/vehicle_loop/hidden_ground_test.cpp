// SPDX-License-Identifier: Apache-2.0
// Ground that no place has shown, behind the corner of a lane between walls and behind the brow of
// a hill: it is crept over, and a wheel that drops there stops the vehicle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "test/hal/onboard/vehicle_loop/closed_loop.h"
#include "tools/sim/world/contact.h"
#include "tools/sim/world/features.h"

namespace hardpack {
namespace {

using control::Kind;
using testing::ClosedLoop;

// A lane, 2.8 m wide, along x, that turns left around (12.6, 1.4); perhaps with a pit.
world::World LaneWithCorner(std::optional<world::Ditch> pit) {
  constexpr world::Bounds kBounds = {-20.0, -30.0, 40.0, 40.0};
  world::World lane(kBounds, world::Terrain(kBounds, [&](double x_m, double y_m) {
                      return pit ? -pit->Depth_m(x_m, y_m) : 0.0;
                    }));
  if (pit) lane.AddDitch(*pit);
  const auto add = [&](double x_m, double y_m, double length_m, bool is_across) {
    AddBoxOnGround(lane, {x_m, y_m}, is_across ? world::kPi / 2.0 : 0.0, length_m, 0.3, 2.0,
                   world::kWall);
  };
  add(3.3, 1.55, 18.6, false);
  add(4.85, -1.55, 21.7, false);
  add(12.45, 11.4, 20.0, true);
  add(15.55, 9.85, 23.1, true);
  add(-6.0, 0.0, 3.4, true);
  return lane;
}

struct Crept {
  double fastest_mps = 0.0;  // while the plan says that it creeps, but for its first second
  int ticks = 0;
  bool was_in_pit = false;
};

// Until it stands with a reason, has arrived, or for 90 s.
Crept DriveTo(ClosedLoop& drive, float x_m, float y_m) {
  Crept crept;
  drive.BringUpAndArm();
  EXPECT_EQ(drive.Goal(x_m, y_m), Status::kOk);
  drive.Ticks(100);
  for (int tick = 0; tick < 9000 && drive.mode() == Mode::kDriving; ++tick) {
    drive.Ticks(1);
    const sim::Pose pose = drive.Pose();
    crept.was_in_pit |=
        ContactOf(drive.vehicle().world(), pose.x_m, pose.y_m, pose.theta_rad, 0.0).in_ditch;
    if (!drive.loop().replanner().committed().creeps) continue;
    if (++crept.ticks < 100) continue;
    crept.fastest_mps = std::max(crept.fastest_mps, std::fabs(drive.Speed_mps()));
  }
  return crept;
}

// SR-SPD06
TEST(VehicleLoopHiddenGround, IsCreptOverBehindACorner) {
  ClosedLoop drive("", LaneWithCorner({}));
  const Crept crept = DriveTo(drive, 14.0f, 18.0f);
  EXPECT_NEAR(drive.Pose().x_m, 14.0, 0.5);
  EXPECT_NEAR(drive.Pose().y_m, 18.0, 0.5);
  EXPECT_GT(crept.ticks, 300);
  EXPECT_LT(crept.fastest_mps, drive.config().planner.speed.hidden_creep_mps + 0.05);
}

TEST(VehicleLoopHiddenGround, IsNotDrivenOverIfCreepingIsTurnedOff) {
  ClosedLoop drive("", LaneWithCorner({}));
  VehicleConfig config = drive.config();
  config.planner.speed.hidden_creep_mps = 0.0f;
  ASSERT_EQ(drive.loop().Configure(config), Status::kOk);
  const Crept crept = DriveTo(drive, 14.0f, 18.0f);
  EXPECT_EQ(drive.mode(), Mode::kDriving);
  EXPECT_EQ(drive.reason(), StopReason::kUnseenGround);
  EXPECT_EQ(crept.ticks, 0);
  EXPECT_LT(drive.Pose().y_m, 4.0);
}

// A pit right behind the corner, where the wall's shadow hides it until it is in the blind cone.
// SR-SPD07
TEST(VehicleLoopHiddenGround, AWheelThatDropsStopsItUntilItIsArmedAnew) {
  const world::Ditch pit = {{13.4, 2.6}, {13.4, 3.4}, 0.5, 0.6};
  ClosedLoop drive("", LaneWithCorner(pit));
  const Crept crept = DriveTo(drive, 14.0f, 18.0f);
  EXPECT_EQ(drive.reason(), StopReason::kGroundDrops);
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_FALSE(crept.was_in_pit) << "a wheel is halfway down";
  const sim::Pose stood = drive.Pose();
  ASSERT_EQ(drive.Goal(14.0f, 18.0f), Status::kOk);
  drive.Ticks(500);
  EXPECT_NEAR(drive.Pose().x_m, stood.x_m, 0.05);
  EXPECT_NEAR(drive.Pose().y_m, stood.y_m, 0.05);
}

// Up by 2 m, 3 m along the top, and down by 14 degrees; perhaps with a pit across the way.
world::World Hill(std::optional<world::Ditch> pit) {
  constexpr world::Bounds kBounds = {-20.0, -40.0, 70.0, 40.0};
  const auto height = [](double x_m) {
    const double up_m = 0.2 * std::clamp(x_m - 4.0, 0.0, 10.0);
    return up_m - 0.25 * std::clamp(x_m - 17.0, 0.0, 8.0);
  };
  world::World hill(kBounds, world::Terrain(kBounds, [&](double x_m, double y_m) {
                      return height(x_m) - (pit ? pit->Depth_m(x_m, y_m) : 0.0);
                    }));
  if (pit) hill.AddDitch(*pit);
  hill.SetFriction(0.6);
  return hill;
}

// SR-SPD09
TEST(VehicleLoopHiddenGround, IsCreptOverBehindABrow) {
  ClosedLoop drive("", Hill({}));
  const Crept crept = DriveTo(drive, 34.0f, 0.0f);
  EXPECT_NEAR(drive.Pose().x_m, 34.0, 1.0);
  EXPECT_NEAR(drive.Pose().y_m, 0.0, 1.0);
  EXPECT_GT(crept.ticks, 300);
  // Over the edge the vehicle runs ahead of its wheels a little.
  EXPECT_LT(crept.fastest_mps, drive.config().planner.speed.hidden_creep_mps + 0.1);
}

// A pit where the top ends: nothing tells it from a way down.
// SR-SPD07, SR-SPD09
TEST(VehicleLoopHiddenGround, AWheelThatDropsBehindABrowStopsIt) {
  const world::Ditch pit = {{18.0, -30.0}, {18.0, 30.0}, 1.0, 0.6};
  ClosedLoop drive("", Hill(pit));
  const Crept crept = DriveTo(drive, 34.0f, 0.0f);
  EXPECT_EQ(drive.reason(), StopReason::kGroundDrops);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_FALSE(crept.was_in_pit) << "a wheel is halfway down";
}

}  // namespace
}  // namespace hardpack
