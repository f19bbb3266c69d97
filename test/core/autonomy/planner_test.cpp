// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/base/math.h"

namespace hardpack {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr GridWindow kWindow{{-256, -256}};

// Cells low .. high, both included.
struct Block {
  Cell low;
  Cell high;
  uint8_t flags;
};

struct Scene {
  std::vector<Block> blocks;
  PlannerParams params;
  PlanRequest request;

  void Add(int low_x, int low_y, int high_x, int high_y, uint8_t flags = Costmap::kHard) {
    blocks.push_back({{low_x, low_y}, {high_x, high_y}, flags});
  }
};

void SetCells(const Block& block, CostmapBuilder& builder) {
  for (int y = block.low.y; y <= block.high.y; ++y) {
    for (int x = block.low.x; x <= block.high.x; ++x) {
      if (kWindow.Contains({x, y})) builder.SetCell(kWindow.Index({x, y}), block.flags);
    }
  }
}

Scene SceneTo(Vec2 goal, Pose2 start = {0.1f, 0.1f, 0.0f}) {
  Scene scene;
  scene.request.start.pose = start;
  scene.request.goal_odom = goal;
  return scene;
}

// The one planner of these tests: 3.7 MiB, and every plan begins it anew.
Planner& ThePlanner() {
  static const std::unique_ptr<Planner> planner = std::make_unique<Planner>();
  return *planner;
}

const Plan& PlanIn(const Scene& scene, int units = 1 << 20) {
  Planner& planner = ThePlanner();
  const Status status = planner.BeginCells(kWindow, scene.params, scene.request);
  EXPECT_EQ(status, Status::kOk) << StatusName(status);
  if (!IsUsable(status)) return planner.result();
  for (const Block& block : scene.blocks) SetCells(block, planner.costmap_builder());
  while (planner.StepCells(units) == Progress::kBusy) {
  }
  return planner.result();
}

uint64_t HashOf(const Plan& plan) {
  DecisionHash hash;
  AddToHash(plan, hash);
  return hash.value();
}

double NearestHard_m(const Scene& scene, double x_m, double y_m) {
  double nearest2 = 1e18;
  for (const Block& block : scene.blocks) {
    if ((block.flags & (Costmap::kHard | Costmap::kPerson)) == 0) continue;
    const double dx = std::max({0.0, 0.2 * block.low.x - x_m, x_m - 0.2 * (block.high.x + 1)});
    const double dy = std::max({0.0, 0.2 * block.low.y - y_m, y_m - 0.2 * (block.high.y + 1)});
    nearest2 = std::min(nearest2, dx * dx + dy * dy);
  }
  return std::sqrt(nearest2);
}

// Clearance of the footprint's two discs along a whole plan, cut every 3 cm, in double and over
// every hard block.
double ClearanceOf(const Scene& scene, const Plan& plan) {
  const VehicleParams& vehicle = scene.params.vehicle;
  double clearance = 1e9;
  const auto judge = [&](double x, double y, double theta) {
    for (const double side : {-1.0, 1.0}) {
      const double arm = side * double{vehicle.footprint_disc_offset_m};
      const double nearest =
          NearestHard_m(scene, x + arm * std::cos(theta), y + arm * std::sin(theta));
      clearance = std::min(clearance, nearest - double{vehicle.footprint_disc_radius_m});
    }
  };
  for (int k = 0; k + 1 < plan.path.size(); ++k) {
    const Pose2& a = plan.path[k];
    const Pose2& b = plan.path[k + 1];
    const double dx = double{b.x_m} - double{a.x_m};
    const double dy = double{b.y_m} - double{a.y_m};
    const double turn = std::remainder(double{b.theta_rad} - double{a.theta_rad}, 2.0 * M_PI);
    const int pieces = 1 + static_cast<int>(std::hypot(dx, dy) / 0.03);
    for (int j = 0; j <= pieces; ++j) {
      const double share = static_cast<double>(j) / pieces;
      judge(double{a.x_m} + share * dx, double{a.y_m} + share * dy, double{a.theta_rad});
    }
    const int turns = 1 + static_cast<int>(std::abs(turn) / 0.05);
    for (int j = 1; j <= turns; ++j) {
      judge(double{b.x_m}, double{b.y_m}, double{a.theta_rad} + turn * j / turns);
    }
  }
  return clearance;
}

// What every usable plan owes: start pose, end place, lengths, finite numbers, clearance, rest at
// the end.
void ExpectSound(const Scene& scene, const Plan& plan) {
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GE(plan.path.size(), 4);
  ASSERT_EQ(plan.speed.size(), plan.path.size());
  ASSERT_EQ(plan.actuator.steps.size(), plan.path.size() - 1);
  const Pose2& start = scene.request.start.pose;
  EXPECT_EQ(plan.path[0].x_m, start.x_m);
  EXPECT_EQ(plan.path[0].y_m, start.y_m);
  EXPECT_NEAR(WrapAngle(plan.path[0].theta_rad - start.theta_rad), 0.0f, 1e-4f);
  for (const Pose2& pose : plan.path) {
    ASSERT_TRUE(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) &&
                std::isfinite(pose.theta_rad));
  }
  for (const float speed : plan.speed) {
    ASSERT_TRUE(std::isfinite(speed) && speed >= 0.0f && speed <= scene.params.speed.max_speed_mps);
  }
  const Pose2& end = plan.path.back();
  const Pose2& base_end = plan.base.back();
  const float short_m = std::hypot(end.x_m - base_end.x_m, end.y_m - base_end.y_m);
  const bool may_end_short = plan.ends_short || plan.base_status == Status::kPathCut;
  EXPECT_LE(short_m, may_end_short ? Planner::kMaxShort_m : 0.0f);
  // At rest, unless there was no way to stop in.
  const float start_mps = scene.request.start.speed_mps;
  const float to_stop_m = start_mps * start_mps / (2.0f * scene.params.speed.max_deceleration_mps2);
  if (LengthOf(plan.path) > to_stop_m) {
    EXPECT_EQ(plan.speed.back(), 0.0f);
  }
  WorldPath driven;
  ASSERT_EQ(ToWorld<PlanarModel>(plan.actuator, driven), Status::kOk);
  EXPECT_NEAR(driven.back().x_m, end.x_m, 1e-3f);
  EXPECT_NEAR(driven.back().y_m, end.y_m, 1e-3f);
  EXPECT_LE(plan.cost_after.total(), plan.cost_before.total());
  if (!scene.blocks.empty()) {
    const double clearance = ClearanceOf(scene, plan);
    EXPECT_GT(clearance, plan.check.overlap_points == 0 ? -0.005 : -0.8);
    EXPECT_NEAR(std::min(clearance, double{kClearanceReach_m}), plan.check.smallest_clearance_m,
                0.06);
  }
}

TEST(Planner, DrivesStraightOverAnOpenField) {
  const Scene scene = SceneTo({20.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.status, Status::kOk);
  EXPECT_FALSE(plan.pivots_first || plan.pivots_last || plan.narrow || plan.is_seed);
  for (const Pose2& pose : plan.path) EXPECT_NEAR(pose.y_m, 0.1f, 1e-3f);
  EXPECT_GT(*std::max_element(plan.speed.begin(), plan.speed.end()), 3.0f);
  EXPECT_EQ(ThePlanner().stage(), PlanStage::kDone);
}

//            #
//            #
//   o  ------ ------>  x        a wall with a gap of 4 m, off the straight line
//            #
TEST(Planner, PassesAGapInAWall) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -256, 51, 9);
  scene.Add(50, 30, 51, 255);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_FALSE(plan.narrow);
  bool in_gap = false;
  for (const Pose2& pose : plan.path) {
    in_gap = in_gap || (std::abs(pose.x_m - 10.2f) < 0.3f && pose.y_m > 2.8f && pose.y_m < 5.2f);
  }
  EXPECT_TRUE(in_gap);
}

// The gap is 2 m: enough for the footprint (1.58 m), not for the planning radius (2.16 m).
TEST(Planner, TakesAGapForTheBareFootprintOnlySlowly) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -256, 51, -5);
  scene.Add(50, 6, 51, 255);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.narrow);
  EXPECT_GE(plan.status, Status::kNarrowGap);
  for (const float speed : plan.speed) EXPECT_LE(speed, scene.params.speed.min_speed_mps);
}

TEST(Planner, RefusesAGapNarrowerThanTheFootprint) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(50, -256, 51, -4);
  scene.Add(50, 4, 51, 255);
  const Plan& plan = PlanIn(scene);
  EXPECT_EQ(plan.status, Status::kNoPath);
  EXPECT_TRUE(plan.path.empty());
  EXPECT_TRUE(plan.speed.empty());
}

//   #########
//   #   o   #    x
//   #########
TEST(Planner, FindsNoPathOutOfAClosedRing) {
  Scene scene = SceneTo({20.1f, 0.1f});
  scene.Add(-30, -30, 30, -29);
  scene.Add(-30, 29, 30, 30);
  scene.Add(-30, -30, -29, 30);
  scene.Add(29, -30, 30, 30);
  EXPECT_EQ(PlanIn(scene).status, Status::kNoPath);
}

//  # o ------->        within the planning radius, not within the footprint
TEST(Planner, LeavesAnObstacleAtItsStartSlowly) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.params.costmap.planning_radius_m = 1.8f;
  scene.Add(-9, -2, -7, 2);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.search.start_in_obstacle);
  EXPECT_EQ(plan.check.overlap_points, 0);
  EXPECT_GE(plan.status, Status::kStartInObstacle);
  for (int k = 1; k < plan.path.size(); ++k) {
    const float slow_mps = scene.params.speed.obstacle_start_speed_mps;
    const float x_m = plan.path[k].x_m;
    if (x_m < 0.3f) {
      EXPECT_LE(plan.speed[k], slow_mps);
    } else if (x_m > 4.0f && x_m < 8.0f) {
      EXPECT_GT(plan.speed[k], slow_mps);
    }
  }
}

// A cell within the footprint itself, behind the middle.
TEST(Planner, DrivesSlowlyOutOfWhatItStandsIn) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(-5, 0, -5, 0);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.check_status, Status::kStartInObstacle);
  EXPECT_GT(plan.check.overlap_points, 0);
  for (int k = 1; k < plan.check.overlap_points; ++k) {
    EXPECT_LE(plan.speed[k], scene.params.speed.obstacle_start_speed_mps) << k;
  }
}

TEST(Planner, MovesAGoalOutOfAnObstacleOrRefusesIt) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.Add(72, -3, 78, 3);
  const Plan& moved = PlanIn(scene);
  ExpectSound(scene, moved);
  EXPECT_TRUE(moved.search.goal_moved);
  EXPECT_GE(moved.status, Status::kGoalMoved);
  scene.params.astar.move_goal_out_of_obstacle = 0;
  EXPECT_EQ(PlanIn(scene).status, Status::kGoalInObstacle);
}

TEST(Planner, GoesToTheEdgeForAGoalOffTheMap) {
  const Scene scene = SceneTo({200.0f, 10.0f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.search.goal_outside_map);
  EXPECT_GE(plan.status, Status::kGoalOutsideMap);
  EXPECT_GT(plan.path.back().x_m, 50.0f);
}

//   x <-- (o     the vehicle looks the other way
TEST(Planner, TurnsOnTheSpotTowardsAGoalBehind) {
  const Scene scene = SceneTo({-15.1f, 0.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.pivots_first);
  EXPECT_EQ(plan.path[0].x_m, plan.path[1].x_m);
  EXPECT_EQ(plan.path[0].y_m, plan.path[1].y_m);
  EXPECT_EQ(plan.actuator.steps[0].dr_m, 0.0f);
  EXPECT_NEAR(std::abs(plan.actuator.steps[0].phi_rad), kPi, 0.05f);
  EXPECT_EQ(plan.speed[0], 0.0f);
  EXPECT_EQ(plan.speed[1], 0.0f);
  EXPECT_GT(plan.speed[3], 0.0f);
}

TEST(Planner, SaysWhenTheTurnOnTheSpotHasNoRoom) {
  Scene scene = SceneTo({-15.1f, 0.1f});
  scene.Add(-5, 5, 5, 5);  // 0.9 m to the left
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
}

TEST(Planner, JoinsUpToSixtyDegreesWithoutATurnOnTheSpot) {
  for (const float heading_rad : {-0.9f, -0.5f, 0.5f, 0.9f}) {
    const Scene scene = SceneTo({20.1f, 0.1f}, {0.1f, 0.1f, heading_rad});
    const Plan& plan = PlanIn(scene);
    ExpectSound(scene, plan);
    EXPECT_FALSE(plan.pivots_first) << heading_rad;
  }
}

//   ##################
//   o/   ------> x          a corridor of 2.4 m: one step along the heading of 46 degrees touches
//   ##################
TEST(Planner, TurnsOnTheSpotWhereJoiningWouldTouch) {
  Scene scene = SceneTo({12.1f, 0.0f}, {0.1f, 0.0f, 0.8f});
  scene.Add(-20, 6, 100, 8);
  scene.Add(-20, -9, 100, -7);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.pivots_first);
  // A moving vehicle cannot.
  scene.request.start.speed_mps = 1.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kCollision);
  EXPECT_TRUE(ThePlanner().result().speed.empty());
}

TEST(Planner, ArrivesAtTheGoalHeading) {
  for (const float heading_rad : {0.6f, -0.6f, 2.5f}) {
    Scene scene = SceneTo({20.1f, 0.1f});
    scene.request.has_goal_heading = true;
    scene.request.goal_heading_rad = heading_rad;
    const Plan& plan = PlanIn(scene);
    ExpectSound(scene, plan);
    EXPECT_NEAR(plan.path.back().theta_rad, heading_rad, 0.05f);
    EXPECT_EQ(plan.pivots_last, heading_rad == 2.5f) << heading_rad;
    if (!plan.pivots_last) continue;
    EXPECT_EQ(plan.actuator.steps.back().dr_m, 0.0f);
    EXPECT_EQ(plan.speed[plan.speed.size() - 2], 0.0f);
  }
}

TEST(Planner, ReachesAGoalWithinACell) {
  const Scene near = SceneTo({0.25f, 0.1f});
  const Plan& plan = PlanIn(near);
  ExpectSound(near, plan);
  const Scene here = SceneTo({0.12f, 0.1f});
  EXPECT_EQ(PlanIn(here).status, Status::kPathTooShort);
}

TEST(Planner, CutsALongPathAtItsCapacity) {
  Scene scene = SceneTo({45.0f, 45.0f}, {-45.0f, -45.0f, kPi});
  scene.params.path.step_m = 0.25f;
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_GE(plan.status, Status::kPathCut);
  EXPECT_TRUE(plan.pivots_first);
}

//      p        a person 3 m beside the way, halfway
//   o ----------> x
TEST(Planner, SlowsForAPersonBesideTheWay) {
  Scene scene = SceneTo({30.1f, 0.1f});
  const Plan alone = PlanIn(scene);
  scene.Add(75, 15, 76, 16, Costmap::kPerson);
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  const auto slowest_near = [](const Plan& p, float x_m) {
    float slowest = 1e9f;
    for (int k = 0; k < p.path.size(); ++k) {
      if (std::abs(p.path[k].x_m - x_m) < 3.0f) slowest = std::min(slowest, p.speed[k]);
    }
    return slowest;
  };
  EXPECT_LT(slowest_near(plan, 12.0f), 0.8f * slowest_near(alone, 12.0f));
  // Far behind the person nothing is left of it.
  EXPECT_NEAR(slowest_near(plan, 25.0f), slowest_near(alone, 25.0f), 0.3f);
}

TEST(Planner, IgnoresAPersonFarFromTheWay) {
  Scene scene = SceneTo({30.1f, 0.1f});
  const Plan alone = PlanIn(scene);
  scene.Add(75, 150, 76, 151, Costmap::kPerson);
  const Plan& plan = PlanIn(scene);
  ASSERT_EQ(plan.speed.size(), alone.speed.size());
  for (int k = 0; k < plan.speed.size(); ++k) EXPECT_EQ(plan.speed[k], alone.speed[k]);
}

TEST(Planner, CanStopWithinTheRestOfThePath) {
  const Scene scene = SceneTo({40.1f, 10.1f});
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  double rest_m = 0.0;
  for (int k = plan.path.size() - 2; k > 0; --k) {
    rest_m += std::abs(double{plan.actuator.steps[k].dr_m});
    EXPECT_LE(StoppingDistance(scene.params.speed, plan.speed[k]), rest_m + 1e-3) << k;
  }
}

TEST(Planner, BeginsAtTheSpeedItHas) {
  Scene scene = SceneTo({40.1f, 0.1f});
  scene.request.start.speed_mps = 3.0f;
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_EQ(plan.speed[0], 3.0f);
  EXPECT_GT(plan.speed[1], 3.0f);
}

TEST(Planner, PlansOnHeights) {
  const auto heights = std::make_unique<HeightGrid>();
  ASSERT_EQ(heights->Reset({0.0f, 0.0f}), Status::kOk);
  for (int y = -100; y < 100; ++y) {
    for (int x = -20; x < 120; ++x) {
      const Vec2 p = CellCenter({x, y});
      ASSERT_EQ(heights->Insert({p.x_m, p.y_m, 0.0f}, ReturnClass::kGround), Status::kOk);
      if (x > 40 && x < 50 && y > -20 && y < 10) {
        ASSERT_EQ(heights->Insert({p.x_m, p.y_m, 1.2f}, ReturnClass::kHard), Status::kOk);
      }
    }
  }
  const Scene scene = SceneTo({20.1f, 0.1f});
  Planner& planner = ThePlanner();
  ASSERT_EQ(planner.Begin(*heights, scene.params, scene.request), Status::kOk);
  while (planner.Step(*heights, 100) == Progress::kBusy) {
  }
  Scene box = scene;
  box.Add(41, -19, 49, 9);
  ExpectSound(box, planner.result());
  EXPECT_GT(LengthOf(planner.result().path), 20.5f);
}

TEST(Planner, GivesTheSamePlanInAnyPortions) {
  Scene scene = SceneTo({12.1f, 0.1f});
  scene.Add(30, -256, 31, -5);  // closed for the planning radius: the narrow try too
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
    for (const float bad : {kNan, kInf, -kInf}) {
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
    scene = SceneTo({0.0f, 0.0f}, {far, far, far});
    EXPECT_EQ(PlanIn(scene).status, Status::kStartOutsideMap) << far;
  }
  for (const float curvature_per_m : {1e6f, -1e6f}) {
    Scene scene = SceneTo({5.0f, 0.0f});
    scene.request.start.curvature_per_m = curvature_per_m;
    EXPECT_EQ(PlanIn(scene).status, Status::kLimitExceeded) << curvature_per_m;
  }
}

TEST(Planner, RefusesParametersOutOfRange) {
  Planner& planner = ThePlanner();
  const PlanRequest request = SceneTo({5.0f, 0.0f}).request;
  const std::vector<std::function<void(PlannerParams&)>> faults = {
      [](PlannerParams& p) { p.vehicle.footprint_disc_radius_m = kNan; },
      [](PlannerParams& p) { p.vehicle.footprint_disc_radius_m = -0.1f; },
      [](PlannerParams& p) { p.vehicle.skid_baseline_m = kInf; },
      [](PlannerParams& p) { p.costmap.planning_radius_m = -1.0f; },
      [](PlannerParams& p) { p.costmap.hard_slope_per_m = 1e9f; },
      [](PlannerParams& p) { p.speed.max_deceleration_mps2 = 0.0f; },
      [](PlannerParams& p) { p.speed.gamma_per_m = kNan; },
      [](PlannerParams& p) { p.speed.min_speed_mps = 6.0f; },
      [](PlannerParams& p) { p.path.max_join_heading_rad = kNan; }};
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

//   o ------> x###     a wall just beyond the goal: its cell is free, but the vehicle is longer
TEST(Planner, StopsShortOfAGoalInFrontOfAWall) {
  Scene scene = SceneTo({10.1f, 0.1f});
  scene.Add(56, -20, 58, 20);  // from 11.2 m on
  const Plan& plan = PlanIn(scene);
  ExpectSound(scene, plan);
  EXPECT_TRUE(plan.ends_short);
  EXPECT_FALSE(plan.search.goal_moved);
  EXPECT_GE(plan.status, Status::kGoalMoved);
  EXPECT_GT(plan.path.back().x_m, 9.5f);
}

// Trunks and bushes strewn at random, the start anywhere in it and looking anywhere.
Scene RandomForest(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  Scene scene = SceneTo({20.0f * unit(random), 20.0f * unit(random)},
                        {0.5f * unit(random), 0.5f * unit(random), kPi * unit(random)});
  const int trunks = 20 + static_cast<int>(seed % 5u) * 20;
  for (int i = 0; i < trunks; ++i) {
    const int x = static_cast<int>(120.0f * unit(random));
    const int y = static_cast<int>(120.0f * unit(random));
    const int size = static_cast<int>(random() % 4u);
    scene.Add(x, y, x + size, y + size, i % 4 == 0 ? Costmap::kSoft : Costmap::kHard);
  }
  // Bushes first, so that none takes a trunk's place.
  std::stable_partition(scene.blocks.begin(), scene.blocks.end(),
                        [](const Block& block) { return block.flags == Costmap::kSoft; });
  scene.request.start.curvature_per_m = 0.3f * unit(random);
  scene.request.start.speed_mps = seed % 2u == 0 ? 0.0f : 1.0f + unit(random);
  return scene;
}

// In parts, because an unoptimised build takes a quarter of a second for a costmap.
class PlannerInForests : public testing::TestWithParam<uint32_t> {};

TEST_P(PlannerInForests, KeepsClearOfEveryTrunk) {
  constexpr uint32_t kForests = 30;
  uint32_t usable = 0;
  for (uint32_t seed = GetParam(); seed < GetParam() + kForests; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Scene scene = RandomForest(seed);
    const Plan& plan = PlanIn(scene);
    if (!IsUsable(plan.status)) continue;
    ++usable;
    ExpectSound(scene, plan);
    if (HasFailure()) return;
  }
  EXPECT_GT(usable, kForests / 2);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PlannerInForests, testing::Values(0u, 30u, 60u, 90u));

}  // namespace
}  // namespace hardpack
