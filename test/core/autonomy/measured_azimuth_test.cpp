// SPDX-License-Identifier: Apache-2.0
// A sensor that fires where it happens to be, and says where that was: what it sees lies where it
// is, and the places of the grid that it leaves out are no loss.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "core/scan/sight_watch.h"
#include "test/core/autonomy/mapper_bench.h"

namespace hardpack::perception {
namespace {

constexpr double kColumn_rad = 2.0 * kPi_rad / kColumns;
constexpr double kPostX_m = 28.0;
constexpr double kPostY_m = 4.0;
constexpr double kPostRadius_m = 0.15;

// The bench's vehicle with a sensor that fires `firings` times a revolution, from 2.31 columns
// past its first place; `shift_columns` is added to each of its offsets, and the place that is
// named is as much off the other way.
class FreeFiring {
 public:
  explicit FreeFiring(int firings, double shift_columns = 0.0)
      : firings_(firings), shift_columns_(shift_columns) {
    bench.world.bodies = {
        Cylinder(kPostX_m, kPostY_m, kPostRadius_m, 1.6, kTreeCode),
        Box({6.05, -0.5, 0.0}, {6.6, 0.5, 1.0}),
    };
  }

  // The k-th firing; keeps: the offset is told.
  void Fire(int k, bool keeps = true) {
    const double turned = 2.31 + kColumns * static_cast<double>(k) / firings_;
    const auto whole = static_cast<int>(std::lround(turned + shift_columns_));
    const double offset_rad = (whole - turned) * kColumn_rad;
    now_ns = TimeOf_ns(0) + static_cast<uint64_t>(kRevolution_s * 1e9 * k / firings_);
    while (next_pose_ns_ <= now_ns + 20'000'000u) {
      ASSERT_EQ(bench.mapper->AddPose(StandingAt(next_pose_ns_)), Status::kOk);
      next_pose_ns_ += 10'000'000u;
    }
    Lidar lidar(static_cast<uint64_t>(k) + 1);
    column = lidar
                 .Cast(bench.world, Pose{}, 0.0, static_cast<uint16_t>(whole / kColumns),
                       static_cast<uint16_t>(whole % kColumns), offset_rad)
                 .first;
    if (!keeps) column.azimuth_offset_rad = 0.0f;
    ASSERT_EQ(bench.mapper->AddColumn(column, now_ns), Status::kOk) << k;
  }

  MapperBench bench{false};
  LidarColumn column;
  uint64_t now_ns = 0;

 private:
  int firings_;
  double shift_columns_;
  uint64_t next_pose_ns_ = TimeOf_ns(0);
};

// How far the returns of the post lie from its surface at most, and how many they are.
struct PostReturns {
  int count = 0;
  double furthest_m = 0.0;
};

PostReturns LookAtThePost(FreeFiring& sensor, bool keeps) {
  PostReturns post;
  for (int k = 0; k < 2 * kColumns; ++k) {
    sensor.Fire(k, keeps);
    for (const int16_t slot : sensor.bench.mapper->fresh()) {
      for (int row = 0; row < kBeams; ++row) {
        Vec2 point;
        if (sensor.bench.mapper->ObstacleOf(slot, row, 50'000, point) == 0) continue;
        const double away_m = std::hypot(point.x_m - kPostX_m, point.y_m - kPostY_m);
        if (away_m > 2.0) continue;
        ++post.count;
        post.furthest_m = std::max(post.furthest_m, std::abs(away_m - kPostRadius_m));
      }
    }
  }
  return post;
}

// 28 m away 1.8 columns are 0.3 m.
TEST(MeasuredAzimuth, APostLandsWhereItIs) {
  for (const double shift : {-1.4, 1.4}) {
    FreeFiring sensor(kColumns - 31, shift);
    const PostReturns post = LookAtThePost(sensor, true);
    EXPECT_GT(post.count, 10);
    EXPECT_LT(post.furthest_m, 0.1) << shift;
  }
}

TEST(MeasuredAzimuth, APostLandsBesideItWhereTheOffsetsAreDropped) {
  for (const double shift : {-1.4, 1.4}) {
    FreeFiring sensor(kColumns - 31, shift);
    const PostReturns post = LookAtThePost(sensor, false);
    EXPECT_GT(post.count, 10);
    EXPECT_GT(post.furthest_m, 0.2) << shift;
  }
}

// In the map, too: by what is filed and by what is pending.
TEST(MeasuredAzimuth, TheMapHasThePostInItsCells) {
  FreeFiring sensor(kColumns - 31, 1.4);
  for (int k = 0; k < 3 * kColumns; ++k) sensor.Fire(k);
  const Area about = {kPostX_m - 1.5, kPostY_m - 1.5, kPostX_m + 1.5, kPostY_m + 1.5};
  const Area cells = {kPostX_m - 0.3, kPostY_m - 0.3, kPostX_m + 0.3, kPostY_m + 0.3};
  const int hard = sensor.bench.Count(about, Costmap::kHard);
  EXPECT_GT(hard, 0);
  EXPECT_EQ(sensor.bench.Count(cells, Costmap::kHard), hard);
  EXPECT_GT(sensor.bench.HardInGrid(cells), 0);
  EXPECT_EQ(sensor.bench.HardInGrid(about), sensor.bench.HardInGrid(cells));
}

// Ground that rises to the left by 1 in 5, about straight ahead, 16 to 28 m away: how high it is
// filed above where it is, on average. Filed 1.4 columns aside it would be 3 cm off.
double GroundTooHigh_m(double shift_columns) {
  FreeFiring sensor(kColumns - 31, shift_columns);
  sensor.bench.world.bodies.clear();
  sensor.bench.world.ground = Ground({{-1000.0, -200.0}, {1000.0, 200.0}}, 0.5 * kPi_rad);
  for (int k = 0; k < 2 * kColumns; ++k) sensor.Fire(k);
  const Area ahead = {16.0, -3.0, 28.0, 3.0};
  double sum_m = 0.0;
  int cells = 0;
  ahead.ForEach([&](Cell cell) {
    const HeightGrid::CellHeights heights = sensor.bench.mapper->heights().At(cell);
    if (!heights.ground) return;
    sum_m += 0.01 * heights.lowest_cm - 0.2 * (0.2 * cell.y + 0.1);
    ++cells;
  });
  EXPECT_GT(cells, 100);
  return sum_m / cells;
}

TEST(MeasuredAzimuth, TheGroundLiesWhereItIs) {
  const double own_m = GroundTooHigh_m(0.0);
  EXPECT_NEAR(GroundTooHigh_m(1.4), own_m, 0.01);
  EXPECT_NEAR(GroundTooHigh_m(-1.4), own_m, 0.01);
}

// 3 of 100 places are left out: nothing is lost, nothing else is seen.
TEST(MeasuredAzimuth, PlacesLeftOutAreNoObstaclesAndNoLoss) {
  FreeFiring sensor(kColumns - 31);
  for (int k = 0; k < 3 * (kColumns - 31); ++k) sensor.Fire(k);
  const Mapper& mapper = *sensor.bench.mapper;
  EXPECT_EQ(mapper.ring().counters().columns, 3u * (kColumns - 31));
  EXPECT_EQ(mapper.ring().counters().duplicates, 0u);
  EXPECT_EQ(mapper.counters().late_unclassed_columns, 0u);
  EXPECT_EQ(sensor.bench.Count({1.0, -5.0, 5.8, 5.0}, Costmap::kHard), 0);
  EXPECT_GT(sensor.bench.Count(MapperBench::kBox, Costmap::kHard), 3);
  for (double angle = -3.1; angle < 3.1; angle += 0.001) {
    const Vec2 direction = {static_cast<float>(std::cos(angle)),
                            static_cast<float>(std::sin(angle))};
    const uint64_t seen_ns = mapper.NewestLook_ns(direction);
    ASSERT_LT(static_cast<double>(sensor.now_ns - seen_ns), 1.01e9 * kRevolution_s) << angle;
  }
}

TEST(MeasuredAzimuth, AHealthySensorIsSeenToLookEverywhere) {
  FreeFiring sensor(kColumns - 31);
  const auto watch = std::make_unique<SightWatch>();
  const PerceptionParams& params = sensor.bench.params;
  BeamModel model = sensor.bench.mapper->model();
  model.fired_per_revolution = kColumns - 31;
  ASSERT_EQ(watch->Configure(params.mount, SafetyParams{}, model, 24, 0, kColumns - 1),
            Status::kOk);
  for (int k = 0; k < 4 * (kColumns - 31); ++k) {
    sensor.Fire(k);
    // Between two packets the offset to the sensor's clock moves by half a millisecond.
    const uint64_t moved_ns = k / 24 % 2 == 0 ? 0 : 500'000;
    watch->Take(sensor.column, sensor.now_ns + moved_ns);
    if (k < 2 * kColumns) continue;
    ASSERT_EQ(watch->OldSectors(sensor.now_ns, 0.21f), 0) << k;
    ASSERT_NEAR(static_cast<double>(watch->revolution_ns()), 1e9 * kRevolution_s,
                1e7 * kRevolution_s);
  }
  for (int part = 0; part < SightWatch::kShown; ++part) {
    const SightWatch::Shares shares = watch->SharesOf(part, sensor.now_ns);
    EXPECT_GE(shares.columns_permille, 980) << part;
    EXPECT_EQ(shares.cause, SightCause::kNone) << part;
  }
  EXPECT_EQ(watch->frozen_sectors(), 0);
}

TEST(MeasuredAzimuth, AnOffsetThatIsNoneIsRefused) {
  MapperBench bench(false);
  bench.GiveAll(0, 10);
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), 0.02f, -0.02f}) {
    LidarColumn column = bench.Cast(11).first;
    column.azimuth_offset_rad = wrong;
    EXPECT_EQ(bench.mapper->AddColumn(column, TimeOf_ns(11)), Status::kBadColumn);
  }
  EXPECT_EQ(bench.mapper->ring().counters().bad_columns, 3u);
  EXPECT_EQ(bench.Give(11), Status::kOk);
}

}  // namespace
}  // namespace hardpack::perception
