// SPDX-License-Identifier: Apache-2.0
#include "core/committed_plan/path_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/speed/speed.h"

namespace hardpack {
namespace {

CommittedPlan PlanOf(const WorldPath& path) {
  CommittedPlan plan;
  plan.number = 1;
  plan.path = path;
  EXPECT_EQ(ToActuator<PlanarModel>(path, plan.actuator), Status::kOk);
  EXPECT_EQ(PlanSpeed({}, {}, plan.actuator, {}, plan.speed), Status::kOk);
  return plan;
}

// Of radius 8 m to the left, from the origin along x; in reverse: the vehicle looks back.
WorldPath Arc(bool reverse) {
  WorldPath path;
  for (int i = 0; i < 80; ++i) {
    const float angle = 0.25f / 8.0f * static_cast<float>(i);
    path.Resize(i + 1);
    path[i] = {8.0f * std::sin(angle), 8.0f * (1.0f - std::cos(angle)), 0.0f};
  }
  SetHeadingsFromChords(path);
  if (!reverse) return path;
  for (Pose2& pose : path) pose.theta_rad = WrapAngle(pose.theta_rad + kPi);
  return path;
}

TrackingInput TargetAt(const CommittedPlan& plan, const Pose2& pose, bool stands = false,
                       Status expected = Status::kOk) {
  const PathPlace place = Project(plan.path, pose, stands, 1000.0f);
  TrackingInput target;
  EXPECT_EQ(PathTarget(plan, {.pose = pose, .place = place, .speed_mps = 2.0f, .stands = stands},
                       {}, target),
            expected);
  return target;
}

TEST(PathTarget, SaysHowThePathBendsAndHowFarItGoes) {
  const CommittedPlan plan = PlanOf(Arc(false));
  const TrackingInput target = TargetAt(plan, plan.path[40]);
  EXPECT_FALSE(target.reverse);
  EXPECT_FALSE(target.turn);
  EXPECT_NEAR(target.turn_curvature_per_m, 1.0f / 8.0f, 1e-3f);
  EXPECT_NEAR(target.wheel_curvature_per_m, 1.0f / 8.0f, 1e-3f);
  EXPECT_NEAR(target.curvature_rate_per_m2, 0.0f, 1e-2f);
  EXPECT_NEAR(target.left_m, 0.25f * 39.0f, 0.02f);
  EXPECT_NEAR(target.path.theta_rad, 10.0f / 8.0f, 0.01f);
  EXPECT_GT(target.speed_limit_mps, 1.0f);
}

TEST(PathTarget, GivesAHeadingAndACurvatureThatAreTheVehiclesInReverse) {
  const CommittedPlan plan = PlanOf(Arc(true));
  const TrackingInput target = TargetAt(plan, plan.path[40]);
  EXPECT_TRUE(target.reverse);
  // Backwards to the left of the way driven is a turn to the right per metre of heading.
  EXPECT_NEAR(target.turn_curvature_per_m, -1.0f / 8.0f, 1e-3f);
  EXPECT_NEAR(WrapAngle(target.path.theta_rad - (10.0f / 8.0f - kPi)), 0.0f, 0.01f);
  // What is aimed at lies behind the vehicle.
  const SinCosPair heading = SinCos(target.path.theta_rad);
  EXPECT_LT(heading.cos * (target.aim.pose.x_m - target.path.x_m) +
                heading.sin * (target.aim.pose.y_m - target.path.y_m),
            -0.5f);
}

//   <----------[>]   and from there forward: the vehicle has to stand before it changes direction
WorldPath BackAndForth() {
  WorldPath path;
  for (int i = 0; i <= 20; ++i) {
    EXPECT_EQ(path.PushBack({-0.2f * static_cast<float>(i), 0.0f, 0.0f}), Status::kOk);
  }
  for (int i = 0; i <= 20; ++i) {
    EXPECT_EQ(path.PushBack({-4.0f + 0.2f * static_cast<float>(i), 0.0f, 0.0f}), Status::kOk);
  }
  return path;
}

// SR-STA06
TEST(PathTarget, DrivesForwardOnlyOnceItStandsWhereTheDirectionChanges) {
  const CommittedPlan plan = PlanOf(BackAndForth());
  const TrackingInput there = TargetAt(plan, {-3.0f, 0.02f, 0.0f});
  EXPECT_TRUE(there.reverse);
  EXPECT_NEAR(there.left_m, 1.0f, 1e-3f);
  EXPECT_NEAR(there.path.theta_rad, 0.0f, 1e-3f);
  const TrackingInput rolls = TargetAt(plan, {-3.9f, 0.0f, 0.0f}, false);
  EXPECT_TRUE(rolls.reverse);
  EXPECT_NEAR(rolls.left_m, 0.1f, 1e-3f);
  // Also with a heading that is not quite the path's: there is nothing to turn for.
  for (const float heading_rad : {0.0f, 0.3f}) {
    const TrackingInput back = TargetAt(plan, {-3.9f, 0.0f, heading_rad}, true);
    EXPECT_FALSE(back.reverse);
    EXPECT_FALSE(back.turn);
    EXPECT_GT(back.speed_limit_mps, 0.1f);
    EXPECT_NEAR(back.left_m, 4.0f, 1e-3f);
  }
}

TEST(PathTarget, SaysOfEachPlaceWhereTheVehicleLooks) {
  const CommittedPlan plan = PlanOf(BackAndForth());
  EXPECT_TRUE(StateAt(plan, 2.0f).reverse);
  EXPECT_NEAR(StateAt(plan, 2.0f).pose.theta_rad, 0.0f, 1e-4f);
  EXPECT_FALSE(StateAt(plan, 6.0f).reverse);
  EXPECT_NEAR(StateAt(plan, 6.0f).pose.theta_rad, 0.0f, 1e-4f);
  const CommittedPlan arc = PlanOf(Arc(true));
  EXPECT_NEAR(StateAt(arc, 10.0f).curvature_per_m, -1.0f / 8.0f, 1e-3f);
  float bends[8];
  CurvaturesFrom(arc, 1.0f, 0.5f, bends);
  for (const float bend_per_m : bends) EXPECT_NEAR(bend_per_m, -1.0f / 8.0f, 1e-3f);
}

//   [>]----------0=====0-----------   the plan stands there; what comes behind does not count
TEST(PathTarget, EndsWhereThePlanHasTheVehicleStand) {
  CommittedPlan plan = PlanOf(Arc(false));
  plan.speed[50] = 0.0f;
  plan.speed[51] = 0.0f;
  EXPECT_NEAR(TargetAt(plan, plan.path[40]).left_m, 0.25f * 10.0f, 0.02f);
  // A vehicle that stands at a point may be found on the chord before it.
  plan.speed[40] = 0.0f;
  EXPECT_NEAR(TargetAt(plan, plan.path[40]).left_m, 0.0f, 0.02f);
  plan.start_along_m = WayTo(plan.path, 40);
  EXPECT_NEAR(TargetAt(plan, plan.path[40]).left_m, 0.25f * 10.0f, 0.02f);
}

// A bend that tightens by 0.02 1/m in every metre.
TEST(PathTarget, LooksAheadForTheTurnAndFurtherForTheWheels) {
  WorldPath path;
  float x_m = 0.0f;
  float y_m = 0.0f;
  for (int i = 0; i < 60; ++i) {
    path.Resize(i + 1);
    path[i] = {x_m, y_m, 0.0f};
    const float middle_m = 0.25f * (static_cast<float>(i) + 0.5f);
    x_m += 0.25f * std::cos(0.01f * middle_m * middle_m);
    y_m += 0.25f * std::sin(0.01f * middle_m * middle_m);
  }
  SetHeadingsFromChords(path);
  const CommittedPlan plan = PlanOf(path);
  const PathFollower follower = {.pose = path[20],
                                 .place = Project(path, path[20], false, 1000.0f),
                                 .speed_mps = 2.0f,
                                 .turn_ahead_m = 1.0f,
                                 .wheel_ahead_m = 2.0f};
  TrackingInput target;
  ASSERT_EQ(PathTarget(plan, follower, {}, target), Status::kOk);
  EXPECT_NEAR(target.turn_curvature_per_m, 0.02f * 6.0f, 2e-3f);
  EXPECT_NEAR(target.wheel_curvature_per_m, 0.02f * 7.0f, 2e-3f);
  EXPECT_NEAR(target.curvature_rate_per_m2, 0.02f, 2e-3f);
}

TEST(PathTarget, TellsTheAccelerationOfTheSpeeds) {
  WorldPath line;
  for (int i = 0; i < 120; ++i) {
    line.Resize(i + 1);
    line[i] = {0.25f * static_cast<float>(i), 0.0f, 0.0f};
  }
  const CommittedPlan plan = PlanOf(line);
  EXPECT_NEAR(TargetAt(plan, {0.0f, 0.0f, 0.0f}).acceleration_mps2, 2.0f, 0.01f);
  EXPECT_NEAR(TargetAt(plan, {2.1f, 0.3f, 0.0f}).acceleration_mps2, 2.0f, 0.01f);
  EXPECT_NEAR(TargetAt(plan, {28.0f, 0.0f, 0.0f}).acceleration_mps2, -2.0f, 0.01f);
  EXPECT_EQ(TargetAt(plan, {29.75f, 0.0f, 0.0f}).speed_limit_mps, 0.0f);
  EXPECT_EQ(TargetAt(plan, {35.0f, 0.0f, 0.0f}).left_m, 0.0f);
}

//   0 --- 1 --- 2 (turn to the left) then up
// From 2 m/s^2 to -2 m/s^2 at one place: it begins to brake before it, and accelerates no earlier.
TEST(PathTarget, BeginsToBrakeGently) {
  CommittedPlan plan = PlanOf(Arc(false));
  const int peak = plan.path.size() / 2;
  const float step_m = WayTo(plan.path, 1);
  const auto speed_at = [&](int point) {
    const float to_peak_m = step_m * static_cast<float>(std::abs(point - peak));
    return Sqrt(16.0f - 4.0f * to_peak_m);
  };
  for (int k = 0; k < plan.path.size(); ++k) plan.speed[k] = speed_at(k);
  float before_mps2 = 2.1f;
  float steepest_mps2 = 0.0f;
  int eased = 0;
  for (int k = peak - 10; k < peak + 10; ++k) {
    const TrackingInput target = TargetAt(plan, plan.path[k]);
    steepest_mps2 = std::max(steepest_mps2, before_mps2 - target.acceleration_mps2);
    if (std::abs(target.acceleration_mps2) < 1.8f) ++eased;
    before_mps2 = target.acceleration_mps2;
    EXPECT_LE(target.acceleration_mps2, 2.05f);
    EXPECT_GE(target.acceleration_mps2, -2.05f);
  }
  EXPECT_GE(eased, 2);
  EXPECT_LT(steepest_mps2, 2.0f);
  EXPECT_NEAR(before_mps2, -2.0f, 0.05f);
}

TEST(PathTarget, TurnsOnTheSpotOnlyOnceTheVehicleStandsThere) {
  WorldPath path;
  path.Resize(5);
  path[0] = {0.0f, 0.0f, 0.0f};
  path[1] = {1.0f, 0.0f, 0.0f};
  path[2] = {2.0f, 0.0f, 0.0f};
  path[3] = {2.0f, 0.0f, kHalfPi};
  path[4] = {2.0f, 1.0f, kHalfPi};
  const CommittedPlan plan = PlanOf(path);
  const TrackingInput moving = TargetAt(plan, {1.9f, 0.0f, 0.0f});
  EXPECT_FALSE(moving.turn);
  EXPECT_NEAR(moving.left_m, 0.1f, 1e-4f);
  const TrackingInput standing = TargetAt(plan, {1.9f, 0.0f, 0.0f}, true);
  EXPECT_TRUE(standing.turn);
  EXPECT_NEAR(standing.aim.pose.theta_rad, kHalfPi, 1e-4f);
  EXPECT_EQ(standing.speed_limit_mps, 0.0f);
  EXPECT_FALSE(TargetAt(plan, {2.0f, 0.1f, kHalfPi}, true).turn);
}

// SR-SUP08: a vehicle that comes to a turn on the spot and rolls still steers straight on, whether
// it is before the place of the turn, at it, past it or already found to be at the turn: what the
// path looks like behind it would have it steer with all that the drives have, a stop too.
TEST(PathTarget, RollsOutStraightBeforeATurnOnTheSpot) {
  WorldPath path;
  path.Resize(5);
  path[0] = {0.0f, 0.0f, 0.0f};
  path[1] = {1.0f, 0.0f, 0.0f};
  path[2] = {2.0f, 0.0f, 0.0f};
  path[3] = {2.0f, 0.0f, 3.0f};
  path[4] = {1.0f, 0.1f, 3.0f};
  const CommittedPlan plan = PlanOf(path);
  for (const float x_m : {1.75f, 1.999f, 2.0f, 2.04f, 2.2f}) {
    for (const bool at_turn : {false, true}) {
      SCOPED_TRACE(x_m);
      const Pose2 pose = {x_m, 0.0f, 0.0f};
      const PathFollower follower = {.pose = pose,
                                     .place = Project(plan.path, pose, at_turn, 1000.0f),
                                     .speed_mps = 0.2f,
                                     .turn_ahead_m = 0.3f,
                                     .wheel_ahead_m = 0.5f};
      ASSERT_EQ(follower.place.point, at_turn ? 2 : 1);
      TrackingInput target;
      ASSERT_EQ(PathTarget(plan, follower, {}, target), Status::kOk);
      EXPECT_FALSE(target.turn);
      EXPECT_FALSE(target.reverse);
      EXPECT_NEAR(target.path.theta_rad, 0.0f, 1e-4f);
      EXPECT_NEAR(target.path.y_m, 0.0f, 1e-4f);
      EXPECT_NEAR(target.aim.pose.y_m, 0.0f, 1e-3f);
      EXPECT_GT(target.aim.pose.x_m, x_m + 0.2f);
      EXPECT_EQ(target.turn_curvature_per_m, 0.0f);
      EXPECT_EQ(target.wheel_curvature_per_m, 0.0f);
      EXPECT_EQ(target.curvature_rate_per_m2, 0.0f);
    }
  }
}

// Just so near to the turn as counts as there, and a little further away.
TEST(PathTarget, TurnsOnTheSpotFromAsFarAsItSays) {
  for (const float further_m : {0.0f, 1e-3f}) {
    const float turn_m = kAtPoint_m + further_m;
    WorldPath path;
    path.Resize(4);
    path[0] = {0.0f, 0.0f, 0.0f};
    path[1] = {turn_m, 0.0f, 0.0f};
    path[2] = {turn_m, 0.0f, kHalfPi};
    path[3] = {turn_m, 1.0f, kHalfPi};
    TrackingInput target;
    PathFollower follower;
    follower.stands = true;
    EXPECT_EQ(PathTarget(PlanOf(path), follower, {}, target), Status::kOk);
    EXPECT_EQ(target.turn, further_m == 0.0f);
  }
}

//   ----[>]--e - - x    x: as far from the vehicle as ever, although the path ends at e
TEST(PathTarget, AimsStraightOnBeyondTheEndInBothDirections) {
  const float heading_rad = 0.7f;
  const Vec2 way = {std::cos(heading_rad), std::sin(heading_rad)};
  for (const bool reverse : {false, true}) {
    WorldPath path;
    for (int i = 0; i < 20; ++i) {
      const float along_m = 0.25f * static_cast<float>(i);
      path.Resize(i + 1);
      path[i] = {along_m * way.x_m, along_m * way.y_m,
                 reverse ? WrapAngle(heading_rad + kPi) : heading_rad};
    }
    const Pose2& before_end = path[18];
    const TrackingInput target = TargetAt(PlanOf(path), before_end);
    const TrackingParams params;
    const float reach_m = std::max(params.min_lookahead_m, 2.0f * params.lookahead_s);
    ASSERT_GT(reach_m, 0.5f) << "or it does not reach beyond the end";
    EXPECT_EQ(target.reverse, reverse);
    EXPECT_NEAR(target.aim.pose.x_m, before_end.x_m + reach_m * way.x_m, 1e-3f);
    EXPECT_NEAR(target.aim.pose.y_m, before_end.y_m + reach_m * way.y_m, 1e-3f);
  }
}

// There and back: the change of direction is an end.
TEST(PathTarget, StandsWhereTheDirectionChanges) {
  WorldPath path;
  path.Resize(5);
  path[0] = {0.0f, 0.0f, 0.0f};
  path[1] = {1.0f, 0.0f, 0.0f};
  path[2] = {2.0f, 0.0f, 0.0f};
  path[3] = {1.0f, 0.2f, 0.0f};
  path[4] = {0.0f, 0.4f, 0.0f};
  path[2].theta_rad = 0.0f;  // of the chord behind it, driven in reverse
  const CommittedPlan plan = PlanOf(path);
  TrackingInput target;
  ASSERT_EQ(PathTarget(plan, {path[1], {0, 0.5f, 0.5f, 0.0f}, 1.0f, false}, {}, target),
            Status::kOk);
  EXPECT_FALSE(target.reverse);
  EXPECT_NEAR(target.left_m, 1.5f, 1e-3f);
  ASSERT_EQ(PathTarget(plan, {path[3], {2, 0.5f, 2.5f, 0.0f}, 1.0f, false}, {}, target),
            Status::kOk);
  EXPECT_TRUE(target.reverse);
}

TEST(PathTarget, TakesTwoPointsAndNoPathAtAll) {
  CommittedPlan plan;
  TrackingInput target;
  EXPECT_EQ(PathTarget(plan, {}, {}, target), Status::kPathTooShort);
  EXPECT_EQ(target.speed_limit_mps, 0.0f);
  WorldPath two;
  two.Resize(2);
  two[1] = {1.0f, 0.0f, 0.0f};
  plan = PlanOf(two);
  EXPECT_EQ(PathTarget(plan, {}, {}, target), Status::kOk);
  EXPECT_NEAR(target.left_m, 1.0f, 1e-5f);
  // A place that the path does not have, and speeds that belong to another path.
  EXPECT_EQ(PathTarget(plan, {{}, {1, 0.0f, 0.0f, 0.0f}, 0.0f, false}, {}, target),
            Status::kPathTooShort);
  EXPECT_EQ(PathTarget(plan, {{}, {-1, 0.0f, 0.0f, 0.0f}, 0.0f, false}, {}, target),
            Status::kPathTooShort);
  plan.speed.Clear();
  EXPECT_EQ(PathTarget(plan, {}, {}, target), Status::kPathTooShort);
}

}  // namespace
}  // namespace hardpack
