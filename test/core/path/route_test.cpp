// SPDX-License-Identifier: Apache-2.0
#include "core/path/route.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kNaN;

Route RouteBy(std::initializer_list<Vec2> places) {
  Route route;
  for (const Vec2& place : places) {
    EXPECT_EQ(route.vias.PushBack({place, 0.0f}), Status::kOk);
  }
  return route;
}

//   x = 0 .. 10 along y = 0, and back along y = 2
WorldPath Hairpin() {
  WorldPath path;
  for (int i = 0; i <= 20; ++i) {
    EXPECT_EQ(path.PushBack({0.5f * static_cast<float>(i), 0.0f, 0.0f}), Status::kOk);
  }
  for (int i = 20; i >= 0; --i) {
    EXPECT_EQ(path.PushBack({0.5f * static_cast<float>(i), 2.0f, 0.0f}), Status::kOk);
  }
  return path;
}

TEST(Route, IsCheckedNumberByNumber) {
  EXPECT_EQ(CheckRoute({}), Status::kOk);
  Route route = RouteBy({{1.0f, 2.0f}, {3.0f, 4.0f}});
  route.vias[0].speed_mps = kMaxLegSpeed_mps;
  EXPECT_EQ(CheckRoute(route), Status::kOk);
  route.vias[0].speed_mps = 1.001f * kMaxLegSpeed_mps;
  EXPECT_EQ(CheckRoute(route), Status::kInvalidArgument);
  route.vias[0].speed_mps = -0.1f;
  EXPECT_EQ(CheckRoute(route), Status::kInvalidArgument);
  route.vias[0].speed_mps = kNaN;
  EXPECT_EQ(CheckRoute(route), Status::kNotFinite);
  route = RouteBy({{1.0f, kNaN}});
  EXPECT_EQ(CheckRoute(route), Status::kNotFinite);
  route = {};
  route.goal_speed_mps = kNaN;
  EXPECT_EQ(CheckRoute(route), Status::kNotFinite);
}

TEST(Route, WhatLiesBehindItsFirstViasKeepsTheirOrder) {
  Route route = RouteBy({{1.0f, 0.0f}, {2.0f, 0.0f}, {3.0f, 0.0f}});
  route.goal_speed_mps = 4.0f;
  EXPECT_EQ(RouteBehind(route, 0).vias.size(), 3);
  const Route behind = RouteBehind(route, 2);
  ASSERT_EQ(behind.vias.size(), 1);
  EXPECT_EQ(behind.vias[0].position_odom.x_m, 3.0f);
  EXPECT_EQ(behind.goal_speed_mps, 4.0f);
  EXPECT_TRUE(RouteBehind(route, 3).vias.empty());
}

// The way back comes near the place again: it is the first time that counts.
TEST(Route, APathPassesAPlaceWhereItFirstComesNearest) {
  const WorldPath path = Hairpin();
  EXPECT_EQ(PassingPoint(path, 0, {5.1f, 0.4f}, 1.0f), 10);
  EXPECT_EQ(PassingPoint(path, 10, {5.1f, 0.4f}, 1.0f), 10) << "from there on, too";
  EXPECT_EQ(PassingPoint(path, 21, {5.1f, 1.4f}, 1.0f), 31);
  EXPECT_EQ(PassingPoint(path, 0, {5.1f, 1.4f}, 0.9f), 31) << "too far from the way there";
  EXPECT_EQ(PassingPoint(path, 0, {5.1f, 5.0f}, 2.9f), -1);
  EXPECT_EQ(PassingPoint(path, 0, {kNaN, 0.0f}, 1.0f), -1);
  EXPECT_EQ(PassingPoint(path, path.size(), {5.0f, 0.0f}, 1.0f), -1);
  EXPECT_EQ(PassingPoint(WorldPath{}, 0, {5.0f, 0.0f}, 1.0f), -1);
}

TEST(Route, ViasArePassedInTheirOrder) {
  const WorldPath path = Hairpin();
  const int last = path.size() - 1;
  const Route route = RouteBy({{3.0f, 0.0f}, {8.0f, 0.0f}, {3.0f, 2.0f}});
  EXPECT_EQ(ViasPassed(path, route, 0.5f, last), 3);
  EXPECT_EQ(ViasPassed(path, route, 0.5f, 16), 2);
  EXPECT_EQ(ViasPassed(path, route, 0.5f, 15), 1);
  EXPECT_EQ(ViasPassed(path, route, 0.5f, 5), 0);
  const Route reversed = RouteBy({{3.0f, 2.0f}, {8.0f, 0.0f}});
  EXPECT_EQ(ViasPassed(path, reversed, 0.5f, last), 1) << "the second lies before the first";
  EXPECT_EQ(ViasPassed(path, RouteBy({{3.0f, 9.0f}, {8.0f, 0.0f}}), 0.5f, last), 0);
}

// With kappa = 0.5 and 1.5 m: cos(a / 2) = 1 / 1.75, a = 110.3 degrees.
TEST(Route, ACornerIsGentleUpToTheArcThatCutsIt) {
  for (int degrees = -180; degrees <= 180; ++degrees) {
    const float angle_rad = static_cast<float>(degrees) * kPi / 180.0f;
    const Vec2 behind = {3.0f * std::cos(angle_rad), 3.0f * std::sin(angle_rad)};
    EXPECT_EQ(IsGentle({2.0f, 0.0f}, behind, 0.5f, 1.5f), std::abs(degrees) <= 110) << degrees;
  }
  EXPECT_FALSE(IsGentle({0.0f, 0.0f}, {1.0f, 0.0f}, 0.5f, 1.5f));
  EXPECT_FALSE(IsGentle({1.0f, 0.0f}, {0.0f, 0.0f}, 0.5f, 1.5f));
  EXPECT_FALSE(IsGentle({kNaN, 0.0f}, {1.0f, 0.0f}, 0.5f, 1.5f));
}

}  // namespace
}  // namespace hardpack
