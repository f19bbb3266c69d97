// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/stop_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/tracking/tracking.h"

namespace hardpack {
namespace {

// A drive model that has followed commands for a while, and what it does when zero follows.
struct StopBench {
  DriveModel model;
  uint64_t now_ns = 1'000'000'000;

  StopBench() { EXPECT_EQ(model.Configure({}, {}, {}), Status::kOk); }
  void Tick(const WheelParts& command) {
    now_ns += DriveModel::kStep_ns;
    static_cast<void>(model.Advance(now_ns, {}, {}));
    model.SetCommand(command);
  }
  void Drive(const WheelParts& command, int ticks = 400) {
    for (int i = 0; i < ticks; ++i) Tick(command);
  }
  SweptMotion Stop(StopKind kind, const StopWay& way = {}) const {
    SweptMotion motion;
    RollOutStop(model, {1.0f, 2.0f, 0.5f}, way, kind, motion);
    return motion;
  }
};

float Way(const SweptMotion& motion) {
  float way_m = 0.0f;
  for (int k = 1; k < motion.size(); ++k) {
    way_m += std::hypot(motion[k].pose.x_m - motion[k - 1].pose.x_m,
                        motion[k].pose.y_m - motion[k - 1].pose.y_m);
  }
  return way_m;
}

TEST(StopMotion, AtRestItStaysWhereItIs) {
  StopBench bench;
  const SweptMotion motion = bench.Stop(StopKind::kZero);
  EXPECT_EQ(motion[0].pose.x_m, 1.0f);
  EXPECT_LT(Way(motion), 1e-3f);
}

// The same as the model itself does in steps of a tick when zero is told.
// SR-MOV02
TEST(StopMotion, ZeroEndsWhereTheModelComesToRest) {
  for (const float turn_radps : {0.0f, 2.5f, -2.5f}) {
    StopBench bench;
    bench.Drive({8.0f, turn_radps});
    const SweptMotion motion = bench.Stop(StopKind::kZero);
    DriveState state = bench.model.StateAt({1.0f, 2.0f, 0.5f});
    bench.Tick({8.0f, turn_radps});  // the command under way in this tick
    for (int i = 1; i <= 600; ++i) {
      const WheelParts told =
          i <= bench.model.dead_steps() + 1 ? WheelParts{8.0f, turn_radps} : WheelParts{};
      bench.model.Roll(told, 0.01f, state);
    }
    EXPECT_NEAR(motion.back().pose.x_m, state.pose.x_m, 0.05f) << turn_radps;
    EXPECT_NEAR(motion.back().pose.y_m, state.pose.y_m, 0.05f) << turn_radps;
    EXPECT_NEAR(motion.back().pose.theta_rad, state.pose.theta_rad, 0.04f) << turn_radps;
    EXPECT_LT(std::fabs(motion.back().speed_mps), 0.05f);
  }
}

// A stop along a path in reverse is the mirror image of one ahead.
// SR-MOV02
TEST(StopMotion, AlongAPathInReverseItIsTheMirrorImage) {
  StopWay way;
  way.deceleration_mps2 = 2.0f;
  for (float& bend_per_m : way.curvature_per_m) bend_per_m = 0.2f;
  const auto stop = [&](float direction) {
    StopBench bench;
    bench.Drive({direction * 6.0f, direction * 1.0f});
    way.reference_mps = direction * 1.7f;
    return bench.Stop(StopKind::kAlong, way);
  };
  const SweptMotion ahead = stop(1.0f);
  const SweptMotion back = stop(-1.0f);
  EXPECT_NEAR(Way(ahead), Way(back), 0.02f);
  EXPECT_GT(Way(ahead), 1.0f);
  EXPECT_NEAR(ahead.back().pose.theta_rad - 0.5f, -(back.back().pose.theta_rad - 0.5f), 0.02f);
  EXPECT_LT(std::fabs(back.back().speed_mps), 0.05f);
}

// SR-MOV02
TEST(StopMotion, SteeredWheelsHoldTheirCurve) {
  for (const float turn_radps : {1.5f, -1.5f}) {
    StopBench bench;
    bench.Drive({8.0f, turn_radps});
    const DriveState before = bench.model.StateAt({1.0f, 2.0f, 0.5f});
    const float curvature_per_m = before.yaw_rate_radps / before.speed_mps;
    StopWay way;
    way.held_curvature_per_m = 0.4f;
    const SweptMotion held = bench.Stop(StopKind::kZero, way);
    const float turned_rad = held.back().pose.theta_rad - 0.5f;
    EXPECT_NEAR(turned_rad, curvature_per_m * Way(held), 0.05f * std::fabs(turned_rad));
    // A turn that dies out faster than the speed ends elsewhere.
    const SweptMotion dying = bench.Stop(StopKind::kZero);
    EXPECT_GT(std::fabs(turned_rad), std::fabs(dying.back().pose.theta_rad - 0.5f) + 0.02f);
  }
}

// What the wheels cannot be turned to is not held, and a yaw rate at rest is no curve.
TEST(StopMotion, SteeredWheelsHoldNoMoreThanTheyCan) {
  StopBench bench;
  bench.Drive({3.0f, 4.0f});
  StopWay way;
  way.held_curvature_per_m = 0.2f;
  const SweptMotion held = bench.Stop(StopKind::kZero, way);
  const int last = held.size() - 1;
  const int middle = last / 2;
  const float way_m = std::hypot(held[last].pose.x_m - held[middle].pose.x_m,
                                 held[last].pose.y_m - held[middle].pose.y_m);
  EXPECT_LE(held[last].pose.theta_rad - held[middle].pose.theta_rad, 0.2f * way_m + 0.01f);
  StopBench spinning;
  spinning.Drive({0.0f, 4.0f});
  const SweptMotion ended = spinning.Stop(StopKind::kZero, way);
  EXPECT_LT(Way(ended), 0.4f);
  for (const SweptPose& pose : ended) EXPECT_TRUE(std::isfinite(pose.pose.theta_rad));
}

// SR-MOV04
TEST(StopMotion, WhatItMayBeOffByGrowsForHalfASecond) {
  StopBench bench;
  bench.Drive({8.0f, 2.5f});
  StopWay way;
  way.error = {.speed_mps = 0.2f, .yaw_rate_radps = 0.1f};
  const SweptMotion motion = bench.Stop(StopKind::kZero, way);
  EXPECT_EQ(motion[0].along_m, 0.0f);
  for (int k = 1; k < motion.size(); ++k) {
    EXPECT_GE(motion[k].along_m, motion[k - 1].along_m);
    EXPECT_GE(motion[k].aside_m, motion[k - 1].aside_m);
  }
  EXPECT_NEAR(motion.back().along_m, 0.5f * (0.2f + 0.7f * 0.1f), 1e-5f);
  EXPECT_NEAR(motion.back().aside_m, 0.5f * (0.5f * 0.2f + 1.1f * 0.1f), 1e-5f);
  const SweptMotion exact = bench.Stop(StopKind::kZero);
  ASSERT_EQ(exact.size(), motion.size());
  for (const SweptPose& pose : exact) EXPECT_EQ(pose.along_m + pose.aside_m, 0.0f);
}

// SR-MOV02
TEST(StopMotion, AlongThePathItTakesTheRampAndTheLags) {
  StopBench bench;
  bench.Drive({8.0f, 0.0f});
  StopWay way;
  way.reference_mps = bench.model.speed_mps();
  way.deceleration_mps2 = 2.0f;
  const float v = way.reference_mps;
  const SweptMotion along = bench.Stop(StopKind::kAlong, way);
  // No less than the dead time and the ramp, no more than what the speed planner counts with.
  EXPECT_GT(Way(along), v * 0.14f + v * v / 4.0f);
  EXPECT_LT(Way(along), v * 0.70f + v * v / 4.0f);
  EXPECT_GT(Way(along), Way(bench.Stop(StopKind::kZero)));
}

// It keeps to the path's curvature while it brakes; at zero at once the turn dies away.
TEST(StopMotion, AlongAPathThatBendsItTurns) {
  StopBench bench;
  bench.Drive({8.0f, 0.0f});
  float turned_rad[2] = {};
  float way_m = 0.0f;
  for (int side = 0; side < 2; ++side) {
    StopWay way;
    for (float& curvature : way.curvature_per_m) curvature = side == 0 ? 0.3f : -0.3f;
    way.reference_mps = bench.model.speed_mps();
    way.deceleration_mps2 = 2.0f;
    const SweptMotion motion = bench.Stop(StopKind::kAlong, way);
    turned_rad[side] = motion.back().pose.theta_rad - 0.5f;
    way_m = Way(motion);
  }
  EXPECT_NEAR(turned_rad[0], -turned_rad[1], 1e-3f);
  // Less what is driven before the turn has built up.
  EXPECT_GT(turned_rad[0], 0.3f * 0.4f * way_m);
  EXPECT_LT(turned_rad[0], 0.3f * 1.2f * way_m);
}

TEST(StopMotion, PosesLieCloseEnoughAndNeverTooMany) {
  for (const float common_radps : {0.5f, 4.0f, 17.5f}) {
    StopBench bench;
    bench.Drive({common_radps, 1.0f});
    StopWay way;
    way.reference_mps = bench.model.speed_mps();
    way.deceleration_mps2 = 2.0f;
    for (const StopKind kind : {StopKind::kAlong, StopKind::kZero}) {
      const SweptMotion motion = bench.Stop(kind, way);
      EXPECT_LE(motion.size(), kMaxSweptPoses);
      for (int k = 1; k + 1 < motion.size(); ++k) {
        EXPECT_LT(std::hypot(motion[k].pose.x_m - motion[k - 1].pose.x_m,
                             motion[k].pose.y_m - motion[k - 1].pose.y_m),
                  0.5f);
      }
    }
  }
}

}  // namespace
}  // namespace hardpack
