// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// How the whole drives its committed path: near it, and not beyond its end. The simulated wheels
// have the recorded dead time and lag, each side by itself.

namespace hardpack {
namespace {

using testing::ClosedLoop;

struct Figures {
  double off_m = 0.0;  // of the committed path, at most
  double fastest_mps = 0.0;
  double furthest_x_m = 0.0;
};

// The simulated motors' own limit: a tracker that takes them for faster ones asks both sides for
// more than they do, and cannot turn then.
void KnowTheWheels(ClosedLoop& drive) {
  const auto config = std::make_unique<VehicleConfig>(drive.config());
  config->planner.vehicle.max_wheel_speed_radps = 13.4f;
  ASSERT_EQ(drive.loop().Configure(*config), Status::kOk);
}

Figures DriveToRest(ClosedLoop& drive) {
  Figures figures;
  EXPECT_TRUE(drive.Until(60.0, [&] {
    const VehicleLoop& loop = drive.loop();
    if (loop.replanner().committed().number != 0) {
      const double off_m = static_cast<double>(loop.replanner().place().cross_track_m);
      figures.off_m = std::max(figures.off_m, off_m);
    }
    figures.fastest_mps = std::max(figures.fastest_mps, drive.Speed_mps());
    figures.furthest_x_m = std::max(figures.furthest_x_m, drive.Pose().x_m);
    return drive.mode() == Mode::kArmed;
  }));
  drive.Ticks(100);
  figures.furthest_x_m = std::max(figures.furthest_x_m, drive.Pose().x_m);
  return figures;
}

TEST(VehicleLoopDriving, EndsWhereItsPathEnds) {
  ClosedLoop drive;
  KnowTheWheels(drive);
  drive.DriveTo(30.0f, 0.0f);
  const Figures figures = DriveToRest(drive);
  std::printf("  to 30 m: %.2f m/s, %.3f m off, to %.3f m\n", figures.fastest_mps, figures.off_m,
              figures.furthest_x_m);
  EXPECT_GT(figures.fastest_mps, 3.0);
  EXPECT_LT(figures.furthest_x_m, 30.1);
  EXPECT_GT(figures.furthest_x_m, 29.6);
  EXPECT_LT(figures.off_m, 0.1);
}

//      start ------> [box] ------> goal
TEST(VehicleLoopDriving, KeepsToItsPathAroundWhatStandsInTheWay) {
  ClosedLoop drive("at 0 box 10 0 1.5 1.5");
  KnowTheWheels(drive);
  drive.DriveTo(24.0f, 0.0f);
  const Figures figures = DriveToRest(drive);
  std::printf("  around a box: %.2f m/s, %.3f m off\n", figures.fastest_mps, figures.off_m);
  EXPECT_FALSE(drive.vehicle().collided());
  EXPECT_LT(figures.off_m, 0.25);
}

// Without the tracker's knowledge of the drives, as it was.
TEST(VehicleLoopDriving, PurePursuitDrivesToo) {
  ClosedLoop drive;
  const auto config = std::make_unique<VehicleConfig>(drive.config());
  config->onboard.tracking.method = TrackingParams::kPurePursuit;
  ASSERT_EQ(drive.loop().Configure(*config), Status::kOk);
  drive.DriveTo(12.0f, 0.0f);
  const Figures figures = DriveToRest(drive);
  EXPECT_NEAR(drive.Pose().x_m, 12.0, 1.0);
  EXPECT_LT(figures.off_m, 0.5);
}

// What a plan takes to stop is not to be less than what the drives need.
// SR-SPD04
TEST(VehicleLoopDriving, RefusesDrivesThatAreSlowerThanThePlansBelieve) {
  ClosedLoop drive;
  const auto config = std::make_unique<VehicleConfig>(drive.config());
  config->onboard.dynamics.dead_time_s = 0.25f;
  EXPECT_EQ(drive.loop().Configure(*config), Status::kParameterOutOfRange);
  config->onboard.dynamics.dead_time_s = 0.14f;
  // The drives' lag and that of the body behind them, 0.3 s.
  config->onboard.dynamics.common_lag_s = 0.29f;
  EXPECT_EQ(drive.loop().Configure(*config), Status::kParameterOutOfRange);
  config->planner.speed.stopping_lag_s = 0.6f;
  EXPECT_EQ(drive.loop().Configure(*config), Status::kOk);
}

}  // namespace
}  // namespace hardpack
