// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

#include "core/autonomy/planner.h"
#include "test/core/autonomy/scene.h"
#include "test/not_finite.h"

// Portions, bad input, and the hash.

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// SR-PLN03
TEST(Planner, GivesTheSamePlanInAnyPortions) {
  Scene scene = SceneTo({12.1f, 0.1f});
  scene.Add(30, -256, 31, -5);  // a gap with little room
  scene.Add(30, 6, 31, 255);
  scene.Add(20, 20, 22, 22, Costmap::kPerson);
  const uint64_t whole = HashOf(PlanIn(scene));
  EXPECT_TRUE(ThePlanner().result().narrow);
  for (const int units : {1, 7, 64, 1000}) EXPECT_EQ(HashOf(PlanIn(scene, units)), whole) << units;
}

TEST(Planner, ForgetsThePlanBefore) {
  Scene blocked = SceneTo({20.1f, 0.1f});
  blocked.Add(-30, -30, 30, -29);
  blocked.Add(50, -256, 51, -5);
  blocked.Add(50, 6, 51, 255);
  const Scene open = SceneTo({-15.0f, 3.0f});
  const uint64_t first = HashOf(PlanIn(open));
  const uint64_t second = HashOf(PlanIn(blocked));
  EXPECT_NE(first, second);
  EXPECT_EQ(HashOf(PlanIn(open)), first);
  EXPECT_EQ(HashOf(PlanIn(blocked)), second);
}

// SR-PLN03
TEST(Planner, RefusesARequestThatIsNotFinite) {
  Planner& planner = ThePlanner();
  const std::vector<std::function<void(PlanRequest&, float)>> fields = {
      [](PlanRequest& r, float v) { r.start.pose.x_m = v; },
      [](PlanRequest& r, float v) { r.start.pose.y_m = v; },
      [](PlanRequest& r, float v) { r.start.pose.theta_rad = v; },
      [](PlanRequest& r, float v) { r.start.curvature_per_m = v; },
      [](PlanRequest& r, float v) { r.start.speed_mps = v; },
      [](PlanRequest& r, float v) { r.goal_odom.x_m = v; },
      [](PlanRequest& r, float v) { r.goal_odom.y_m = v; },
      [](PlanRequest& r, float v) {
        r.has_goal_heading = true;
        r.goal_heading_rad = v;
      }};
  for (const auto& set : fields) {
    for (const float bad : {kNaN, kInfinity, -kInfinity}) {
      PlanRequest request = SceneTo({5.0f, 0.0f}).request;
      set(request, bad);
      EXPECT_EQ(planner.BeginCells(kWindow, {}, request), Status::kNotFinite);
      EXPECT_EQ(planner.result().status, Status::kNotFinite);
      EXPECT_EQ(planner.StepCells(100), Progress::kDone);
    }
  }
  for (const float bad : {-1.0f, 1e9f}) {
    PlanRequest request = SceneTo({5.0f, 0.0f}).request;
    request.start.speed_mps = bad;
    EXPECT_EQ(planner.BeginCells(kWindow, {}, request), Status::kInvalidArgument);
    request.start = {};
    request.start.curvature_per_m = bad * 1e9f;
    EXPECT_EQ(planner.BeginCells(kWindow, {}, request), Status::kInvalidArgument);
  }
}

TEST(Planner, SurvivesExtremeRequests) {
  const float most = std::numeric_limits<float>::max();
  for (const float far : {1e6f, -3e9f, most, -most}) {
    Scene scene = SceneTo({far, -far});
    EXPECT_TRUE(IsUsable(PlanIn(scene).status)) << far;
    const PlanRequest from_there = SceneTo({0.0f, 0.0f}, {far, far, 0.0f}).request;
    EXPECT_EQ(ThePlanner().BeginCells(kWindow, {}, from_there), Status::kInvalidArgument) << far;
  }
  EXPECT_EQ(PlanIn(SceneTo({0.0f, 0.0f}, {-8e5f, 8e5f, 0.0f})).status, Status::kStartOutsideMap);
  for (const float curvature_per_m : {1e6f, -1e6f}) {
    Scene scene = SceneTo({5.0f, 0.0f});
    scene.request.start.curvature_per_m = curvature_per_m;
    EXPECT_EQ(PlanIn(scene).status, Status::kLimitExceeded) << curvature_per_m;
  }
}

// SR-PLN03
TEST(Planner, RefusesParametersOutOfRange) {
  Planner& planner = ThePlanner();
  const PlanRequest request = SceneTo({5.0f, 0.0f}).request;
  const std::vector<std::function<void(PlannerParams&)>> faults = {
      [](PlannerParams& p) { p.vehicle.length_m = kNaN; },
      [](PlannerParams& p) { p.vehicle.width_m = -0.1f; },
      [](PlannerParams& p) { p.vehicle.axle_offset_m = 0.8f; },
      [](PlannerParams& p) { p.vehicle.axle_offset_m = kNaN; },
      [](PlannerParams& p) { p.vehicle.skid_baseline_m = kInfinity; },
      [](PlannerParams& p) { p.costmap.planning_radius_m = -1.0f; },
      [](PlannerParams& p) { p.costmap.hard_slope_per_m = 1e9f; },
      [](PlannerParams& p) { p.speed.max_deceleration_mps2 = 0.0f; },
      [](PlannerParams& p) { p.speed.gamma_per_m = kNaN; },
      [](PlannerParams& p) { p.speed.min_speed_mps = 6.0f; },
      [](PlannerParams& p) { p.path.max_join_heading_rad = kNaN; }};
  for (size_t i = 0; i < faults.size(); ++i) {
    PlannerParams params;
    faults[i](params);
    EXPECT_EQ(planner.BeginCells(kWindow, params, request), Status::kParameterOutOfRange) << i;
    EXPECT_EQ(planner.result().status, Status::kParameterOutOfRange) << i;
    EXPECT_EQ(planner.StepCells(100), Progress::kDone) << i;
  }
}

TEST(Planner, MarksEveryDecisionInItsHash) {
  const Plan plan = PlanIn(SceneTo({20.1f, 3.1f}));
  const uint64_t hash = HashOf(plan);
  Plan other = plan;
  other.path[5].y_m += 1e-5f;
  EXPECT_NE(HashOf(other), hash);
  other = plan;
  other.speed[7] += 1e-5f;
  EXPECT_NE(HashOf(other), hash);
  other = plan;
  other.narrow = true;
  EXPECT_NE(HashOf(other), hash);
  other = plan;
  other.check.smallest_clearance_m -= 1e-5f;
  EXPECT_NE(HashOf(other), hash);
  other = plan;
  other.search.expansions += 1;
  EXPECT_NE(HashOf(other), hash);
}

}  // namespace
}  // namespace hardpack
