// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/map_from_odom.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hardpack {
namespace {

constexpr double kRadPerNdeg = M_PI / 180.0 * 1e-9;

// The exact plane that touches the ellipsoid, in double precision, by Cartesian coordinates.
struct Place {
  double east_m;
  double north_m;
};
Place ExactPlane(int64_t latitude0, int64_t longitude0, int64_t latitude, int64_t longitude) {
  const double f = 1.0 / 298.257223563;
  const double e2 = f * (2.0 - f);
  const auto cartesian = [&](double phi, double lambda, double(&xyz)[3]) {
    const double n = 6378137.0 / std::sqrt(1.0 - e2 * std::sin(phi) * std::sin(phi));
    xyz[0] = n * std::cos(phi) * std::cos(lambda);
    xyz[1] = n * std::cos(phi) * std::sin(lambda);
    xyz[2] = n * (1.0 - e2) * std::sin(phi);
  };
  const double phi = static_cast<double>(latitude0) * kRadPerNdeg;
  const double lambda = static_cast<double>(longitude0) * kRadPerNdeg;
  double a[3];
  double b[3];
  cartesian(phi, lambda, a);
  cartesian(static_cast<double>(latitude) * kRadPerNdeg,
            static_cast<double>(longitude) * kRadPerNdeg, b);
  const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return {
      -std::sin(lambda) * d[0] + std::cos(lambda) * d[1],
      -std::sin(phi) * (std::cos(lambda) * d[0] + std::sin(lambda) * d[1]) + std::cos(phi) * d[2]};
}

TEST(LocalPlane, IsTheExactPlaneToTwoCentimetresWithinTwentyKilometres) {
  std::mt19937 random(20250211);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double worst_m = 0.0;
  for (const double latitude_deg : {-80.0, -46.0, -0.01, 0.0, 30.6, 46.78, 60.0, 80.0}) {
    for (const double longitude_deg : {-180.0, -71.28, 0.0, 179.99}) {
      const auto latitude = static_cast<int64_t>(latitude_deg * 1e9);
      const auto longitude = static_cast<int64_t>(longitude_deg * 1e9);
      LocalPlane plane;
      ASSERT_EQ(plane.SetAnchor(latitude, longitude), Status::kOk);
      for (int i = 0; i < 200; ++i) {
        const double reach = i < 100 ? 0.18 : 0.002;  // degrees of the meridian
        int64_t there = latitude + static_cast<int64_t>(reach * 1e9 * unit(random));
        int64_t across = longitude + static_cast<int64_t>(reach * 1e9 * unit(random) /
                                                          std::cos(latitude_deg * M_PI / 180.0));
        if (across > 180'000'000'000) across -= 360'000'000'000;
        if (across < -180'000'000'000) across += 360'000'000'000;
        Vec2 place;
        ASSERT_EQ(plane.ToPlane(there, across, place), Status::kOk);
        const Place exact = ExactPlane(latitude, longitude, there, across);
        worst_m =
            std::max(worst_m, std::hypot(place.x_m - exact.east_m, place.y_m - exact.north_m));
        int64_t back_latitude = 0;
        int64_t back_longitude = 0;
        ASSERT_EQ(plane.ToGeodetic(place, back_latitude, back_longitude), Status::kOk);
        const Place back = ExactPlane(there, across, back_latitude, back_longitude);
        ASSERT_LT(std::hypot(back.east_m, back.north_m), 0.01) << latitude_deg << " " << i;
      }
    }
  }
  RecordProperty("worst_mm", static_cast<int>(worst_m * 1000.0));
  EXPECT_LT(worst_m, 0.02);
}

// By which way north is at a place in the east of the anchor.
TEST(LocalPlane, KnowsWhereNorthIsBesideTheAnchor) {
  LocalPlane plane;
  ASSERT_EQ(plane.SetAnchor(46'780'000'000, -71'280'000'000), Status::kOk);
  const int64_t latitude = 46'800'000'000;
  const int64_t longitude = -71'080'000'000;  // 15 km
  const Place here = ExactPlane(46'780'000'000, -71'280'000'000, latitude, longitude);
  const Place north = ExactPlane(46'780'000'000, -71'280'000'000, latitude + 10'000'000, longitude);
  const double turn = std::atan2(here.east_m - north.east_m, north.north_m - here.north_m);
  EXPECT_GT(turn, 0.002);
  EXPECT_NEAR(plane.Convergence(latitude, longitude), turn, 1e-5);
}

TEST(LocalPlane, RefusesPolesAndWhatIsFarAway) {
  LocalPlane plane;
  Vec2 place = {1.0f, 2.0f};
  EXPECT_EQ(plane.ToPlane(0, 0, place), Status::kNotStarted);
  EXPECT_EQ(plane.SetAnchor(86'000'000'000, 0), Status::kInvalidArgument);
  EXPECT_EQ(plane.SetAnchor(0, 181'000'000'000), Status::kInvalidArgument);
  EXPECT_EQ(plane.SetAnchor(INT64_MIN, INT64_MAX), Status::kInvalidArgument);
  ASSERT_EQ(plane.SetAnchor(46'780'000'000, -71'280'000'000), Status::kOk);
  EXPECT_EQ(plane.ToPlane(47'780'000'000, -71'280'000'000, place), Status::kInvalidArgument);
  EXPECT_EQ(plane.ToPlane(46'780'000'000, 108'720'000'000, place), Status::kInvalidArgument);
  EXPECT_EQ(plane.ToPlane(INT64_MAX, 0, place), Status::kInvalidArgument);
  int64_t latitude = 0;
  int64_t longitude = 0;
  EXPECT_EQ(plane.ToGeodetic({std::nanf(""), 0.0f}, latitude, longitude), Status::kNotFinite);
  EXPECT_EQ(plane.ToGeodetic({2e5f, 0.0f}, latitude, longitude), Status::kInvalidArgument);
  EXPECT_EQ(place.x_m, 1.0f);
}

// A vehicle that drives along odom's x axis, which lies at `turn_rad` from east; what the INS says.
struct Drive {
  static constexpr int64_t kLatitude = 46'780'000'000;
  static constexpr int64_t kLongitude = -71'280'000'000;
  static constexpr double kTurn_rad = 0.7;

  explicit Drive(const MapFromOdomParams& params = {}) {
    EXPECT_EQ(map.Configure(params, {}), Status::kOk);
    EXPECT_EQ(plane.SetAnchor(kLatitude, kLongitude), Status::kOk);
  }

  InsSample Ins(double noise_m = 0.0) {
    InsSample sample;
    sample.has_position = sample.has_attitude = sample.has_status = true;
    const double east_m = driven_m * std::cos(kTurn_rad) + jump_m + noise_m * normal(random);
    const double north_m = driven_m * std::sin(kTurn_rad) + noise_m * normal(random);
    EXPECT_EQ(plane.ToGeodetic({static_cast<float>(east_m), static_cast<float>(north_m)},
                               sample.latitude_ndeg, sample.longitude_ndeg),
              Status::kOk);
    sample.yaw_rad = static_cast<float>(M_PI / 2.0 - kTurn_rad);
    sample.status.mode = mode;
    sample.status.gnss_fix = true;
    sample.has_position_uncertainty = true;
    sample.position_uncertainty_m = 0.5f;
    return sample;
  }

  // 50 INS messages a second, while the vehicle drives.
  void Seconds(double seconds, double v_mps = 0.0, double noise_m = 0.0) {
    for (int i = 0; i < static_cast<int>(seconds * 50.0); ++i) {
      now_ns += 20'000'000;
      driven_m += 0.02 * v_mps;
      pose_odom.x_m = static_cast<float>(driven_m * odom_scale);
      if (is_heard) {
        static_cast<void>(
            map.TakeIns(Ins(noise_m), pose_odom, static_cast<float>(driven_m), now_ns));
      }
      map.Advance(now_ns, pose_odom);
    }
  }

  // Where a place on earth is in odom, less where it would be without an error.
  double GoalError(double along_m) {
    int64_t latitude = 0;
    int64_t longitude = 0;
    EXPECT_EQ(plane.ToGeodetic({static_cast<float>(along_m * std::cos(kTurn_rad)),
                                static_cast<float>(along_m * std::sin(kTurn_rad))},
                               latitude, longitude),
              Status::kOk);
    Vec2 goal;
    EXPECT_EQ(map.ToOdom(latitude, longitude, goal), Status::kOk);
    return std::hypot(goal.x_m - along_m, goal.y_m);
  }

  LocalPlane plane;
  MapFromOdom map;
  Pose2 pose_odom;
  uint64_t now_ns = 1'000'000'000;
  double driven_m = 0.0;
  double odom_scale = 1.0;  // of the way in odom
  double jump_m = 0.0;      // to the east, of the satellites
  bool is_heard = true;
  InsMode mode = InsMode::kTracking;
  std::mt19937 random{20250212};
  std::normal_distribution<double> normal;
};

TEST(MapFromOdom, FindsWhereOdomLiesOnEarth) {
  Drive drive;
  Vec2 goal;
  EXPECT_EQ(drive.map.status(), MapStatus::kNone);
  EXPECT_EQ(drive.map.ToOdom(Drive::kLatitude, Drive::kLongitude, goal), Status::kNotStarted);
  drive.Seconds(0.1);
  EXPECT_EQ(drive.map.status(), MapStatus::kTracking);
  EXPECT_NEAR(drive.map.map_from_odom().theta_rad, Drive::kTurn_rad, 1e-4);
  EXPECT_LT(drive.GoalError(100.0), 0.05);
  drive.Seconds(60.0, 3.0, 0.3);
  EXPECT_LT(drive.GoalError(200.0), 0.3);
  EXPECT_LT(drive.map.position_sigma_m(), 0.3f);
}

// odom drifts by 1 % of the way: where the vehicle is, the transform follows.
TEST(MapFromOdom, FollowsTheDriftOfOdom) {
  Drive drive;
  drive.odom_scale = 1.01;
  drive.Seconds(100.0, 3.0, 0.1);
  const Vec2 here = {static_cast<float>(300.0 * 1.01), 0.0f};
  int64_t latitude = 0;
  int64_t longitude = 0;
  ASSERT_EQ(drive.plane.ToGeodetic({static_cast<float>(300.0 * std::cos(Drive::kTurn_rad)),
                                    static_cast<float>(300.0 * std::sin(Drive::kTurn_rad))},
                                   latitude, longitude),
            Status::kOk);
  Vec2 place;
  ASSERT_EQ(drive.map.ToOdom(latitude, longitude, place), Status::kOk);
  EXPECT_LT(std::hypot(place.x_m - here.x_m, place.y_m - here.y_m), 0.5);
  EXPECT_EQ(drive.map.counters().rejected, 0u);
}

// SR-ODO04
TEST(MapFromOdom, RejectsAJumpThatGoesAway) {
  Drive drive;
  drive.Seconds(20.0, 2.0);
  const Pose2 before = drive.map.map_from_odom();
  drive.jump_m = 8.0;
  drive.Seconds(3.5, 2.0);
  EXPECT_EQ(drive.map.status(), MapStatus::kRejecting);
  drive.now_ns += 1'000'000'000;
  EXPECT_EQ(drive.map.TakeIns(drive.Ins(), drive.pose_odom, static_cast<float>(drive.driven_m),
                              drive.now_ns),
            Status::kLimitExceeded);
  EXPECT_NEAR(drive.map.map_from_odom().x_m, before.x_m, 0.01);
  EXPECT_NEAR(drive.map.map_from_odom().y_m, before.y_m, 0.01);
  EXPECT_NEAR(drive.map.map_from_odom().theta_rad, before.theta_rad, 1e-4);
  drive.jump_m = 0.0;
  drive.Seconds(1.0, 2.0);
  EXPECT_EQ(drive.map.status(), MapStatus::kTracking);
  EXPECT_EQ(drive.map.counters().relocations, 0u);
  EXPECT_GT(drive.map.counters().rejected, 30u);
}

// Then it is right, and is gone to slowly: 0.2 m/s.
// SR-ODO04
TEST(MapFromOdom, TakesAJumpThatPersistsAndGoesThereSlowly) {
  Drive drive;
  drive.Seconds(20.0);
  drive.jump_m = 8.0;
  drive.Seconds(4.8);
  EXPECT_LT(drive.GoalError(50.0), 0.05);
  drive.Seconds(0.5);
  EXPECT_EQ(drive.map.counters().relocations, 1u);
  double before_m = drive.GoalError(50.0);
  for (int i = 0; i < 45; ++i) {
    drive.Seconds(1.0);
    const double error_m = drive.GoalError(50.0);
    ASSERT_LT(error_m - before_m, 0.21) << i;
    before_m = error_m;
  }
  EXPECT_NEAR(before_m, 8.0, 0.1);
  EXPECT_EQ(drive.map.status(), MapStatus::kTracking);
}

// Satellites that jump about agree with nothing.
TEST(MapFromOdom, JumpsThatDoNotAgreeAreNotBelieved) {
  Drive drive;
  drive.Seconds(20.0);
  for (int i = 0; i < 30; ++i) {
    drive.jump_m = i % 2 == 0 ? 9.0 : -9.0;
    drive.Seconds(1.0);
  }
  EXPECT_EQ(drive.map.counters().relocations, 0u);
  EXPECT_LT(drive.GoalError(50.0), 0.1);
}

// SR-ODO04
TEST(MapFromOdom, KeepsTheTransformWhenTheInsIsLost) {
  for (const bool silent : {true, false}) {
    Drive drive;
    drive.Seconds(20.0, 2.0);
    const double before_m = drive.GoalError(100.0);
    drive.is_heard = !silent;
    drive.mode = silent ? InsMode::kTracking : InsMode::kNotTracking;
    drive.Seconds(30.0, 2.0);
    EXPECT_EQ(drive.map.status(), MapStatus::kHeld);
    EXPECT_NEAR(drive.GoalError(100.0), before_m, 0.02);
    drive.is_heard = true;
    drive.mode = InsMode::kTracking;
    drive.Seconds(0.2, 2.0);
    EXPECT_EQ(drive.map.status(), MapStatus::kTracking);
  }
}

TEST(MapFromOdom, BeginsAnewWhenOdomHasLostItsPlace) {
  Drive drive;
  drive.Seconds(20.0, 2.0);
  drive.map.Restart();
  EXPECT_EQ(drive.map.status(), MapStatus::kNone);
  drive.driven_m += 50.0;  // nobody saw it go there
  drive.odom_scale = 40.0 / drive.driven_m;
  drive.pose_odom.x_m = 40.0f;
  drive.Seconds(0.1);
  ASSERT_EQ(drive.map.status(), MapStatus::kTracking);
  EXPECT_NEAR(drive.GoalError(drive.driven_m), 50.0, 0.1);  // where the vehicle stands
}

TEST(MapFromOdom, TakesNothingThatIsNoPose) {
  Drive drive;
  drive.Seconds(1.0);
  InsSample sample = drive.Ins();
  drive.now_ns += 1'000'000'000;
  sample.has_position = false;
  EXPECT_EQ(drive.map.TakeIns(sample, {}, 0.0f, drive.now_ns), Status::kStale);
  EXPECT_EQ(drive.map.status(), MapStatus::kTracking);
  sample = drive.Ins();
  sample.yaw_rad = std::nanf("");
  EXPECT_EQ(drive.map.TakeIns(sample, {}, 0.0f, drive.now_ns), Status::kNotFinite);
  sample = drive.Ins();
  EXPECT_EQ(drive.map.TakeIns(sample, {.x_m = std::nanf("")}, 0.0f, drive.now_ns),
            Status::kNotFinite);
  sample.latitude_ndeg = 10'000'000'000;  // 4000 km
  EXPECT_EQ(drive.map.TakeIns(sample, {}, 0.0f, drive.now_ns), Status::kInvalidArgument);
  sample = drive.Ins();
  sample.status.imu_error = true;
  EXPECT_EQ(drive.map.TakeIns(sample, {}, 0.0f, drive.now_ns), Status::kStale);
  EXPECT_EQ(drive.map.status(), MapStatus::kHeld);
  MapFromOdom map;
  EXPECT_EQ(map.TakeIns(drive.Ins(), {}, 0.0f, 1), Status::kNotStarted);
  EXPECT_EQ(map.Configure({.gate_sigma = 0.0f}, {}), Status::kParameterOutOfRange);
}

}  // namespace
}  // namespace hardpack
