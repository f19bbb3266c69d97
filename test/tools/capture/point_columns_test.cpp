// SPDX-License-Identifier: Apache-2.0
// Plain points as the columns of a lidar: each is to be where it was.
#include "tools/capture/point_columns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/scan/scan.h"

namespace hardpack::capture {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;

CloudPoint PointAt(double elevation_deg, double azimuth_deg, double range_m, int ring = -1) {
  const double level_m = range_m * std::cos(elevation_deg * kRadian);
  return {{static_cast<float>(level_m * std::cos(azimuth_deg * kRadian)),
           static_cast<float>(level_m * std::sin(azimuth_deg * kRadian)),
           static_cast<float>(range_m * std::sin(elevation_deg * kRadian))},
          ring};
}

// A spinning lidar's points: `beams` elevations, 1 degree of azimuth from one to the next.
std::vector<CloudPoint> Spun(int beams, double noise_deg, bool with_rings) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise;
  std::vector<CloudPoint> points;
  for (int azimuth = 0; azimuth < 360; ++azimuth) {
    for (int beam = 0; beam < beams; ++beam) {
      const double elevation_deg = -15.0 + 30.0 * beam / (beams - 1);
      points.push_back(PointAt(elevation_deg + noise_deg * noise(random), azimuth + 0.2,
                               5.0 + 0.05 * azimuth + 0.1 * beam, with_rings ? beam : -1));
    }
  }
  return points;
}

// The points that the columns are of, in their order.
std::vector<Vec3> PointsOf(const PointColumns& columns) {
  std::vector<Vec3> points;
  for (const LidarColumn& column : columns.columns) {
    if (!column.valid) continue;
    const SinCosPair encoder = EncoderSinCos(columns.model, column.measurement_id);
    for (int row = 0; row < column.beams; ++row) {
      if (column.range_mm[row] == 0) continue;
      points.push_back(PointInSensor(columns.model, encoder, row, column.range_mm[row]));
    }
  }
  return points;
}

double Distance_m(const Vec3& a, const Vec3& b) {
  return std::hypot(double{a.x_m} - double{b.x_m}, double{a.y_m} - double{b.y_m},
                    double{a.z_m} - double{b.z_m});
}

// Each point of the cloud is within so many degrees of one of the columns'.
void ExpectAllWithin(const std::vector<CloudPoint>& cloud, const PointColumns& columns,
                     double error_deg) {
  const std::vector<Vec3> points = PointsOf(columns);
  for (const CloudPoint& point : cloud) {
    double nearest_m = 1.0e9;
    for (const Vec3& other : points) {
      nearest_m = std::min(nearest_m, Distance_m(point.position, other));
    }
    const double range_m = Distance_m(point.position, {});
    ASSERT_LT(nearest_m, range_m * error_deg * kRadian + 0.001);
  }
}

TEST(PointColumns, KeepsEachPointOfALidarWhoseRingsAreTold) {
  const std::vector<CloudPoint> cloud = Spun(16, 0.0, true);
  PointColumns columns;
  ASSERT_TRUE(MakeColumns(cloud, columns).ok());
  EXPECT_EQ(columns.rows, RowsFrom::kRing);
  EXPECT_EQ(columns.model.beams, 16);
  EXPECT_EQ(columns.model.columns_per_revolution, 2048);
  EXPECT_EQ(columns.hidden, 0);
  EXPECT_EQ(PointsOf(columns).size(), cloud.size());
  ExpectAllWithin(cloud, columns, 180.0 / 2048);  // half a column
}

TEST(PointColumns, FindsTheBeamsByTheirElevations) {
  const std::vector<CloudPoint> cloud = Spun(32, 0.004, false);
  PointColumns columns;
  ASSERT_TRUE(MakeColumns(cloud, columns).ok());
  EXPECT_EQ(columns.rows, RowsFrom::kElevation);
  EXPECT_EQ(columns.model.beams, 32);
  EXPECT_LT(columns.largest_elevation_error_rad, 0.03 * kRadian);
  EXPECT_EQ(PointsOf(columns).size(), cloud.size());
  ExpectAllWithin(cloud, columns, 0.1);
}

TEST(PointColumns, TakesEvenRowsWhereThereAreNoBeams) {
  const std::vector<CloudPoint> cloud = Spun(100, 0.3, false);
  PointColumns columns;
  ASSERT_TRUE(MakeColumns(cloud, columns).ok());
  EXPECT_EQ(columns.rows, RowsFrom::kEven);
  EXPECT_EQ(columns.model.beams, kMaxBeams);
  EXPECT_EQ(columns.model.columns_per_revolution, 1024);
  const double step_rad = 31.6 / 127 * kRadian;
  EXPECT_LE(columns.largest_elevation_error_rad, step_rad / 2.0 * 1.05);
  EXPECT_GT(columns.largest_elevation_error_rad, step_rad / 4.0);
}

TEST(PointColumns, OfTwoPointsInOneDirectionTheNearerIsFiled) {
  PointColumns columns;
  ASSERT_TRUE(
      MakeColumns({PointAt(0, 10, 9.0), PointAt(0, 10, 4.0), PointAt(0, 10, 6.0)}, columns).ok());
  EXPECT_EQ(columns.hidden, 2);
  ASSERT_EQ(PointsOf(columns).size(), 1u);
  EXPECT_NEAR(Distance_m(PointsOf(columns)[0], {}), 4.0, 0.001);
}

TEST(PointColumns, OnePointIsALidarOfOneBeam) {
  PointColumns columns;
  ASSERT_TRUE(MakeColumns({PointAt(-89.9, -180, 2.0)}, columns).ok());
  EXPECT_EQ(columns.model.beams, 1);
  ExpectAllWithin({PointAt(-89.9, -180, 2.0)}, columns, 0.1);
}

TEST(PointColumns, RefusesWhatNoLidarSees) {
  PointColumns columns;
  EXPECT_EQ(MakeColumns({}, columns).status, Status::kEmpty);
  EXPECT_EQ(MakeColumns({PointAt(0, 0, 0.0), PointAt(0, 0, 501.0)}, columns).status,
            Status::kEmpty);
  std::vector<CloudPoint> many;
  for (int ring = 0; ring <= kMaxBeams; ++ring) many.push_back(PointAt(ring * 0.1, 0, 5.0, ring));
  EXPECT_EQ(MakeColumns(many, columns).status, Status::kCapacityExceeded);
  many.pop_back();
  EXPECT_TRUE(MakeColumns(many, columns).ok());
}

}  // namespace
}  // namespace hardpack::capture
