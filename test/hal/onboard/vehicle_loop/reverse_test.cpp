// SPDX-License-Identifier: Apache-2.0
// Out of a blind alley in reverse, with the whole chain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "test/hal/onboard/vehicle_loop/closed_loop.h"
#include "tools/sim/world/features.h"

namespace hardpack {
namespace {

using testing::ClosedLoop;

//   ###############
//        [ > ]    #     2.4 m wide, from x = -6 to 2 m; the vehicle at the origin
//   ###############
world::World BlindAlley() {
  constexpr world::Bounds kBounds = {-30.0, -20.0, 20.0, 20.0};
  world::World alley(kBounds, world::Terrain(kBounds, [](double, double) { return 0.0; }));
  const auto add = [&](double x_m, double y_m, double yaw_rad, double length_m) {
    AddBoxOnGround(alley, {x_m, y_m}, yaw_rad, length_m, 0.3, 2.0, world::kWall);
  };
  add(-2.0, 1.35, 0.0, 8.0);
  add(-2.0, -1.35, 0.0, 8.0);
  add(2.15, 0.0, world::kPi / 2.0, 3.0);
  return alley;
}

std::string BoxAt(double x_m, double y_m) {
  return "at 0 box " + std::to_string(x_m) + " " + std::to_string(y_m) + " 0.5 1.7";
}

bool DrivesBack(ClosedLoop& drive) {
  return drive.Speed_mps() < -0.25;
}

// SR-STA04, SR-STA06
TEST(VehicleLoopReverse, BacksOutOfABlindAlleyAndDrivesOn) {
  ClosedLoop drive("", BlindAlley());
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(-14.0f, 6.0f), Status::kOk);
  drive.Ticks(50);
  double fastest_back_mps = 0.0;
  double farthest_back_m = 0.0;
  EXPECT_TRUE(drive.Until(90.0, [&] {
    fastest_back_mps = std::min(fastest_back_mps, drive.Speed_mps());
    if (DrivesBack(drive)) farthest_back_m = std::min(farthest_back_m, drive.Pose().x_m);
    return drive.mode() == Mode::kArmed;
  }));
  EXPECT_NEAR(drive.Pose().x_m, -14.0, 0.7);
  EXPECT_NEAR(drive.Pose().y_m, 6.0, 0.7);
  EXPECT_LT(farthest_back_m, -5.5);
  EXPECT_LT(fastest_back_mps, -0.4);
  EXPECT_GT(fastest_back_mps, -0.6);
  EXPECT_FALSE(drive.vehicle().collided());
}

// SR-STA05
TEST(VehicleLoopReverse, StopsForWhatAppearsBehindIt) {
  ClosedLoop drive("", BlindAlley());
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(-14.0f, 6.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(20.0, [&] { return DrivesBack(drive); }));
  const double box_x_m = drive.Pose().x_m - 2.5;
  drive.Act(BoxAt(box_x_m, 0.0));
  ASSERT_TRUE(drive.Until(6.0, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }));
  drive.Ticks(300);
  EXPECT_FALSE(drive.vehicle().collided());
  EXPECT_GT(drive.Pose().x_m - 0.76, box_x_m + 0.25);
}

// SR-STA05
TEST(VehicleLoopReverse, StaysWhereTheSelfFilterHidesWhatIsBehind) {
  ClosedLoop drive("", BlindAlley());
  VehicleConfig config = drive.config();
  config.perception.mount.self_min_x_m = -1.4f;
  ASSERT_EQ(drive.loop().Configure(config), Status::kOk);
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(-14.0f, 6.0f), Status::kOk);
  drive.Ticks(600);
  EXPECT_NEAR(drive.Pose().x_m, 0.0, 0.05);
  EXPECT_EQ(drive.reason(), StopReason::kNoWay);
}

}  // namespace
}  // namespace hardpack
