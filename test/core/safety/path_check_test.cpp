// SPDX-License-Identifier: Apache-2.0
#include "core/safety/path_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/base/math.h"

namespace hardpack {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

// A map of hard cells, with the distances that the check may use, filled in the slow way.
class Ground {
 public:
  explicit Ground(Cell origin = {-256, -256}) : map_(std::make_unique<Costmap>()) {
    map_->window.origin = origin;
    std::memset(map_->cost_q8, 0, sizeof(map_->cost_q8));
    std::memset(map_->flags, 0, sizeof(map_->flags));
    std::memset(map_->hard_distance2, 255, sizeof(map_->hard_distance2));
    std::memset(map_->hard_depth2, 0, sizeof(map_->hard_depth2));
  }

  void SetHard(Cell cell) {
    hard_.push_back(cell);
    map_->flags[map_->window.Index(cell)] |= Costmap::kHard;
    for (int dy = -16; dy <= 16; ++dy) {
      for (int dx = -16; dx <= 16; ++dx) {
        const Cell other{cell.x + dx, cell.y + dy};
        if (!map_->window.Contains(other)) continue;
        uint8_t& distance2 = map_->hard_distance2[map_->window.Index(other)];
        distance2 = static_cast<uint8_t>(std::min(int{distance2}, dx * dx + dy * dy));
      }
    }
  }

  const Costmap& map() const { return *map_; }
  const std::vector<Cell>& hard() const { return hard_; }

 private:
  std::unique_ptr<Costmap> map_;
  std::vector<Cell> hard_;
};

WorldPath PathOf(const std::vector<Pose2>& poses) {
  WorldPath path;
  for (const Pose2& pose : poses) EXPECT_EQ(path.PushBack(pose), Status::kOk);
  return path;
}

WorldPath StraightPath(Pose2 from, int points, float step_m) {
  WorldPath path;
  for (int i = 0; i < points; ++i) {
    const float way_m = step_m * static_cast<float>(i);
    EXPECT_EQ(path.PushBack({from.x_m + way_m * std::cos(from.theta_rad),
                             from.y_m + way_m * std::sin(from.theta_rad), from.theta_rad}),
              Status::kOk);
  }
  return path;
}

// One disc of 0.8 m (four cells) about the middle.
VehicleParams Disc() {
  VehicleParams vehicle;
  vehicle.footprint_disc_radius_m = 0.8f;
  vehicle.footprint_disc_offset_m = 0.0f;
  return vehicle;
}

PathCheckResult Check(const Ground& ground, const WorldPath& path,
                      const VehicleParams& vehicle = {}, float start_curvature_per_m = 0.0f,
                      const OptimizerParams& limits = {}) {
  PathCheck check;
  EXPECT_EQ(check.Begin(vehicle, limits, path, start_curvature_per_m), Status::kOk);
  EXPECT_EQ(check.Step(ground.map(), path, PathCheck::kMaxUnits), Progress::kDone);
  return check.result();
}

// Distance of a point to the nearest hard square, in double, over every hard cell.
double NearestSquare_m(const Ground& ground, double x_m, double y_m) {
  double nearest = 1e9;
  for (const Cell& cell : ground.hard()) {
    const double low_x = 0.2 * cell.x;
    const double low_y = 0.2 * cell.y;
    const double dx = std::max({0.0, low_x - x_m, x_m - (low_x + 0.2)});
    const double dy = std::max({0.0, low_y - y_m, y_m - (low_y + 0.2)});
    nearest = std::min(nearest, std::hypot(dx, dy));
  }
  return nearest;
}

double NearestCentre_m(const Ground& ground, double x_m, double y_m) {
  double nearest = 1e9;
  for (const Cell& cell : ground.hard()) {
    nearest = std::min(nearest, std::hypot(0.2 * cell.x + 0.1 - x_m, 0.2 * cell.y + 0.1 - y_m));
  }
  return nearest;
}

double PoseClearance_m(const Ground& ground, const VehicleParams& vehicle, double x_m, double y_m,
                       double theta_rad) {
  const double arm_x = double{vehicle.footprint_disc_offset_m} * std::cos(theta_rad);
  const double arm_y = double{vehicle.footprint_disc_offset_m} * std::sin(theta_rad);
  return std::min(NearestSquare_m(ground, x_m + arm_x, y_m + arm_y),
                  NearestSquare_m(ground, x_m - arm_x, y_m - arm_y)) -
         double{vehicle.footprint_disc_radius_m};
}

struct Reference {
  double clearance_m = 1e9;
  double hard_distance_m = 1e9;
};

// Every chord and every turn, cut finely.
Reference SlowCheck(const Ground& ground, const VehicleParams& vehicle, const WorldPath& path,
                    double piece_m) {
  Reference reference;
  const auto judge = [&](double x, double y, double theta) {
    reference.clearance_m =
        std::min(reference.clearance_m, PoseClearance_m(ground, vehicle, x, y, theta));
    reference.hard_distance_m = std::min(reference.hard_distance_m, NearestCentre_m(ground, x, y));
  };
  for (int k = 0; k < path.size(); ++k) {
    const Pose2& p = path[k];
    if (k > 0) {
      const double turn = std::remainder(double{p.theta_rad} - double{path[k - 1].theta_rad},
                                         2.0 * 3.14159265358979323846);
      const int pieces =
          1 + static_cast<int>(std::abs(turn) * double{vehicle.footprint_disc_offset_m} / piece_m);
      for (int j = 0; j <= pieces; ++j) {
        judge(double{p.x_m}, double{p.y_m}, double{path[k - 1].theta_rad} + turn * j / pieces);
      }
    }
    judge(double{p.x_m}, double{p.y_m}, double{p.theta_rad});
    if (k + 1 == path.size()) break;
    const double dx = double{path[k + 1].x_m} - double{p.x_m};
    const double dy = double{path[k + 1].y_m} - double{p.y_m};
    const int pieces = 1 + static_cast<int>(std::hypot(dx, dy) / piece_m);
    for (int j = 0; j <= pieces; ++j) {
      judge(double{p.x_m} + dx * j / pieces, double{p.y_m} + dy * j / pieces, double{p.theta_rad});
    }
  }
  return reference;
}

TEST(PathCheck, IsCleanOnOpenGround) {
  const Ground ground;
  const PathCheckResult result = Check(ground, StraightPath({0.0f, 0.0f, 0.3f}, 40, 0.27f));
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.smallest_clearance_m, kClearanceReach_m);
  EXPECT_EQ(result.smallest_hard_distance_m, kClearanceReach_m);
  EXPECT_EQ(result.overlap_points, 0);
  EXPECT_FALSE(result.leaves_map);
}

//   ( )--->      disc of 4 cells
//      #         square 5 cells below the middle: one cell, 0.2 m, is left
TEST(PathCheck, MeasuresToTheSquareNotToItsMiddle) {
  Ground ground;
  ground.SetHard({10, -6});  // y from -1.2 to -1.0 m
  const PathCheckResult result = Check(ground, StraightPath({0.0f, 0.0f, 0.0f}, 20, 0.2f), Disc());
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_NEAR(result.smallest_clearance_m, 0.2f, 1e-6f);
  EXPECT_NEAR(result.smallest_hard_distance_m, 1.1f, 0.002f);  // between two samples
}

TEST(PathCheck, TakesTouchingExactlyForACollision) {
  Ground touching;
  touching.SetHard({10, -5});  // y from -1.0 to -0.8 m: the disc's radius away
  EXPECT_EQ(Check(touching, StraightPath({0.0f, 0.0f, 0.0f}, 20, 0.2f), Disc()).status,
            Status::kCollision);
  Ground free;
  free.SetHard({10, -6});
  EXPECT_EQ(Check(free, StraightPath({0.0f, 0.0f, 0.0f}, 20, 0.2f), Disc()).status, Status::kOk);
}

TEST(PathCheck, FindsACellBetweenTwoFarPoints) {
  Ground ground;
  ground.SetHard({50, 0});
  const PathCheckResult result =
      Check(ground, PathOf({{0.0f, 0.1f, 0.0f}, {30.0f, 0.1f, 0.0f}, {30.5f, 0.1f, 0.0f}}));
  EXPECT_EQ(result.status, Status::kCollision);
  EXPECT_NEAR(result.smallest_clearance_m, -VehicleParams{}.footprint_disc_radius_m, 1e-6f);
  EXPECT_EQ(result.smallest_clearance_point, 0);
  EXPECT_EQ(result.collision_point, 0);
}

//  the body along the wall clears it, across the way it does not
//   ====>            |
//   #######       ###v###
TEST(PathCheck, KnowsWhichWayTheVehicleIsTurned) {
  Ground ground;
  for (int x = -20; x <= 20; ++x) ground.SetHard({x, -6});  // top at -1.0 m
  // Along: 0.79 m to the side. Across: 0.38 + 0.79 m ahead.
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.0f, 0.0f}, 5, 0.2f)).status, Status::kOk);
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.8f, -kHalfPi}, 5, 0.2f)).status,
            Status::kCollision);
}

//     #        a turn on the spot sweeps past a cell that is clear before and after
//   ==== -> ||
TEST(PathCheck, SweepsATurnOnTheSpot) {
  Ground ground;
  // 45 degrees to the left, its nearest corner 1.13 m from the middle: within 0.38 + 0.79.
  ground.SetHard({4, 4});
  const Pose2 before{0.0f, 0.0f, 0.0f};
  const Pose2 after{0.0f, 0.0f, kHalfPi};
  EXPECT_EQ(Check(ground, PathOf({before, {-0.2f, 0.0f, 0.0f}})).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({after, {0.0f, -0.2f, kHalfPi}})).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({before, after})).status, Status::kCollision);
}

//    #      the discs pass below the cell on the long way from 115 to -115 degrees only
//  \   /
TEST(PathCheck, SweepsATurnTheShorterWay) {
  Ground ground;
  ground.SetHard({0, 6});  // 1.15 m to the left of (0.1, 0.05), within 0.38 + 0.79
  const Pose2 a{0.1f, 0.05f, 2.0f};
  const Pose2 left{0.1f, 0.05f, kHalfPi};
  const Pose2 b{0.1f, 0.05f, -2.0f};
  EXPECT_EQ(Check(ground, PathOf({a, b})).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({b, a})).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({a, left, b})).status, Status::kCollision);
}

TEST(PathCheck, SaysWhenThePathLeavesTheMap) {
  const Ground ground;  // 51.2 m to each side
  const WorldPath out = StraightPath({50.0f, 0.0f, 0.0f}, 10, 0.25f);
  const PathCheckResult result = Check(ground, out);
  EXPECT_TRUE(result.leaves_map);
  EXPECT_EQ(result.status, Status::kCollision);
  EXPECT_TRUE(Check(ground, StraightPath({-51.5f, 0.0f, 0.0f}, 10, 0.25f)).leaves_map);
  EXPECT_TRUE(Check(ground, PathOf({{0.0f, 0.0f, 0.0f}, {1e9f, 0.0f, 0.0f}})).leaves_map);
  const float most = std::numeric_limits<float>::max();
  EXPECT_TRUE(Check(ground, PathOf({{-most, 0.0f, 0.0f}, {most, 0.0f, 0.0f}})).leaves_map);
}

TEST(PathCheck, SeesTheLastCellsOfTheMapFromBeyondItsEdge) {
  Ground ground;
  ground.SetHard({255, 4});
  // The middle is on the map, the front disc is not.
  const PathCheckResult result = Check(ground, PathOf({{50.9f, 0.0f, 0.0f}, {51.1f, 0.0f, 0.0f}}));
  EXPECT_FALSE(result.leaves_map);
  EXPECT_NEAR(result.smallest_clearance_m, PoseClearance_m(ground, VehicleParams{}, 50.9, 0.0, 0.0),
              0.05);
  EXPECT_LT(result.smallest_clearance_m, 0.2f);
}

//   # inside the footprint, behind the middle, and one on the way
TEST(PathCheck, KeepsTheOverlapAtTheStartApartFromALaterCollision) {
  Ground ground;
  ground.SetHard({-5, 0});
  ground.SetHard({30, 0});
  const PathCheckResult result = Check(ground, StraightPath({0.0f, 0.1f, 0.0f}, 30, 0.25f));
  EXPECT_EQ(result.status, Status::kCollision);
  EXPECT_GT(result.collision_point, 10);
  EXPECT_GE(result.overlap_points, 2);
  EXPECT_LE(result.overlap_points, 4);
}

//   # inside the footprint, behind the middle: driving on leaves it, turning back does not
TEST(PathCheck, LetsAVehicleDriveOutOfAnOverlapAtItsStart) {
  Ground ground;
  ground.SetHard({-5, 0});
  const PathCheckResult out = Check(ground, StraightPath({0.0f, 0.1f, 0.0f}, 30, 0.25f));
  EXPECT_EQ(out.status, Status::kStartInObstacle);
  EXPECT_LT(out.smallest_clearance_m, 0.0f);
  // Up to the end of the chord of a quarter of a metre where it overlaps last.
  int chord = -1;
  for (int i = 0; i < 400; ++i) {
    const bool overlaps = PoseClearance_m(ground, VehicleParams{}, 0.0025 * i, 0.1, 0.0) <= 0.0;
    chord = overlaps ? i / 100 : chord;
  }
  EXPECT_EQ(out.overlap_points, chord + 2);
  // Into it:
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.1f, kPi}, 30, 0.25f)).status, Status::kCollision);
  // Out of it but not clear of it at the end:
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.1f, 0.0f}, 2, 0.1f)).status, Status::kCollision);
  EXPECT_EQ(out.collision_point, -1);
  // Out, and into another, from 6 m on: the front reaches it after 4.83 m.
  ground.SetHard({30, 0});
  const PathCheckResult into = Check(ground, StraightPath({0.0f, 0.1f, 0.0f}, 30, 0.25f));
  EXPECT_EQ(into.status, Status::kCollision);
  EXPECT_EQ(into.collision_point, 19);
}

//        #          the rear stands in a wall, which it may leave; the front meets a post beside
//   |# oo           the way before the rear has left the wall
TEST(PathCheck, MeetsASecondObstacleWhileLeavingTheFirst) {
  const WorldPath path = StraightPath({0.0f, 0.0f, 0.0f}, 12, 0.25f);
  Ground wall;
  wall.SetHard({-5, 0});
  EXPECT_EQ(Check(wall, path).status, Status::kStartInObstacle);
  Ground post;
  post.SetHard({5, 3});
  EXPECT_EQ(Check(post, path).status, Status::kCollision);
  wall.SetHard({5, 3});
  EXPECT_EQ(Check(wall, path).status, Status::kCollision);
}

TEST(PathCheck, ReportsCurvatureAndItsExcess) {
  const Ground ground;
  WorldPath arc;
  Pose2 pose;
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(arc.PushBack(pose), Status::kOk);
    pose = PlanarModel::Forward(pose, {0.15f, 0.25f});
  }
  const PathCheckResult result = Check(ground, arc, VehicleParams{}, 0.6f);
  EXPECT_EQ(result.status, Status::kLimitExceeded);
  EXPECT_NEAR(result.largest_curvature_per_m, 0.6f, 1e-4f);
  EXPECT_NEAR(result.curvature_excess_per_m, 0.1f, 1e-4f);
  EXPECT_EQ(result.curvature_rate_excess_per_m2, 0.0f);
  // The same from straight wheels: curvature 0.6 within a step.
  EXPECT_NEAR(Check(ground, arc).largest_curvature_rate_per_m2, 0.6f / 0.25f, 1e-3f);
  OptimizerParams wide;
  wide.max_curvature_per_m = 0.597f;  // within one per cent
  wide.max_curvature_rate_per_m2 = 3.0f;
  EXPECT_EQ(Check(ground, arc, VehicleParams{}, 0.0f, wide).status, Status::kOk);
}

TEST(PathCheck, TakesNoCurvatureWhereTheVehicleStands) {
  const Ground ground;
  WorldPath path = StraightPath({0.0f, 0.0f, 0.0f}, 5, 0.25f);
  const WorldPath behind = StraightPath({1.0f, 0.0f, 1.5f}, 5, 0.25f);
  for (const Pose2& pose : behind) EXPECT_EQ(path.PushBack(pose), Status::kOk);
  const PathCheckResult result = Check(ground, path);
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_LT(result.largest_curvature_per_m, 1e-3f);
}

TEST(PathCheck, ChecksADriveInReverse) {
  Ground ground;
  ground.SetHard({-20, 0});
  const WorldPath back = StraightPath({0.0f, 0.1f, 0.0f}, 30, -0.25f);
  EXPECT_EQ(Check(ground, back).status, Status::kCollision);
  const Ground empty;
  const PathCheckResult result = Check(empty, back);
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_LT(result.largest_curvature_per_m, 1e-3f);
}

TEST(PathCheck, RefusesBadInput) {
  const Ground ground;
  const WorldPath good = StraightPath({0.0f, 0.0f, 0.0f}, 5, 0.25f);
  PathCheck check;
  EXPECT_EQ(check.result().status, Status::kNotStarted);
  EXPECT_EQ(check.Step(ground.map(), good, 10), Progress::kDone);
  EXPECT_EQ(check.Begin({}, {}, WorldPath{}, 0.0f), Status::kPathTooShort);
  EXPECT_EQ(check.Begin({}, {}, PathOf({{}}), 0.0f), Status::kPathTooShort);
  for (const float bad : {kNan, kInf, -kInf}) {
    EXPECT_EQ(check.Begin({}, {}, good, bad), Status::kNotFinite);
    for (int field = 0; field < 3; ++field) {
      WorldPath path = good;
      (field == 0 ? path[2].x_m : field == 1 ? path[2].y_m : path[2].theta_rad) = bad;
      EXPECT_EQ(check.Begin({}, {}, path, 0.0f), Status::kNotFinite);
      EXPECT_EQ(check.result().status, Status::kNotFinite);
      EXPECT_EQ(check.Step(ground.map(), path, 10), Progress::kDone);
    }
  }
  for (const float bad : {-0.1f, 2.6f, kNan, kInf}) {
    VehicleParams vehicle;
    vehicle.footprint_disc_radius_m = bad;
    EXPECT_EQ(check.Begin(vehicle, {}, good, 0.0f), Status::kParameterOutOfRange);
    vehicle = {};
    vehicle.footprint_disc_offset_m = bad;
    EXPECT_EQ(check.Begin(vehicle, {}, good, 0.0f), Status::kParameterOutOfRange);
  }
}

struct Scene {
  Ground ground;
  WorldPath path;
  VehicleParams vehicle;
};

Scene RandomScene(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const auto within = [&](float size) { return size * (2.0f * unit(random) - 1.0f); };
  // A window far off, or one with its edge near the path.
  const int32_t far = seed % 3 == 0 ? 5000 : 0;
  const int32_t edge = seed % 3 == 1 ? 240 : 0;
  Scene scene{Ground({far - 256 + edge, far - 256}), {}, {}};
  scene.vehicle.footprint_disc_radius_m = 0.2f + 1.2f * unit(random);
  scene.vehicle.footprint_disc_offset_m = 0.8f * unit(random);
  const int cells = static_cast<int>(unit(random) * 40.0f);
  for (int i = 0; i < cells; ++i) {
    const Cell cell{far + static_cast<int32_t>(within(50.0f)),
                    far + static_cast<int32_t>(within(50.0f))};
    if (scene.ground.map().window.Contains(cell)) scene.ground.SetHard(cell);
  }
  Pose2 pose{0.2f * static_cast<float>(far) + within(2.0f),
             0.2f * static_cast<float>(far) + within(2.0f), within(3.1f)};
  const int points = 2 + static_cast<int>(unit(random) * 20.0f);
  for (int i = 0; i < points; ++i) {
    EXPECT_EQ(scene.path.PushBack(pose), Status::kOk);
    const bool pivot = unit(random) < 0.1f;
    pose = PlanarModel::Forward(pose,
                                {pivot ? within(3.0f) : within(0.3f), pivot ? 0.0f : within(0.5f)});
  }
  return scene;
}

TEST(PathCheck, AgreesWithASlowCheckOverEveryHardCell) {
  int collisions = 0;
  int clear = 0;
  for (uint32_t seed = 0; seed < 600; ++seed) {
    const Scene scene = RandomScene(seed);
    const PathCheckResult result = Check(scene.ground, scene.path, scene.vehicle);
    if (result.leaves_map) {
      bool outside = false;
      for (const Pose2& p : scene.path) {
        outside = outside || !scene.ground.map().window.Contains(CellAt({p.x_m, p.y_m}));
      }
      EXPECT_TRUE(outside) << "seed " << seed;
      continue;
    }
    const Reference fine = SlowCheck(scene.ground, scene.vehicle, scene.path, 0.004);
    const double reach = double{kClearanceReach_m};
    const double expected =
        std::max(std::min(fine.clearance_m, reach), -double{scene.vehicle.footprint_disc_radius_m});
    // Samples lie at most a quarter of a cell from every pose between them.
    EXPECT_GE(result.smallest_clearance_m, expected - 0.003) << "seed " << seed;
    EXPECT_LE(result.smallest_clearance_m, expected + 0.051) << "seed " << seed;
    EXPECT_GE(result.smallest_hard_distance_m, std::min(fine.hard_distance_m, reach) - 0.003)
        << "seed " << seed;
    EXPECT_LE(result.smallest_hard_distance_m, std::min(fine.hard_distance_m, reach) + 0.051)
        << "seed " << seed;
    const bool collides = result.status == Status::kCollision || result.overlap_points > 0;
    EXPECT_EQ(collides, result.smallest_clearance_m <= 0.0f) << "seed " << seed;
    collisions += collides ? 1 : 0;
    clear += collides ? 0 : 1;
  }
  EXPECT_GT(collisions, 50);
  EXPECT_GT(clear, 50);
}

TEST(PathCheck, GivesTheSameResultInAnyPortions) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    const Scene scene = RandomScene(seed);
    const PathCheckResult whole = Check(scene.ground, scene.path, scene.vehicle);
    PathCheck check;
    ASSERT_EQ(check.Begin(scene.vehicle, {}, scene.path, 0.0f), Status::kOk);
    std::mt19937 random(seed);
    while (check.Step(scene.ground.map(), scene.path, static_cast<int>(random() % 3u)) ==
           Progress::kBusy) {
    }
    const PathCheckResult& parts = check.result();
    EXPECT_EQ(parts.status, whole.status);
    EXPECT_EQ(parts.smallest_clearance_m, whole.smallest_clearance_m);
    EXPECT_EQ(parts.smallest_hard_distance_m, whole.smallest_hard_distance_m);
    EXPECT_EQ(parts.smallest_clearance_point, whole.smallest_clearance_point);
    EXPECT_EQ(parts.overlap_points, whole.overlap_points);
    EXPECT_EQ(parts.largest_curvature_per_m, whole.largest_curvature_per_m);
    EXPECT_EQ(parts.leaves_map, whole.leaves_map);
  }
}

}  // namespace
}  // namespace hardpack
