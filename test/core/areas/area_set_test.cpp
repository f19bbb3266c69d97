// SPDX-License-Identifier: Apache-2.0
#include "core/areas/area_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/odometry/local_plane.h"
#include "test/core/areas/polygon.h"

// The areas in force: how they arrive, and where those on earth lie.

namespace hardpack {
namespace {

using testing::AreaOf;
using testing::Box;

constexpr int64_t kLatitude = 46'780'000'000;
constexpr int64_t kLongitude = -71'280'000'000;
constexpr uint64_t kTick_ns = 10'000'000;

struct Areas {
  std::unique_ptr<AreaSet> set = std::make_unique<AreaSet>();
  std::unique_ptr<AreaList> configured = std::make_unique<AreaList>();
  MapFromOdom map;
  LocalPlane plane;
  uint64_t now_ns = 1'000'000'000;
  double east_m = 0.0;  // of the vehicle, as the INS says; it faces east, as odom's x axis
  bool is_heard = true;

  Areas() {
    EXPECT_EQ(map.Configure({}, {}), Status::kOk);
    EXPECT_EQ(plane.SetAnchor(kLatitude, kLongitude), Status::kOk);
  }
  Status Configure() { return set->Configure(*configured); }
  void Ticks(int count, const Pose2& pose_odom = {}) {
    for (int i = 0; i < count; ++i) {
      now_ns += kTick_ns;
      InsSample sample;
      sample.has_position = sample.has_attitude = sample.has_status = true;
      EXPECT_EQ(plane.ToGeodetic({static_cast<float>(east_m), 0.0f}, sample.latitude_ndeg,
                                 sample.longitude_ndeg),
                Status::kOk);
      sample.yaw_rad = static_cast<float>(M_PI / 2.0);
      sample.status.mode = InsMode::kTracking;
      sample.status.gnss_fix = true;
      sample.has_position_uncertainty = true;
      sample.position_uncertainty_m = 0.5f;
      if (is_heard) static_cast<void>(map.TakeIns(sample, pose_odom, 0.0f, now_ns));
      map.Advance(now_ns, pose_odom);
      set->Advance(map);
    }
  }
  Area OnEarth(AreaKind kind, double low_x, double low_y, double high_x, double high_y) {
    Area area;
    area.kind = kind;
    area.frame = AreaFrame::kEarth;
    for (const testing::Place& place : Box(low_x, low_y, high_x, high_y)) {
      AreaCorner& corner = area.corner[area.corners++];
      EXPECT_EQ(plane.ToGeodetic({static_cast<float>(place.x), static_cast<float>(place.y)},
                                 corner.latitude_ndeg, corner.longitude_ndeg),
                Status::kOk);
    }
    return area;
  }
};

const Footprint kFootprint = FootprintOf(VehicleParams{});

TEST(AreaSet, IsEmptyAndKnownAtFirst) {
  Areas areas;
  EXPECT_TRUE(areas.set->empty());
  EXPECT_TRUE(areas.set->is_known());
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {}), -1);
  EXPECT_TRUE(areas.set->Permits({1.0e5f, 0.0f}));
}

// SR-ARE04
TEST(AreaSet, IsKnownOnceAllHaveArrivedInOrder) {
  Areas areas;
  const Area one = AreaOf(AreaKind::kKeepOut, Box(5, 5, 6, 6));
  EXPECT_EQ(areas.set->Take(1, 3, one), Status::kInvalidArgument) << "not the first";
  EXPECT_TRUE(areas.set->is_known());
  ASSERT_EQ(areas.set->Take(0, 3, one), Status::kOk);
  EXPECT_FALSE(areas.set->is_known());
  EXPECT_EQ(areas.set->Take(2, 3, one), Status::kInvalidArgument) << "one is missing";
  EXPECT_EQ(areas.set->Take(1, 4, one), Status::kInvalidArgument) << "another count";
  ASSERT_EQ(areas.set->Take(1, 3, one), Status::kOk);
  EXPECT_EQ(areas.set->Take(1, 3, one), Status::kInvalidArgument) << "twice";
  ASSERT_EQ(areas.set->Take(2, 3, one), Status::kOk);
  EXPECT_TRUE(areas.set->is_known());
  EXPECT_EQ(areas.set->size(), 3);
  EXPECT_EQ(areas.set->Take(3, 3, one), Status::kInvalidArgument) << "one too many";
  // A new set replaces it, also if its first area is refused.
  EXPECT_EQ(areas.set->Take(0, 2, AreaOf(AreaKind::kKeepOut, Box(0, 0, 0.1, 0.1))),
            Status::kAreaTooSmall);
  EXPECT_EQ(areas.set->size(), 0);
  EXPECT_FALSE(areas.set->is_known());
  areas.set->Clear();
  EXPECT_TRUE(areas.set->is_known());
}

TEST(AreaSet, ConfiguredAreasStayAndCount) {
  Areas areas;
  ASSERT_EQ(areas.configured->PushBack(AreaOf(AreaKind::kFence, Box(-9, -9, 9, 9))), Status::kOk);
  ASSERT_EQ(areas.Configure(), Status::kOk);
  EXPECT_EQ(areas.set->configured(), 1);
  EXPECT_EQ(areas.set->Take(0, 1, AreaOf(AreaKind::kFence, Box(-5, -5, 5, 5))),
            Status::kSecondFence);
  areas.set->Clear();
  EXPECT_EQ(areas.set->size(), 1);
  const Area one = AreaOf(AreaKind::kKeepOut, Box(5, 5, 6, 6));
  for (int i = 0; i < 63; ++i) ASSERT_EQ(areas.set->Take(i, 63, one), Status::kOk);
  EXPECT_TRUE(areas.set->is_known());
  EXPECT_EQ(areas.set->size(), kMaxAreas);
  EXPECT_EQ(areas.set->Take(0, 64, one), Status::kCapacityExceeded) << "the 65th";
  EXPECT_EQ(areas.set->Take(0, 65, one), Status::kInvalidArgument);
  EXPECT_EQ(areas.set->Take(0, 0, one), Status::kInvalidArgument);
}

TEST(AreaSet, RefusesAConfigurationAsAWhole) {
  Areas areas;
  ASSERT_EQ(areas.configured->PushBack(AreaOf(AreaKind::kFence, Box(-9, -9, 9, 9))), Status::kOk);
  ASSERT_EQ(areas.configured->PushBack(AreaOf(AreaKind::kFence, Box(-8, -8, 8, 8))), Status::kOk);
  EXPECT_EQ(areas.Configure(), Status::kSecondFence);
  EXPECT_TRUE(areas.set->empty());
}

// SR-ARE03
TEST(AreaSet, TellsTheFirstAreaThatIsBreached) {
  Areas areas;
  ASSERT_EQ(areas.set->Take(0, 3, AreaOf(AreaKind::kSpeedZone, Box(-5, -5, 5, 5), 1.0f)),
            Status::kOk);
  ASSERT_EQ(areas.set->Take(1, 3, AreaOf(AreaKind::kKeepOut, Box(10, -5, 12, 5))), Status::kOk);
  ASSERT_EQ(areas.set->Take(2, 3, AreaOf(AreaKind::kFence, Box(-20, -20, 40, 20))), Status::kOk);
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {0, 0, 0}), -1);
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {10.0f - kFootprint.front_m + 0.01f, 0, 0}), 1);
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {10.0f - kFootprint.front_m - 0.01f, 0, 0}), -1);
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {0, 20.0f - kFootprint.half_width_m + 0.01f, 0}), 2);
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {5000, 0, 0}), 2) << "far outside the fence";
  EXPECT_TRUE(areas.set->Permits({0, 0}));
  EXPECT_FALSE(areas.set->Permits({11, 0}));
  EXPECT_FALSE(areas.set->Permits({41, 0}));
  EXPECT_TRUE(areas.set->IsInZone(0, kFootprint, {0, 0, 0}, 0.0f, 0.0f));
  EXPECT_FALSE(areas.set->IsInZone(1, kFootprint, {11, 0, 0}, 0.0f, 0.0f));
  EXPECT_FALSE(areas.set->IsInZone(0, kFootprint, {50, 0, 0}, 1.0f, 1.0f));
}

// SR-ARE04
TEST(AreaSet, AnAreaOnEarthIsNotKnownBeforeItsPlaceIs) {
  Areas areas;
  areas.is_heard = false;
  ASSERT_EQ(areas.set->Take(0, 1, areas.OnEarth(AreaKind::kKeepOut, 10, -5, 12, 5)), Status::kOk);
  areas.Ticks(100);
  EXPECT_FALSE(areas.set->is_known());
  EXPECT_FALSE(areas.set->HasPlace(0));
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {11, 0, 0}), -1);
  areas.is_heard = true;
  areas.Ticks(3);
  EXPECT_TRUE(areas.set->is_known());
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {11, 0, 0}), 0);
  for (const int corner : {0, 1, 2, 3}) {
    EXPECT_NEAR((*areas.set)[0].corner[corner].x_mm, corner == 0 || corner == 3 ? 10000 : 12000,
                30);
    EXPECT_NEAR((*areas.set)[0].corner[corner].y_mm, corner < 2 ? -5000 : 5000, 30);
  }
}

TEST(AreaSet, AnAreaOnEarthFollowsTheTransformAndIsHeldWithoutTheIns) {
  Areas areas;
  areas.Ticks(50);
  ASSERT_EQ(areas.set->Take(0, 1, areas.OnEarth(AreaKind::kKeepOut, 10, -5, 12, 5)), Status::kOk);
  areas.Ticks(3);
  const int32_t before_mm = (*areas.set)[0].corner[0].x_mm;
  // The INS puts the vehicle, which has not moved in odom, 2 m farther east: the area is nearer.
  areas.east_m = 2.0;
  areas.Ticks(6000);
  EXPECT_NEAR((*areas.set)[0].corner[0].x_mm, before_mm - 2000, 100);
  const int32_t nearer_mm = (*areas.set)[0].corner[0].x_mm;
  areas.is_heard = false;
  areas.Ticks(1000);
  EXPECT_NE(areas.map.status(), MapStatus::kTracking);
  EXPECT_TRUE(areas.set->is_known()) << "the last known transform holds";
  EXPECT_EQ((*areas.set)[0].corner[0].x_mm, nearer_mm);
}

TEST(AreaSet, AnAreaWhoseTransformIsLostKeepsItsPlaceButIsNotKnown) {
  Areas areas;
  areas.Ticks(50);
  ASSERT_EQ(areas.set->Take(0, 1, areas.OnEarth(AreaKind::kKeepOut, 10, -5, 12, 5)), Status::kOk);
  areas.Ticks(3);
  areas.is_heard = false;
  areas.map.Restart();
  areas.Ticks(1);
  EXPECT_FALSE(areas.set->is_known());
  EXPECT_TRUE(areas.set->HasPlace(0));
  EXPECT_EQ(areas.set->BreachedBy(kFootprint, {11, 0, 0}), 0);
  areas.is_heard = true;
  areas.Ticks(3);
  EXPECT_TRUE(areas.set->is_known());
}

TEST(AreaSet, EveryAreaOnEarthIsPlacedInItsTurn) {
  Areas areas;
  areas.Ticks(50);
  for (int i = 0; i < kMaxAreas; ++i) {
    const Area area = i % 2 == 0 ? areas.OnEarth(AreaKind::kKeepOut, 10 + i, -5, 11 + i, 5)
                                 : AreaOf(AreaKind::kKeepOut, Box(10, 10, 12, 12));
    ASSERT_EQ(areas.set->Take(i, kMaxAreas, area), Status::kOk);
  }
  EXPECT_FALSE(areas.set->is_known());
  areas.Ticks(kMaxAreas);
  EXPECT_TRUE(areas.set->is_known());
}

// An area in another country has no place here: nothing is known of it.
TEST(AreaSet, AnAreaTooFarAwayIsNotKnown) {
  Areas areas;
  areas.Ticks(50);
  Area area = areas.OnEarth(AreaKind::kFence, -9, -9, 9, 9);
  for (int i = 0; i < area.corners; ++i) area.corner[i].latitude_ndeg -= 10'000'000'000;
  ASSERT_EQ(areas.set->Take(0, 1, area), Status::kOk);
  areas.Ticks(100);
  EXPECT_FALSE(areas.set->is_known());
}

}  // namespace
}  // namespace hardpack
