// SPDX-License-Identifier: Apache-2.0
#include "core/areas/area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "test/core/areas/polygon.h"

// Which areas are accepted.

namespace hardpack {
namespace {

using testing::AreaOf;
using testing::Box;
using testing::Place;

Status CheckKeepOut(const std::vector<Place>& corners) {
  return CheckArea(AreaOf(AreaKind::kKeepOut, corners));
}

TEST(Area, SimplePolygonsAreAcceptedEitherWayRound) {
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {0, 3}}), Status::kOk);
  EXPECT_EQ(CheckKeepOut({{0, 0}, {0, 3}, {4, 0}}), Status::kOk);
  EXPECT_EQ(CheckKeepOut(Box(-1, -1, 1, 1)), Status::kOk);
  // Concave, and with a corner in the middle of a straight edge.
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}), Status::kOk);
  EXPECT_EQ(CheckKeepOut({{0, 0}, {2, 0}, {4, 0}, {4, 4}}), Status::kOk);
}

// SR-ARE01
TEST(Area, ABorderThatCrossesOrTouchesItselfIsRefused) {
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 4}, {4, 0}, {0, 4}}), Status::kAreaNotSimple) << "bow tie";
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}), Status::kAreaNotSimple)
      << "a corner on another edge";
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {4, 4}, {0, 0}, {0, 4}}), Status::kAreaNotSimple)
      << "a corner twice";
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {4, 0}, {0, 4}}), Status::kAreaNotSimple)
      << "an edge without length";
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {6, 0}, {5, 0}, {5, 4}}), Status::kAreaNotSimple)
      << "an edge that folds back";
  EXPECT_EQ(CheckKeepOut({{0, 0}, {6, 0}, {6, 2}, {5, 0}, {3, 0}, {2, 2}}), Status::kAreaNotSimple)
      << "an edge along another";
  // A millimetre apart is apart.
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {4, 4}, {2, 0.001}, {0, 4}}), Status::kOk);
}

TEST(Area, SliversAndPointsAreRefused) {
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {2, 0.019}}), Status::kAreaTooSmall);
  EXPECT_EQ(CheckKeepOut({{0, 0}, {4, 0}, {2, 0.02}}), Status::kOk);
  EXPECT_EQ(CheckKeepOut({{0, 0}, {2, 0}, {1, 0}}), Status::kAreaNotSimple);
  EXPECT_EQ(CheckKeepOut({{0, 0}, {1, 0}}), Status::kInvalidArgument);
  EXPECT_EQ(CheckArea(Area{}), Status::kInvalidArgument);
}

TEST(Area, ThirtyTwoCornersFitAndThirtyThreeDoNot) {
  std::vector<Place> corners;
  for (int i = 0; i < kMaxAreaCorners; ++i) {
    corners.push_back(
        {9.0 * std::cos(2.0 * M_PI * i / 32.0), 9.0 * std::sin(2.0 * M_PI * i / 32.0)});
  }
  Area area = AreaOf(AreaKind::kFence, corners);
  EXPECT_EQ(CheckArea(area), Status::kOk);
  area.corners = kMaxAreaCorners + 1;
  EXPECT_EQ(CheckArea(area), Status::kCapacityExceeded);
  area.corners = INT32_MAX;
  EXPECT_EQ(CheckArea(area), Status::kCapacityExceeded);
  area.corners = INT32_MIN;
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument);
}

TEST(Area, CoordinatesBeyondTheLimitsAreRefused) {
  EXPECT_EQ(CheckKeepOut(Box(-100'000, -100'000, 100'000, 100'000)), Status::kOk);
  EXPECT_EQ(CheckKeepOut(Box(-100'000.001, -1, 1, 1)), Status::kInvalidArgument);
  Area area = AreaOf(AreaKind::kKeepOut, Box(0, 0, 1, 1));
  for (const int32_t extreme : {INT32_MIN, INT32_MAX}) {
    area.corner[2].x_mm = extreme;
    EXPECT_EQ(CheckArea(area), Status::kInvalidArgument);
  }
}

TEST(Area, OnlyASpeedZoneHasASpeedAndItIsWithinLimits) {
  Area area = AreaOf(AreaKind::kSpeedZone, Box(0, 0, 5, 5), 1.5f);
  EXPECT_EQ(CheckArea(area), Status::kOk);
  for (const float wrong : {0.0f, 0.09f, 15.1f, -1.0f}) {
    area.speed_mps = wrong;
    EXPECT_EQ(CheckArea(area), Status::kInvalidArgument) << wrong;
  }
  for (const float wrong :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    area.speed_mps = wrong;
    EXPECT_EQ(CheckArea(area), Status::kNotFinite);
  }
  area = AreaOf(AreaKind::kFence, Box(0, 0, 5, 5), 1.5f);
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument);
  area = AreaOf(static_cast<AreaKind>(3), Box(0, 0, 5, 5));
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument);
  area = AreaOf(AreaKind::kFence, Box(0, 0, 5, 5));
  area.frame = static_cast<AreaFrame>(2);
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument);
}

// Some 11 m by 10 m near 30 degrees north.
Area OnEarth() {
  Area area;
  area.frame = AreaFrame::kEarth;
  area.corners = 4;
  const int64_t latitude = 30'600'000'000;
  const int64_t longitude = -96'300'000'000;
  const int64_t step = 100'000;
  area.corner[0] = {0, 0, latitude, longitude};
  area.corner[1] = {0, 0, latitude, longitude + step};
  area.corner[2] = {0, 0, latitude + step, longitude + step};
  area.corner[3] = {0, 0, latitude + step, longitude};
  return area;
}

TEST(Area, CornersOnEarthAreJudgedInTheirPlane) {
  EXPECT_EQ(CheckArea(OnEarth()), Status::kOk);
  Area area = OnEarth();
  std::swap(area.corner[1], area.corner[2]);
  EXPECT_EQ(CheckArea(area), Status::kAreaNotSimple);
  area = OnEarth();
  area.corner[2].latitude_ndeg = area.corner[0].latitude_ndeg + 10;  // a millimetre
  area.corner[3].latitude_ndeg = area.corner[0].latitude_ndeg + 20;
  EXPECT_EQ(CheckArea(area), Status::kAreaTooSmall);
  area = OnEarth();
  area.corner[2].latitude_ndeg += 2'000'000'000;
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument) << "200 km away";
  area = OnEarth();
  for (AreaCorner& corner : area.corner) corner.latitude_ndeg += 56'000'000'000;
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument) << "too near to the pole";
  area = OnEarth();
  area.corner[1].longitude_ndeg = INT64_MAX;
  EXPECT_EQ(CheckArea(area), Status::kInvalidArgument);
}

TEST(Area, AListHasOneFenceAtMost) {
  const auto areas = std::make_unique<AreaList>();
  ASSERT_EQ(areas->PushBack(AreaOf(AreaKind::kFence, Box(0, 0, 9, 9))), Status::kOk);
  ASSERT_EQ(areas->PushBack(AreaOf(AreaKind::kKeepOut, Box(1, 1, 2, 2))), Status::kOk);
  EXPECT_EQ(CheckAreas(*areas), Status::kOk);
  ASSERT_EQ(areas->PushBack(AreaOf(AreaKind::kFence, Box(0, 0, 8, 8))), Status::kOk);
  EXPECT_EQ(CheckAreas(*areas), Status::kSecondFence);
}

// Against a test of every pair of edges in double, of corners that are seldom in a plain order.
TEST(Area, RandomBordersAreJudgedAsByTheDefinition) {
  const uint32_t seed = 71;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> corner_count(3, 7);
  std::uniform_int_distribution<int> place(0, 12);
  int simple = 0;
  int crossing = 0;
  for (int run = 0; run < 20000; ++run) {
    std::vector<Place> corners;
    for (int i = corner_count(random); i > 0; --i) {
      corners.push_back({static_cast<double>(place(random)), static_cast<double>(place(random))});
    }
    const size_t n = corners.size();
    bool is_simple = true;
    for (size_t i = 0; i < n; ++i) {
      const Place& a = corners[i];
      const Place& b = corners[(i + 1) % n];
      const Place& c = corners[(i + 2) % n];
      // Neighbours share their corner only: neither's other end lies on the other.
      const bool is_point = (a.x == b.x && a.y == b.y);
      if (is_point || testing::SegmentDistance(a, b, c) == 0.0 ||
          testing::SegmentDistance(c, a, b) == 0.0) {
        is_simple = false;
      }
      for (size_t j = i + 2; j < n; ++j) {
        if ((j + 1) % n == i) continue;
        const Place& d = corners[j];
        const Place& e = corners[(j + 1) % n];
        const bool touch = testing::Cross(a, b, d, e) || testing::SegmentDistance(a, d, e) < 1e-9 ||
                           testing::SegmentDistance(b, d, e) < 1e-9 ||
                           testing::SegmentDistance(d, a, b) < 1e-9 ||
                           testing::SegmentDistance(e, a, b) < 1e-9;
        if (touch) is_simple = false;
      }
    }
    const Status status = CheckKeepOut(corners);
    ASSERT_EQ(status == Status::kAreaNotSimple, !is_simple) << run;
    ++(is_simple ? simple : crossing);
  }
  EXPECT_GT(simple, 3000);
  EXPECT_GT(crossing, 3000);
}

}  // namespace
}  // namespace hardpack
