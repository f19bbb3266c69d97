// SPDX-License-Identifier: Apache-2.0
#include "core/speed/ground_ahead.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "core/speed/speed.h"
#include "test/core/costmap/ground_of_heights.h"

namespace hardpack {
namespace {

using Ground = testing::GroundOfHeights;

constexpr double kDegree_rad = 3.14159265358979323846 / 180.0;
constexpr double kFar = std::numeric_limits<double>::quiet_NaN();  // not known

WorldPath Straight(Pose2 from, float length_m, float step_m = 0.25f) {
  WorldPath path;
  const Vec2 along = {std::cos(from.theta_rad), std::sin(from.theta_rad)};
  for (float at_m = 0.0f; at_m <= std::abs(length_m); at_m += step_m) {
    const float on_m = std::copysign(at_m, length_m);
    EXPECT_EQ(
        path.PushBack({from.x_m + on_m * along.x_m, from.y_m + on_m * along.y_m, from.theta_rad}),
        Status::kOk);
  }
  return path;
}

GroundAhead Look(const Ground& ground, const WorldPath& path, const SpeedParams& params = {}) {
  return LookAtGround(ground.terrain(), ground.map().window, params, path);
}

// What is left of braking on a slope, in double.
double Brakes(double friction, double slope_rad) {
  return 9.80665 * (0.8 * friction * std::cos(slope_rad) - std::sin(slope_rad));
}

// SR-SLP01
TEST(GroundAhead, FallsAndLeansAsThePlaneDoesInTheVehiclesDirection) {
  const Ground ground([](double x_m, double /*y_m*/) { return -0.2 * x_m; });
  const float up_rad = std::numbers::pi_v<float>;
  const GroundAhead down = Look(ground, Straight({-8.0f, 0.0f, 0.0f}, 15.0f));
  EXPECT_NEAR(down.fall, 0.2f, 0.02f);
  EXPECT_LT(down.bank, 0.02f);
  const GroundAhead up = Look(ground, Straight({8.0f, 0.0f, up_rad}, 15.0f));
  EXPECT_EQ(up.fall, 0.0f) << "a way up is as level ground";
  EXPECT_NEAR(up.rise, 0.2f, 0.02f);
  EXPECT_EQ(down.rise, 0.0f);
  const GroundAhead across = Look(ground, Straight({0.0f, -8.0f, 0.5f * up_rad}, 15.0f));
  EXPECT_LT(across.fall, 0.02f);
  EXPECT_NEAR(across.bank, 0.2f, 0.02f);
  const GroundAhead askew = Look(ground, Straight({-5.0f, -5.0f, 0.25f * up_rad}, 12.0f));
  EXPECT_NEAR(askew.fall, 0.2f * std::sqrt(0.5f), 0.02f);
  EXPECT_NEAR(askew.bank, 0.2f * std::sqrt(0.5f), 0.02f);
}

TEST(GroundAhead, InReverseTheOtherWayIsDown) {
  const Ground ground([](double x_m, double /*y_m*/) { return 0.25 * x_m; });
  EXPECT_EQ(Look(ground, Straight({-6.0f, 0.0f, 0.0f}, 8.0f)).fall, 0.0f);
  EXPECT_NEAR(Look(ground, Straight({6.0f, 0.0f, 0.0f}, -8.0f)).fall, 0.25f, 0.02f);
}

// What has been passed does not count, and what is not known goes on as before.
TEST(GroundAhead, IsOfWhatLiesAheadAlone) {
  const Ground ground([](double x_m, double /*y_m*/) {
    if (x_m > 6.0) return kFar;
    return x_m < 0.0 ? -0.3 * x_m : 0.0;
  });
  EXPECT_NEAR(Look(ground, Straight({-8.0f, 0.0f, 0.0f}, 15.0f)).fall, 0.3f, 0.02f);
  EXPECT_LT(Look(ground, Straight({2.0f, 0.0f, 0.0f}, 15.0f)).fall, 0.02f);
  const Ground falls([](double x_m, double /*y_m*/) { return x_m < 3.0 ? -0.25 * x_m : kFar; });
  EXPECT_NEAR(Look(falls, Straight({0.0f, 0.0f, 0.0f}, 15.0f)).fall, 0.25f, 0.02f);
  EXPECT_EQ(Look(falls, Straight({8.0f, 0.0f, 0.0f}, 8.0f)).fall, 0.0f);
}

// A step of 0.2 m is not a slope on which a vehicle slides.
TEST(GroundAhead, IsSpreadOverMoreThanAStep) {
  const Ground ground([](double x_m, double /*y_m*/) { return x_m < 3.0 ? 0.0 : -0.2; });
  const GroundAhead ahead = Look(ground, Straight({0.0f, 0.0f, 0.0f}, 8.0f));
  EXPECT_LT(ahead.fall, 0.15f);
  EXPECT_EQ(ahead.too_steep_m, GroundAhead::kFar_m);
}

// SR-SLP01
TEST(GroundAhead, EndsWhereAVehicleCouldNotStop) {
  // 0.8 of 0.5 holds up to 21.5 degrees with 0.05 m/s2 left; 23 are told for sure.
  const auto bent = [](double degrees) {
    return [=](double x_m, double /*y_m*/) {
      return x_m < 5.0 ? -0.1 * x_m : -0.5 - std::tan(degrees * kDegree_rad) * (x_m - 5.0);
    };
  };
  const WorldPath path = Straight({0.0f, 0.0f, 0.0f}, 18.0f);
  EXPECT_EQ(Look(Ground(bent(20.0)), path).too_steep_m, GroundAhead::kFar_m);
  const GroundAhead steep = Look(Ground(bent(25.0)), path);
  EXPECT_NEAR(steep.too_steep_m, 5.0f, 0.6f);
  EXPECT_LT(steep.fall, 0.43f) << "only of what it may drive on";
  SpeedParams wet;
  wet.friction = 0.3f;
  EXPECT_NEAR(Look(Ground(bent(20.0)), path, wet).too_steep_m, 5.0f, 0.6f);
}

// Waves of a length, with slopes of up to `steepest`: the bend is 2 pi / length times that.
Ground Waves(double length_m, double steepest) {
  const double per_m = 2.0 * std::numbers::pi / length_m;
  return Ground(
      [=](double x_m, double /*y_m*/) { return steepest / per_m * std::sin(per_m * x_m); });
}

// SR-SLP02
TEST(GroundAhead, BendsAsTheGroundDoesAlongTheWay) {
  for (const auto& [length_m, told] : {std::pair{3.0, 0.45}, {6.0, 0.8}, {12.0, 0.95}}) {
    const double bend_per_m = 2.0 * std::numbers::pi / length_m * 0.2;
    const Ground ground = Waves(length_m, 0.2);
    const GroundAhead across = Look(ground, Straight({-10.0f, 0.1f, 0.0f}, 20.0f));
    EXPECT_GT(across.bend, (told - 0.12) * bend_per_m) << length_m;
    EXPECT_LT(across.bend, (told + 0.12) * bend_per_m) << length_m;
    const GroundAhead along = Look(ground, Straight({0.1f, -10.0f, 1.5707963f}, 20.0f));
    EXPECT_LT(along.bend, 0.1 * bend_per_m) << length_m;
  }
  const Ground slope([](double x_m, double /*y_m*/) { return 0.3 * x_m; });
  EXPECT_LT(Look(slope, Straight({-10.0f, 0.0f, 0.0f}, 20.0f)).bend, 0.02f);
}

// The way back down is no bend of the way up.
TEST(GroundAhead, ATurnOnTheSpotIsNoBend) {
  const Ground slope([](double x_m, double /*y_m*/) { return 0.3 * x_m; });
  WorldPath path = Straight({-5.0f, 0.1f, 0.0f}, 5.0f);
  ASSERT_EQ(path.PushBack({path[path.size() - 1].x_m, 0.1f, std::numbers::pi_v<float>}),
            Status::kOk);
  for (int k = 19; k >= 0; --k) {
    ASSERT_EQ(path.PushBack({path[k].x_m, 0.1f, std::numbers::pi_v<float>}), Status::kOk);
  }
  EXPECT_LT(Look(slope, path).bend, 0.02f);
}

// SR-SLP02
TEST(OnGround, TheBodysVerticalAccelerationHasALimit) {
  const SpeedParams params;
  for (const float bend_per_m : {0.12f, 0.3f, 1.0f, 8.0f}) {
    const SpeedParams on = OnGround(params, {.bend = bend_per_m});
    EXPECT_NEAR(on.max_speed_mps * on.max_speed_mps * bend_per_m,
                params.max_vertical_acceleration_mps2, 1e-4f);
    EXPECT_LE(on.min_speed_mps, on.max_speed_mps);
    EXPECT_EQ(on.max_deceleration_mps2, params.max_deceleration_mps2);
  }
  EXPECT_EQ(OnGround(params, {.bend = 0.1f}).max_speed_mps, params.max_speed_mps);
}

TEST(OnGround, LevelGroundChangesNothing) {
  const SpeedParams params;
  const SpeedParams level = OnGround(params, {});
  EXPECT_EQ(std::memcmp(&level, &params, sizeof(params)), 0);
  const SpeedParams gentle = OnGround(params, {.fall = 0.15f, .rise = 0.15f, .bank = 0.15f});
  EXPECT_EQ(std::memcmp(&gentle, &params, sizeof(params)), 0) << "there is friction to spare";
}

// SR-SLP01
TEST(OnGround, LeavesWhatFrictionHoldsOnASlope) {
  const SpeedParams params;
  for (const double degrees : {14.0, 17.0, 20.0}) {
    const auto slope = static_cast<float>(std::tan(degrees * kDegree_rad));
    const double holds_mps2 = std::min(2.0, Brakes(0.5, degrees * kDegree_rad));
    EXPECT_NEAR(OnGround(params, {.fall = slope}).max_deceleration_mps2, holds_mps2, 1.0e-4);
    const SpeedParams up = OnGround(params, {.rise = slope});
    EXPECT_NEAR(up.max_acceleration_mps2, holds_mps2, 1.0e-4);
    EXPECT_EQ(up.max_deceleration_mps2, params.max_deceleration_mps2);
    EXPECT_EQ(up.max_speed_mps, params.max_speed_mps);
    const SpeedParams across = OnGround(params, {.bank = slope});
    EXPECT_NEAR(across.max_lateral_acceleration_mps2, holds_mps2, 1.0e-4);
    EXPECT_EQ(across.max_speed_mps, params.max_speed_mps);
  }
}

// So nobody who looks ahead as far as on level ground has to look farther: corridor, people, sight.
// SR-SLP01
TEST(OnGround, StandsWithinTheDistanceOfLevelGround) {
  std::mt19937 random(7);
  const auto uniform = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  for (int round = 0; round < 2000; ++round) {
    SpeedParams params;
    params.max_speed_mps = uniform(1.0f, 8.0f);
    params.min_speed_mps = uniform(0.2f, params.max_speed_mps);
    params.max_deceleration_mps2 = uniform(0.3f, 4.0f);
    params.friction = uniform(0.1f, 1.0f);
    const SpeedParams on =
        OnGround(params, {.fall = uniform(0.0f, 1.0f), .bend = uniform(0.0f, 2.0f)});
    EXPECT_LE(StoppingDistance(on, on.max_speed_mps),
              StoppingDistance(params, params.max_speed_mps));
    EXPECT_LE(on.max_deceleration_mps2, params.max_deceleration_mps2);
    EXPECT_GE(on.max_deceleration_mps2, GroundAhead::kLeastBraking_mps2);
    EXPECT_LE(on.min_speed_mps, on.max_speed_mps);
    EXPECT_GT(on.max_speed_mps, 0.0f);
  }
}

}  // namespace
}  // namespace hardpack
