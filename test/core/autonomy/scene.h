// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/autonomy/planner.h"
#include "core/base/math.h"
#include "test/core/safety/rectangle.h"

// Scenes of blocks for the planner's tests, and what every usable plan in one owes.

namespace hardpack {

inline constexpr GridWindow kWindow{{-256, -256}};

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

inline void SetCells(const Block& block, CostmapBuilder& builder) {
  for (int y = block.low.y; y <= block.high.y; ++y) {
    for (int x = block.low.x; x <= block.high.x; ++x) {
      if (kWindow.Contains({x, y})) builder.SetCell(kWindow.Index({x, y}), block.flags);
    }
  }
}

inline Scene SceneTo(Vec2 goal, Pose2 start = {0.1f, 0.1f, 0.0f}) {
  Scene scene;
  scene.request.start.pose = start;
  scene.request.goal_odom = goal;
  return scene;
}

// 2.0 x 1.2 m, rear axle 0.6 m behind the middle, least turning radius 3.1 m.
inline void MakeAckermann(Scene& scene) {
  VehicleParams& vehicle = scene.params.vehicle;
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.length_m = 2.0f;
  vehicle.width_m = 1.2f;
  vehicle.axle_offset_m = -0.6f;
  vehicle.wheelbase_m = 1.5f;
  vehicle.max_steering_rad = 0.45f;
}

// The one planner of these tests: 3.7 MiB, and every plan begins it anew.
inline Planner& ThePlanner() {
  static const std::unique_ptr<Planner> planner = std::make_unique<Planner>();
  return *planner;
}

inline const Plan& PlanIn(const Scene& scene, int units = 1 << 20) {
  Planner& planner = ThePlanner();
  const Status status = planner.BeginCells(kWindow, scene.params, scene.request);
  EXPECT_EQ(status, Status::kOk) << StatusName(status);
  if (!IsUsable(status)) return planner.result();
  for (const Block& block : scene.blocks) SetCells(block, planner.costmap_builder());
  while (planner.StepCells(units) == Progress::kBusy) {
  }
  return planner.result();
}

inline uint64_t HashOf(const Plan& plan) {
  DecisionHash hash;
  AddToHash(plan, hash);
  return hash.value();
}

// From the outline at a place to the nearest hard block; 0 where it overlaps one.
inline double OutlineClearance_m(const Scene& scene, double x_m, double y_m, double theta_rad) {
  const Quad outline = OutlineQuad(scene.params.vehicle, x_m, y_m, theta_rad);
  double nearest = 1e9;
  for (const Block& block : scene.blocks) {
    if ((block.flags & (Costmap::kHard | Costmap::kPerson)) == 0) continue;
    nearest = std::min(
        nearest,
        DistanceBetween(outline, BoxQuad(0.2 * block.low.x, 0.2 * block.low.y,
                                         0.2 * (block.high.x + 1), 0.2 * (block.high.y + 1))));
  }
  return nearest;
}

// By how far one of two rectangles would have to be moved, along a side of either, for them not to
// overlap; 0 where they do not.
inline double OverlapOf_m(const Quad& a, const Quad& b) {
  double least = 1e9;
  for (size_t i = 0; i < 4; ++i) {
    const Quad& quad = i < 2 ? a : b;
    const TestPoint side = {quad[1 + i % 2].x - quad[i % 2].x, quad[1 + i % 2].y - quad[i % 2].y};
    const double length = std::hypot(side.x, side.y);
    const auto span = [&](const Quad& of, double& low, double& high) {
      low = 1e9;
      high = -1e9;
      for (const TestPoint& p : of) {
        const double along = (p.x * side.x + p.y * side.y) / length;
        low = std::min(low, along);
        high = std::max(high, along);
      }
    };
    double low_a, high_a, low_b, high_b;
    span(a, low_a, high_a);
    span(b, low_b, high_b);
    least = std::min({least, high_a - low_b, high_b - low_a});
  }
  return std::max(least, 0.0);
}

// How deep the deepest hard cell lies in the outline at a place, as the check counts it.
inline double OutlineOverlap_m(const Scene& scene, double x_m, double y_m, double theta_rad) {
  const Quad outline = OutlineQuad(scene.params.vehicle, x_m, y_m, theta_rad);
  double deepest = 0.0;
  for (const Block& block : scene.blocks) {
    if ((block.flags & (Costmap::kHard | Costmap::kPerson)) == 0) continue;
    for (int y = block.low.y; y <= block.high.y; ++y) {
      for (int x = block.low.x; x <= block.high.x; ++x) {
        const Quad cell = BoxQuad(0.2 * x, 0.2 * y, 0.2 * (x + 1), 0.2 * (y + 1));
        deepest = std::max(deepest, OverlapOf_m(outline, cell));
      }
    }
  }
  return deepest;
}

// Clearance of the outline along a whole plan, cut every 3 cm, in double and over every hard block;
// negative where it overlaps one.
inline double ClearanceOf(const Scene& scene, const Plan& plan) {
  double clearance = 1e9;
  const auto judge = [&](double x, double y, double theta) {
    double here = OutlineClearance_m(scene, x, y, theta);
    if (here <= 0.0) here = -OutlineOverlap_m(scene, x, y, theta);
    clearance = std::min(clearance, here);
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
    const int turns = 1 + static_cast<int>(std::abs(turn) / 0.02);
    for (int j = 1; j <= turns; ++j) {
      judge(double{b.x_m}, double{b.y_m}, double{a.theta_rad} + turn * j / turns);
    }
  }
  return clearance;
}

// What every usable plan owes: start pose, end place, lengths, finite numbers, clearance, rest at
// the end.
inline void ExpectSound(const Scene& scene, const Plan& plan) {
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

}  // namespace hardpack
