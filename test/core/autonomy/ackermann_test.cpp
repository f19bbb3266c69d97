// SPDX-License-Identifier: Apache-2.0
// Plans of a vehicle that cannot turn on the spot: whatever the map and the request, nothing bends
// more sharply than its wheels can be steered, nothing turns where it stands, and what it cannot
// drive is said to need a manoeuvre.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/kinematics/kinematics.h"
#include "test/core/autonomy/random_outlines.h"
#include "test/core/autonomy/scene.h"

namespace hardpack {
namespace {

double LargestCurvature(const WorldPath& path) {
  double largest = 0.0;
  for (int k = 1; k + 1 < path.size(); ++k) {
    const ActuatorStep before = PlanarModel::Inverse(path[k - 1], path[k]);
    const ActuatorStep after = PlanarModel::Inverse(path[k], path[k + 1]);
    const double turn_rad = std::abs(double{before.phi_rad});
    const double way_m = 0.5 * (std::abs(double{before.dr_m}) + std::abs(double{after.dr_m}));
    if (turn_rad > 1e-4) largest = std::max(largest, turn_rad / std::max(way_m, 1e-6));
  }
  return largest;
}

void ExpectDrivable(const Scene& scene, const Plan& plan) {
  const double most = double{MostCurvature(scene.params.vehicle)} * 1.011;
  EXPECT_LE(LargestCurvature(plan.path), most);
  EXPECT_FALSE(plan.pivots_first || plan.pivots_last);
  const Pose2& start = scene.request.start.pose;
  const Vec2 chord = {plan.path[1].x_m - plan.path[0].x_m, plan.path[1].y_m - plan.path[0].y_m};
  const float along_rad = HeadingOf(chord) + (IsReversed(plan.path, 0) ? kPi : 0.0f);
  EXPECT_LT(std::abs(WrapAngle(along_rad - start.theta_rad)), 0.12f) << "sets off sideways";
}

// SR-PLN05
TEST(Ackermann, DrivesAroundWhatStandsInTheWay) {
  Scene scene = SceneTo({20.1f, 0.1f});
  MakeAckermann(scene);
  scene.Add(45, -8, 55, 12);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  ExpectDrivable(scene, plan);
}

// SR-PLN05
TEST(Ackermann, TurnsAroundOnItsWayWhereThereIsRoom) {
  for (const Vec2 goal : {Vec2{-15.0f, 0.1f}, Vec2{-15.0f, 8.0f}, Vec2{-2.0f, -14.0f}}) {
    Scene scene = SceneTo(goal);
    MakeAckermann(scene);
    const Plan& plan = PlanIn(scene);
    ASSERT_TRUE(IsUsable(plan.status))
        << goal.x_m << ", " << goal.y_m << ": " << StatusName(plan.status);
    ExpectDrivable(scene, plan);
    EXPECT_GT(plan.lead_points, 0);
    EXPECT_NEAR(plan.path.back().x_m, goal.x_m, 0.3f);
    EXPECT_NEAR(plan.path.back().y_m, goal.y_m, 0.3f);
  }
}

// Walls 2 m to either side: the least circle is 3.1 m.
// SR-PLN06
TEST(Ackermann, SaysThatTheWayNeedsAManoeuvreWhereThereIsNone) {
  Scene scene = SceneTo({-15.0f, 0.1f});
  MakeAckermann(scene);
  scene.Add(-120, 10, 120, 12);
  scene.Add(-120, -12, 120, -10);
  scene.params.path.reverse_out_m = 0.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kNeedsManoeuvre);
  scene.params.vehicle.kinematics = VehicleParams::kSkidSteered;
  EXPECT_TRUE(IsUsable(PlanIn(scene).status)) << "the same with a turn on the spot";
}

// SR-PLN06
TEST(Ackermann, ATurnAtTheGoalNeedsAManoeuvre) {
  Scene scene = SceneTo({0.1f, 0.1f});
  MakeAckermann(scene);
  scene.request.start.pose = {0.1f, 0.1f, 0.0f};
  scene.request.has_goal_heading = true;
  scene.request.goal_heading_rad = 2.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kNeedsManoeuvre);
  scene.request.goal_heading_rad = 0.01f;
  EXPECT_TRUE(PlanIn(scene).stays) << StatusName(PlanIn(scene).status);
  // On the far side, facing back.
  scene.request.goal_odom = {15.1f, 0.1f};
  scene.request.goal_heading_rad = 3.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kNeedsManoeuvre);
  scene.request.goal_heading_rad = 0.4f;
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status));
  ExpectDrivable(scene, plan);
  EXPECT_NEAR(plan.path.back().theta_rad, 0.4f, 0.06f);
}

// A vehicle that moves has to come to rest before it leads out, as others before a turn.
// SR-PLN06
TEST(Ackermann, AGoalBehindOneThatMovesNeedsAManoeuvre) {
  Scene scene = SceneTo({-15.0f, 0.1f});
  MakeAckermann(scene);
  scene.request.start.speed_mps = 1.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kNeedsManoeuvre);
}

// SR-PLN05 SR-PLN06
TEST(Ackermann, NoPlanOnARandomMapIsBeyondItsSteering) {
  int usable = 0;
  int needs_manoeuvre = 0;
  int as_skid_steered = 0;
  constexpr int kMaps = 150;
  for (uint32_t seed = 1; seed <= kMaps; ++seed) {
    Scene scene = RandomOutline(seed);
    MakeAckermann(scene);
    const Plan& plan = PlanIn(scene);
    needs_manoeuvre += plan.status == Status::kNeedsManoeuvre ? 1 : 0;
    if (IsUsable(plan.status)) {
      ++usable;
      ExpectDrivable(scene, plan);
      if (!plan.check.start_overlaps && plan.lead_points == 0) {
        EXPECT_GT(SweptOutline(scene, plan).Clearance_m(), 0.0) << "seed " << seed;
      }
    }
    scene.params.vehicle.kinematics = VehicleParams::kSkidSteered;
    as_skid_steered += IsUsable(PlanIn(scene).status) ? 1 : 0;
  }
  RecordProperty("usable", usable);
  RecordProperty("needs_manoeuvre", needs_manoeuvre);
  RecordProperty("as_skid_steered", as_skid_steered);
  std::printf("%d of %d usable, %d need a manoeuvre; %d skid-steered\n", usable, kMaps,
              needs_manoeuvre, as_skid_steered);
  EXPECT_GT(usable, 0.8 * as_skid_steered);
}

}  // namespace
}  // namespace hardpack
