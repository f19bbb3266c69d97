// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "core/autonomy/replanner.h"
#include "test/core/autonomy/scene.h"

// A vehicle that drives what a Replanner commits, over a plane of blocks, tick by tick; and what
// every round owes, whatever happens.

namespace hardpack {

// The one replanner of these tests: 3.8 MiB.
inline Replanner& TheReplanner() {
  static const std::unique_ptr<Replanner> replanner = std::make_unique<Replanner>();
  return *replanner;
}

struct Drive {
  static constexpr float kTick_s = 0.01f;

  Scene world;  // its blocks and parameters
  PlanGoal goal;
  Pose2 truth;
  float speed_mps = 0.0f;
  float along_m = 0.0f;  // of truth, on the committed path
  uint64_t now_ns = 1'000'000'000u;
  int units = 500;  // a tick
  float jitter_m = 0.0f;
  float jitter_rad = 0.0f;
  bool map_flickers = false;  // each block's sides move by a cell from round to round
  bool follows = true;        // else it stands where it is, whatever is committed
  std::mt19937 random{1};
  VehicleState state;  // as told to the replanner
  int rounds = 0;
  std::function<void()> on_round;  // after each, before the vehicle moves on

  explicit Drive(Vec2 goal_odom, Pose2 start = {0.1f, 0.1f, 0.0f}) : truth(start) {
    goal.position_odom = goal_odom;
  }

  Replanner& replanner() { return TheReplanner(); }
  const CommittedPlan& committed() { return replanner().committed(); }
  const ReplanOutcome& outcome() { return replanner().outcome(); }

  void Start() {
    replanner() = Replanner{};
    ASSERT_EQ(replanner().Configure(world.params), Status::kOk);
  }

  float Noise(float size) { return std::uniform_real_distribution<float>(-size, size)(random); }

  void SetWorld(const GridWindow& window) {
    for (Block block : world.blocks) {
      if (map_flickers) {
        block.low.x -= static_cast<int>(random() & 1u);
        block.low.y -= static_cast<int>(random() & 1u);
        block.high.x += static_cast<int>(random() & 1u);
        block.high.y += static_cast<int>(random() & 1u);
      }
      for (int y = block.low.y; y <= block.high.y; ++y) {
        for (int x = block.low.x; x <= block.high.x; ++x) {
          if (!window.Contains({x, y})) continue;
          replanner().costmap_builder().SetCell(window.Index({x, y}), block.flags);
        }
      }
    }
  }

  // One tick: the state, some planning, and the way that the vehicle drives meanwhile.
  void Tick() {
    now_ns += 10'000'000u;
    const PathState here = StateAt(committed(), along_m);
    state.pose = {truth.x_m + Noise(jitter_m), truth.y_m + Noise(jitter_m),
                  truth.theta_rad + Noise(jitter_rad)};
    state.curvature_per_m = here.curvature_per_m;
    state.speed_mps = speed_mps;
    if (here.reverse) state.driven_mps = -speed_mps;
    ASSERT_EQ(replanner().Update(now_ns, state, goal), Status::kOk);
    if (!replanner().busy()) {
      const GridWindow window = GridWindow::CenteredAt({state.pose.x_m, state.pose.y_m});
      ASSERT_EQ(replanner().BeginCells(window), Status::kOk);
      SetWorld(window);
    }
    const CommittedPlan before = committed();
    if (replanner().StepCells(units) == Progress::kDone) EndRound(before);
    Move();
  }

  void EndRound(const CommittedPlan& before) {
    ++rounds;
    ExpectSoundRound();
    if (committed().number != 0) {
      along_m = Project(committed().path, truth, speed_mps < 0.05f, 20.0f).along_m;
      const bool joins = before.number != 0 && replanner().place().cross_track_m < 0.3f &&
                         !BeginsWithTurn(committed().path) && !BeginsWithTurn(before.path);
      if (joins && outcome().reason != ReplanReason::kOffPath) ExpectJoined(before);
    }
    if (on_round) on_round();
  }

  // On the committed path between two places along x.
  float SlowestBetween(float from_x_m, float to_x_m) {
    const CommittedPlan& plan = committed();
    float slowest_mps = 1e9f;
    for (int k = 0; k < plan.path.size(); ++k) {
      const bool is_there = plan.path[k].x_m > from_x_m && plan.path[k].x_m < to_x_m;
      if (is_there) slowest_mps = std::min(slowest_mps, plan.speed[k]);
    }
    return slowest_mps;
  }

  // Where it turns on the spot, nothing is joined: it stands.
  static bool BeginsWithTurn(const WorldPath& path) {
    return TurnsOnTheSpotAt(path, 0) || TurnsOnTheSpotAt(path, 1) || TurnsOnTheSpotAt(path, 2);
  }

  // Ends at rest, starts at the vehicle's speed, keeps the acceleration limits, and is clear of
  // every block.
  void ExpectSoundRound() {
    const CommittedPlan& plan = committed();
    if (plan.number == 0) return;
    ASSERT_GE(plan.path.size(), 2);
    ASSERT_EQ(plan.speed.size(), plan.path.size());
    ASSERT_EQ(plan.actuator.steps.size(), plan.path.size() - 1);
    if (!plan.is_stop) {
      EXPECT_EQ(plan.speed.back(), 0.0f) << "round " << rounds;
    }
    // At a turn on the spot there is none.
    const float tolerance_mps = state.speed_mps < Replanner::kStanding_mps ? 0.05f : 0.02f;
    EXPECT_NEAR(StateAt(plan, replanner().place().along_m).speed_mps, state.speed_mps,
                tolerance_mps)
        << "round " << rounds;
    const float limit = 1.001f * world.params.speed.max_acceleration_mps2;
    for (int k = 0; k + 1 < plan.path.size(); ++k) {
      const float behind_m = std::max(0.0f, plan.start_along_m - WayTo(plan.path, k));
      const float way_m = std::max(0.0f, std::abs(plan.actuator.steps[k].dr_m) - behind_m);
      const float gain = plan.speed[k + 1] * plan.speed[k + 1] - plan.speed[k] * plan.speed[k];
      EXPECT_LE(std::abs(gain), 2.0f * limit * way_m + 0.003f) << "round " << rounds << ", " << k;
    }
  }

  // Where the vehicle is, the old plan and the new one say the same.
  void ExpectJoined(const CommittedPlan& before) {
    const PathState is = StateAt(committed(), along_m);
    const PathState was = StateAt(before, Project(before.path, truth, false, 50.0f).along_m);
    EXPECT_NEAR(is.pose.x_m, was.pose.x_m, 0.005f) << "round " << rounds;
    EXPECT_NEAR(is.pose.y_m, was.pose.y_m, 0.005f) << "round " << rounds;
    EXPECT_NEAR(WrapAngle(is.pose.theta_rad - was.pose.theta_rad), 0.0f, 0.02f)
        << "round " << rounds;
    EXPECT_NEAR(is.curvature_per_m, was.curvature_per_m, 0.05f) << "round " << rounds;
  }

  // Along the committed path, at its speeds; turns on the spot are made at once.
  void Move() {
    if (!follows || committed().number == 0) {
      speed_mps = std::max(0.0f, speed_mps - 2.0f * kTick_s);
      return;
    }
    const WorldPath& path = committed().path;
    const PathPlace place = Project(path, truth, speed_mps < 0.05f, along_m + 2.0f);
    if (speed_mps < 0.05f && TurnsOnTheSpotAt(path, place.point)) {
      truth.theta_rad = path[place.point + 1].theta_rad;
      return;
    }
    const float target_mps = StateAt(committed(), along_m + 0.02f + 0.01f * speed_mps).speed_mps;
    const float most = 2.1f * kTick_s;
    speed_mps = std::clamp(target_mps, speed_mps - most, speed_mps + most);
    const float last_m = WayTo(path, StandingPoint(path, place.point));
    along_m = std::min(along_m + speed_mps * kTick_s, last_m);
    if (along_m >= last_m) speed_mps = 0.0f;
    const PathState at = StateAt(committed(), along_m);
    if (along_m < last_m || last_m > 0.0f) truth = at.pose;
  }

  // Least distance of the footprint where it is to any block.
  double Clearance() {
    return OutlineClearance_m(world, double{truth.x_m}, double{truth.y_m}, double{truth.theta_rad});
  }

  float ToGoal() {
    return std::hypot(truth.x_m - goal.position_odom.x_m, truth.y_m - goal.position_odom.y_m);
  }

  // The last metre takes long: no faster than what stops within it.
  bool Arrived() { return ToGoal() < 0.8f && committed().reaches_goal; }

  // Ticks until it has arrived, at most so many seconds. Returns the least clearance on the way.
  double DriveToGoal(float limit_s) {
    const int ticks = static_cast<int>(limit_s / kTick_s);
    double clearance = 1e9;
    for (int tick = 0; tick < ticks && !Arrived(); ++tick) {
      Tick();
      clearance = std::min(clearance, Clearance());
      if (::testing::Test::HasFatalFailure()) break;
    }
    return clearance;
  }

  int Replaced() {
    int replaced = 0;
    for (const uint32_t count : replanner().counters().replaced)
      replaced += static_cast<int>(count);
    return replaced;
  }
};

}  // namespace hardpack
