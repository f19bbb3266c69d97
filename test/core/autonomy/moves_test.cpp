// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "core/kinematics/kinematics.h"
#include "test/core/autonomy/random_outlines.h"
#include "test/core/autonomy/scene.h"

// Plans that begin with several moves, and those that end before what cannot be driven.

namespace hardpack {
namespace {

int ChangesOf(const Plan& plan) {
  int changes = 0;
  for (int k = 1; k < plan.path.size(); ++k) {
    changes += IsReversed(plan.path, k) != IsReversed(plan.path, k - 1) ? 1 : 0;
  }
  return changes;
}

//   [====]  [ > ]  [====]      0.9 m to each, a wall beside it, and the goal behind the box ahead
//   #####################
Scene ParkingSpace() {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(-20, -4, -10, 4);
  scene.Add(9, -4, 20, 4);
  scene.Add(-40, -12, 60, -6);
  return scene;
}

// SR-PLN08
TEST(Moves, LeaveAParkingSpace) {
  const Scene scene = ParkingSpace();
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_GE(ChangesOf(plan), 1);
  EXPECT_GT(plan.lead_points, 2);
  EXPECT_GE(plan.slow_points, plan.lead_points);
  EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), 0.0);
  EXPECT_NEAR(plan.path.back().x_m, 15.1f, 0.3f);
  for (int k = 1; k < plan.path.size(); ++k) {
    const bool changes = IsReversed(plan.path, k) != IsReversed(plan.path, k - 1);
    EXPECT_FALSE(changes && plan.speed[k - 1] * plan.speed[k] > 0.0f) << "at speed";
    if (!IsReversed(plan.path, k)) continue;
    EXPECT_LE(plan.speed[k], scene.params.speed.max_reverse_mps + 1e-4f) << k;
  }
}

// 0.5 m ahead and 0.7 m behind: a move gains less than half a chord.
// SR-PLN08
TEST(Moves, LeaveATightParkingSpace) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(-20, -4, -8, 4);
  scene.Add(7, -4, 20, 4);
  scene.Add(-40, -12, 60, -6);
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_GE(ChangesOf(plan), 3);
  EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), 0.0);
  EXPECT_NEAR(plan.path.back().x_m, 15.1f, 0.3f);
}

// SR-PLN08
TEST(Moves, AreForAVehicleThatStandsAndMayReverse) {
  Scene scene = ParkingSpace();
  scene.params.path.reverse_out_m = 0.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
  scene.params.path.reverse_out_m = 24.0f;
  scene.request.start.speed_mps = 0.1f;
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
}

// SR-PLN03, SR-PLN08
TEST(Moves, AreTheSameForAnyPortions) {
  const Scene scene = ParkingSpace();
  const uint64_t hash = HashOf(PlanIn(scene));
  EXPECT_EQ(HashOf(PlanIn(scene, 1)), hash);
  EXPECT_EQ(HashOf(PlanIn(scene, 37)), hash);
}

// Steered wheels between two walls 5 m apart, the goal behind.
// SR-PLN05, SR-PLN06, SR-PLN08
TEST(Moves, TurnAVehicleWithSteeredWheelsAround) {
  Scene scene = SceneTo({-15.0f, 0.1f});
  MakeAckermann(scene);
  scene.Add(-120, 13, 120, 15);
  scene.Add(-120, -15, 120, -13);
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  EXPECT_GE(ChangesOf(plan), 1);
  EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), 0.0);
  EXPECT_LE(plan.check.largest_curvature_per_m, MostCurvature(scene.params.vehicle) * 1.011f);
  EXPECT_NEAR(plan.path.back().x_m, -15.0f, 0.3f);
}

// A corner too tight for steered wheels, 25 m ahead: the path ends before it, also at speed.
//   #################### |
//   [ > ]                |
//   #######################
// SR-PLN05
TEST(Moves, APathEndsBeforeWhatCannotBeDrivenFarAhead) {
  Scene scene = SceneTo({25.9f, 20.1f});
  MakeAckermann(scene);
  scene.Add(-30, 6, 124, 120);
  scene.Add(-30, -10, 140, -6);
  scene.Add(136, -6, 140, 120);
  scene.Add(-34, -10, -30, 10);
  for (const float speed_mps : {0.0f, 3.0f}) {
    scene.request.start.speed_mps = speed_mps;
    const Plan& plan = PlanIn(scene);
    ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
    EXPECT_EQ(plan.base_status, Status::kPathCut);
    EXPECT_GT(plan.path.back().x_m, 12.0f);
    EXPECT_LT(plan.path.back().x_m, 24.0f);
    EXPECT_LT(plan.path.back().y_m, 1.5f);
    EXPECT_EQ(plan.speed.back(), 0.0f);
    EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), 0.0);
  }
}

}  // namespace
}  // namespace hardpack
