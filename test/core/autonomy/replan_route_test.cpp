// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/autonomy/replanner.h"
#include "test/core/autonomy/replan_drive.h"

// A vehicle that drives by waypoints, of which the owner drops those that it has passed.

namespace hardpack {
namespace {

// What an owner of the list does: goals up to three places ahead, the next one where the vehicle
// has come within a metre of the present one.
struct RouteDrive {
  Drive drive;
  std::vector<Vec2> places;
  size_t at = 0;
  float slowest_mps = 1e9f;  // once it has been faster than 1 m/s, before the last 3 m
  bool was_fast = false;
  int stops = 0;

  explicit RouteDrive(std::vector<Vec2> all) : drive(all.back()), places(std::move(all)) {}

  void SetGoal() {
    PlanGoal goal;
    size_t last = at;
    for (; last + 1 < places.size() && last < at + 3; ++last) {
      static_cast<void>(goal.route.vias.PushBack({places[last], 0.0f}));
    }
    goal.position_odom = places[last];
    goal.number = static_cast<uint32_t>(last);
    drive.goal = goal;
  }

  void Tick() {
    const Vec2 place = places[at];
    const float way_m = std::hypot(drive.truth.x_m - place.x_m, drive.truth.y_m - place.y_m);
    const bool is_beyond = drive.truth.x_m >= place.x_m;
    if (at + 1 < places.size() && way_m < 2.0f && is_beyond) ++at;
    SetGoal();
    drive.Tick();
    if (drive.speed_mps > 1.0f) was_fast = true;
    const Vec2 end = places.back();
    const float left_m = std::hypot(drive.truth.x_m - end.x_m, drive.truth.y_m - end.y_m);
    if (was_fast && left_m > 3.0f) slowest_mps = std::min(slowest_mps, drive.speed_mps);
    if (drive.outcome().decision == ReplanDecision::kStop) ++stops;
  }

  bool Run(float limit_s) {
    drive.Start();
    for (int tick = 0; tick < static_cast<int>(100.0f * limit_s); ++tick) {
      Tick();
      const Vec2 end = places.back();
      const bool is_there = std::hypot(drive.truth.x_m - end.x_m, drive.truth.y_m - end.y_m) < 0.8f;
      if (is_there || ::testing::Test::HasFatalFailure()) return is_there;
    }
    return false;
  }
};

TEST(ReplanRoute, ALineOfPlacesIsDrivenAsIfThereWasNone) {
  RouteDrive route({{8.1f, 0.1f}, {16.1f, 0.1f}, {24.1f, 0.1f}, {32.1f, 0.1f}, {40.1f, 0.1f}});
  EXPECT_TRUE(route.Run(30.0f));
  EXPECT_EQ(route.at, 4u);
  EXPECT_EQ(route.stops, 0);
  EXPECT_GT(route.slowest_mps, 0.9f);
  // The path is carried on to the next places; it is not made anew when one has been passed.
  const ReplanCounters& counters = route.drive.replanner().counters();
  EXPECT_EQ(counters.replaced[static_cast<int>(ReplanReason::kGoalChanged)], 0u);
}

// SR-MIS05
TEST(ReplanRoute, AZigzagIsDrivenWithoutAStop) {
  RouteDrive route(
      {{8.1f, 0.1f}, {14.1f, 6.1f}, {20.1f, 0.1f}, {26.1f, 6.1f}, {32.1f, 0.1f}, {38.1f, 6.1f}});
  EXPECT_TRUE(route.Run(60.0f));
  EXPECT_EQ(route.stops, 0);
  EXPECT_GT(route.slowest_mps, 0.5f);
}

TEST(ReplanRoute, AHairpinIsDrivenWithAStop) {
  RouteDrive route({{12.1f, 0.1f}, {24.1f, 0.1f}, {26.1f, 8.1f}});
  EXPECT_TRUE(route.Run(60.0f));
  EXPECT_EQ(route.drive.committed().goal.number, 2u);
}

// A list of other places is another goal, though it ends at the same one.
TEST(ReplanRoute, AnotherListIsAnotherGoal) {
  RouteDrive route({{12.1f, 0.1f}, {24.1f, 0.1f}});
  route.drive.Start();
  for (int tick = 0; tick < 200; ++tick) route.Tick();
  const uint32_t number = route.drive.committed().number;
  ASSERT_NE(number, 0u);
  ++route.drive.goal.list;
  route.drive.goal.route.vias[0].position_odom.y_m = 5.1f;
  for (int tick = 0; tick < 100; ++tick) route.drive.Tick();
  EXPECT_NE(route.drive.committed().number, number);
  EXPECT_EQ(
      route.drive.replanner().counters().replaced[static_cast<int>(ReplanReason::kGoalChanged)],
      1u);
}

TEST(ReplanRoute, APlaceThatMovesFarIsAnotherGoal) {
  RouteDrive route({{12.1f, 0.1f}, {24.1f, 0.1f}});
  route.drive.Start();
  for (int tick = 0; tick < 200; ++tick) route.Tick();
  ASSERT_NE(route.drive.committed().number, 0u);
  const float little_m = 0.9f * route.drive.world.params.replan.goal_change_m;
  route.drive.goal.route.vias[0].position_odom.y_m += little_m;
  for (int tick = 0; tick < 60; ++tick) route.drive.Tick();
  const auto& replaced = route.drive.replanner().counters().replaced;
  EXPECT_EQ(replaced[static_cast<int>(ReplanReason::kGoalChanged)], 0u);
  route.drive.goal.route.vias[0].position_odom.y_m += 3.0f;
  for (int tick = 0; tick < 60; ++tick) route.drive.Tick();
  EXPECT_GE(replaced[static_cast<int>(ReplanReason::kGoalChanged)], 1u);
}

// SR-MIS04
TEST(ReplanRoute, TheCommittedSpeedsKeepEachLegsLimit) {
  RouteDrive route({{12.1f, 0.1f}, {40.1f, 0.1f}});
  route.drive.Start();
  for (int tick = 0; tick < 4000 && route.drive.truth.x_m < 39.0f; ++tick) {
    route.SetGoal();
    if (!route.drive.goal.route.vias.empty()) route.drive.goal.route.vias[0].speed_mps = 0.8f;
    route.drive.goal.route.goal_speed_mps = 2.0f;
    if (route.at == 0 && route.drive.truth.x_m > 12.1f) route.at = 1;
    route.drive.Tick();
    EXPECT_LE(route.drive.speed_mps, route.drive.truth.x_m < 11.9f ? 0.83f : 2.03f) << tick;
  }
  EXPECT_GT(route.drive.truth.x_m, 20.0f);
}

TEST(ReplanRoute, RefusesARouteThatIsNone) {
  Drive drive({20.1f, 0.1f});
  drive.Start();
  PlanGoal goal;
  goal.position_odom = {20.1f, 0.1f};
  ASSERT_EQ(goal.route.vias.PushBack({{10.1f, 0.1f}, 0.0f}), Status::kOk);
  EXPECT_EQ(drive.replanner().Update(1, {}, goal), Status::kInvalidArgument)
      << "its number is below that of its vias";
  goal.number = 1;
  EXPECT_EQ(drive.replanner().Update(1, {}, goal), Status::kOk);
  goal.route.vias[0].position_odom.x_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(drive.replanner().Update(2, {}, goal), Status::kNotFinite);
}

}  // namespace
}  // namespace hardpack
