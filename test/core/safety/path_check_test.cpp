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
#include "test/core/base/rounds.h"
#include "test/core/safety/path_of.h"
#include "test/core/safety/rectangle.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
using testing::PathOf;

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

VehicleParams VehicleOfSize(float length_m, float width_m, float axle_offset_m = 0.0f) {
  VehicleParams vehicle;
  vehicle.length_m = length_m;
  vehicle.width_m = width_m;
  vehicle.axle_offset_m = axle_offset_m;
  return vehicle;
}

// 0.8 m (four cells) to each side.
VehicleParams Square() {
  return VehicleOfSize(1.6f, 1.6f);
}

PathCheckResult Check(const Ground& ground, const WorldPath& path,
                      const VehicleParams& vehicle = {}, float start_curvature_per_m = 0.0f,
                      const OptimizerParams& limits = {}, float margin_m = 0.0f,
                      int across_chords = 0) {
  PathCheck check;
  EXPECT_EQ(check.Begin(vehicle, limits, path, start_curvature_per_m, margin_m, across_chords),
            Status::kOk);
  EXPECT_EQ(check.Step(ground.map(), path, PathCheck::kMaxUnits), Progress::kDone);
  return check.result();
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
  const Quad outline = OutlineQuad(vehicle, x_m, y_m, theta_rad);
  const double reach = double{PivotRadiusOf(vehicle)};
  double nearest = 1e9;
  for (const Cell& cell : ground.hard()) {
    const double low_x = 0.2 * cell.x;
    const double low_y = 0.2 * cell.y;
    // No nearer than its corner is, less its diagonal and the outline's reach.
    const double least = std::hypot(low_x - x_m, low_y - y_m) - 0.29 - reach;
    if (least > std::min(nearest, 2.5)) continue;
    nearest = std::min(nearest,
                       DistanceBetween(outline, BoxQuad(low_x, low_y, low_x + 0.2, low_y + 0.2)));
  }
  return nearest;
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
          1 + static_cast<int>(std::abs(turn) * double{PivotRadiusOf(vehicle)} / piece_m);
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

//   [ ]--->      4 cells to the side
//      #         square 5 cells below the middle: one cell, 0.2 m, is left
TEST(PathCheck, MeasuresToTheSquareNotToItsMiddle) {
  Ground ground;
  ground.SetHard({10, -6});  // y from -1.2 to -1.0 m
  const PathCheckResult result =
      Check(ground, StraightPath({0.0f, 0.0f, 0.0f}, 20, 0.2f), Square());
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_NEAR(result.smallest_clearance_m, 0.2f, 1e-6f);
  EXPECT_NEAR(result.smallest_hard_distance_m, 1.1f, 0.002f);  // between two samples
}

// SR-PLN01
TEST(PathCheck, TakesTouchingExactlyForACollision) {
  Ground touching;
  touching.SetHard({10, -5});  // y from -1.0 to -0.8 m: the disc's radius away
  EXPECT_EQ(Check(touching, StraightPath({0.0f, 0.0f, 0.0f}, 20, 0.2f), Square()).status,
            Status::kCollision);
  Ground free;
  free.SetHard({10, -6});
  EXPECT_EQ(Check(free, StraightPath({0.0f, 0.0f, 0.0f}, 20, 0.2f), Square()).status, Status::kOk);
}

// SR-PLN01
TEST(PathCheck, FindsACellBetweenTwoFarPoints) {
  Ground ground;
  ground.SetHard({50, 0});
  const PathCheckResult result =
      Check(ground, PathOf({{0.0f, 0.1f, 0.0f}, {30.0f, 0.1f, 0.0f}, {30.5f, 0.1f, 0.0f}}));
  EXPECT_EQ(result.status, Status::kCollision);
  EXPECT_EQ(result.smallest_clearance_m, 0.0f);
  EXPECT_EQ(result.smallest_clearance_point, 0);
  EXPECT_EQ(result.collision_point, 0);
}

//  the body along the wall clears it, across the way it does not
//   ====>            |
//   #######       ###v###
TEST(PathCheck, KnowsWhichWayTheVehicleIsTurned) {
  Ground ground;
  for (int x = -20; x <= 20; ++x) ground.SetHard({x, -6});  // top at -1.0 m
  // Along: 0.69 m to the side. Across: 0.76 m ahead of -0.5.
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.0f, 0.0f}, 5, 0.2f)).status, Status::kOk);
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.3f, -kHalfPi}, 5, 0.2f)).status,
            Status::kCollision);
}

//     #        a turn on the spot sweeps past a cell that is clear before and after
//   ==== -> ||
// SR-PLN01
TEST(PathCheck, SweepsATurnOnTheSpot) {
  Ground ground;
  // Ahead to the left, its nearest corner 1.0 m from the middle: within the corner's 1.03.
  ground.SetHard({3, 4});
  const Pose2 before{0.0f, 0.0f, 0.0f};
  const Pose2 after{0.0f, 0.0f, kHalfPi};
  EXPECT_EQ(Check(ground, PathOf({before, {-0.2f, 0.0f, 0.0f}})).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({after, {0.0f, -0.2f, kHalfPi}})).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({before, after})).status, Status::kCollision);
}

//    #      a long vehicle's front passes the cell on the long way from 115 to -115 degrees only
//  \   /
TEST(PathCheck, SweepsATurnTheShorterWay) {
  Ground ground;
  ground.SetHard({0, 6});  // 1.15 m to the left of (0.1, 0.05), within 1.5
  const VehicleParams rod = VehicleOfSize(3.0f, 0.6f);
  const Pose2 a{0.1f, 0.05f, 2.0f};
  const Pose2 left{0.1f, 0.05f, kHalfPi};
  const Pose2 b{0.1f, 0.05f, -2.0f};
  EXPECT_EQ(Check(ground, PathOf({a, b}), rod).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({b, a}), rod).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({a, left, b}), rod).status, Status::kCollision);
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
  // The axle is on the map, the front is not.
  const PathCheckResult result = Check(ground, PathOf({{50.9f, 0.0f, 0.0f}, {51.1f, 0.0f, 0.0f}}));
  EXPECT_FALSE(result.leaves_map);
  EXPECT_NEAR(result.smallest_clearance_m, PoseClearance_m(ground, VehicleParams{}, 50.9, 0.0, 0.0),
              0.05);
  EXPECT_LT(result.smallest_clearance_m, 0.2f);
}

//   # inside the footprint, behind the middle, and one on the way
TEST(PathCheck, KeepsTheOverlapAtTheStartApartFromALaterCollision) {
  Ground ground;
  ground.SetHard({-4, 0});
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
  ground.SetHard({-4, 0});
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
  // Out, and into another, from 6 m on: the front reaches it after 5.24 m.
  ground.SetHard({30, 0});
  const PathCheckResult into = Check(ground, StraightPath({0.0f, 0.1f, 0.0f}, 30, 0.25f));
  EXPECT_EQ(into.status, Status::kCollision);
  EXPECT_EQ(into.collision_point, 20);
}

//        #          the rear stands in a wall, which it may leave; the front meets a post beside
//   |# oo           the way before the rear has left the wall
TEST(PathCheck, MeetsASecondObstacleWhileLeavingTheFirst) {
  const WorldPath path = StraightPath({0.0f, 0.0f, 0.0f}, 12, 0.25f);
  Ground wall;
  wall.SetHard({-4, 0});
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
  EXPECT_GE(result.sharpest_point, 1);
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
  EXPECT_EQ(check.Begin({}, {}, WorldPath{}, 0.0f, 0.1f), Status::kPathTooShort);
  EXPECT_EQ(check.Begin({}, {}, PathOf({{}}), 0.0f, 0.1f), Status::kPathTooShort);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(check.Begin({}, {}, good, bad, 0.1f), Status::kNotFinite);
    for (int field = 0; field < 3; ++field) {
      WorldPath path = good;
      (field == 0 ? path[2].x_m : field == 1 ? path[2].y_m : path[2].theta_rad) = bad;
      EXPECT_EQ(check.Begin({}, {}, path, 0.0f, 0.1f), Status::kNotFinite);
      EXPECT_EQ(check.result().status, Status::kNotFinite);
      EXPECT_EQ(check.Step(ground.map(), path, 10), Progress::kDone);
    }
  }
  for (const float bad : {-0.1f, 6.1f, kNaN, kInfinity}) {
    for (const VehicleParams& vehicle : {VehicleOfSize(bad, 1.0f), VehicleOfSize(1.0f, bad),
                                         VehicleOfSize(1.0f, 1.0f, std::abs(bad) * 6.0f)}) {
      EXPECT_EQ(check.Begin(vehicle, {}, good, 0.0f, 0.1f), Status::kParameterOutOfRange) << bad;
    }
    EXPECT_EQ(check.Begin({}, {}, good, 0.0f, bad), Status::kParameterOutOfRange) << bad;
  }
}

// SR-GEO02: a path is only ok with the margin all along; by a millimetre.
//   ====>      flank at -0.69
//   -----      wall at -1.0: 0.31 m
TEST(PathCheck, KeepsTheMarginThatIsAskedFor) {
  Ground ground;
  for (int x = -40; x <= 60; ++x) ground.SetHard({x, -6});
  // Begins 0.5 m away from it and comes down to it.
  WorldPath path = StraightPath({0.0f, 0.19f, 0.0f}, 5, 0.25f);
  EXPECT_EQ(Check(ground, path, {}, 0.0f, {}, 0.499f).status, Status::kOk);
  EXPECT_EQ(path.PushBack({2.0f, 0.0f, 0.0f}), Status::kOk);  // a chord across its heading
  EXPECT_EQ(path.PushBack({4.0f, 0.0f, 0.0f}), Status::kOk);
  const float between_m = 0.5f * 0.19f / 11.0f;
  EXPECT_EQ(Check(ground, path, {}, 0.0f, {}, 0.309f - between_m).status, Status::kOk);
  const PathCheckResult near = Check(ground, path, {}, 0.0f, {}, 0.311f);
  EXPECT_EQ(near.status, Status::kCollision);
  EXPECT_GE(near.collision_point, 4);
}

//   ====>      flank 0.06 m from the wall: along it, yes, towards it, no; and ahead the margin
//   -----  #   holds all the same
// SR-GEO02
TEST(PathCheck, LeavesAStartWithinTheMargin) {
  Ground ground;
  for (int x = -40; x <= 60; ++x) ground.SetHard({x, -6});  // top at -1.0 m
  const float y_m = -0.25f;
  const auto judge = [&](const WorldPath& path) { return Check(ground, path, {}, 0.0f, {}, 0.1f); };
  const PathCheckResult along = judge(StraightPath({0.0f, y_m, 0.0f}, 20, 0.25f));
  EXPECT_EQ(along.status, Status::kNarrowGap);
  EXPECT_FALSE(along.start_overlaps);
  EXPECT_NEAR(along.smallest_clearance_m, 0.06f, 1e-4f);
  EXPECT_EQ(judge(StraightPath({0.0f, y_m, 0.0f}, 2, 0.25f)).status, Status::kNarrowGap);
  // Away from it, the rear corner swings towards it by less than what is left.
  EXPECT_EQ(judge(StraightPath({0.0f, y_m, 0.02f}, 20, 0.25f)).status, Status::kNarrowGap);
  EXPECT_EQ(judge(StraightPath({0.0f, y_m, -0.05f}, 20, 0.25f)).status, Status::kCollision);
  EXPECT_EQ(judge(PathOf({{0.0f, y_m, 0.0f}, {0.0f, y_m, 0.5f}})).status, Status::kCollision);
  // A post ahead: not nearer than the margin, since it was not at the start.
  ground.SetHard({20, -2});
  const PathCheckResult ahead = judge(StraightPath({0.0f, y_m, 0.0f}, 14, 0.25f));
  EXPECT_EQ(ahead.status, Status::kCollision);  // 3.25 + 0.76 > 4.0
  EXPECT_EQ(judge(StraightPath({0.0f, y_m, 0.0f}, 13, 0.25f)).status, Status::kNarrowGap);
  EXPECT_EQ(judge(StraightPath({0.15f, y_m, 0.0f}, 13, 0.25f)).status, Status::kCollision);
}

//   [ > ] - - -      flank at y = -0.69 m; a row of cells ahead whose upper edge lies at -0.6: what
//        ########    stands in them may stand beside the flank
// SR-STA01
TEST(PathCheck, CellsMayLieAcrossAFlankOnTheFirstChords) {
  const VehicleParams vehicle = VehicleOfSize(1.52f, 1.38f);
  const WorldPath path = StraightPath({0.0f, 0.0f, 0.0f}, 21, 0.25f);
  const auto judge = [&](const Ground& ground, int across_chords) {
    return Check(ground, path, vehicle, 0.0f, {}, 0.1f, across_chords);
  };
  Ground beside;
  for (int x = 6; x <= 12; ++x) beside.SetHard({x, -4});
  EXPECT_EQ(judge(beside, 0).status, Status::kCollision);
  const PathCheckResult passed = judge(beside, 20);
  EXPECT_EQ(passed.status, Status::kNarrowGap);
  EXPECT_NEAR(passed.smallest_clearance_m, -0.09f, 1e-4f);
  EXPECT_EQ(passed.overlap_points, 15);  // on chord 13 the rear leaves what ends at 2.6 m, and 0.1
  // The rear has left it after 3.36 m, 14 chords.
  EXPECT_EQ(judge(beside, 14).status, Status::kNarrowGap);
  // Behind those chords nothing may lie across, whether it begins there or before.
  EXPECT_EQ(judge(beside, 1).status, Status::kCollision);
  EXPECT_EQ(judge(beside, 8).status, Status::kCollision);
  // A vehicle 1.5 m wide, 0.05 m beside a wall whose face is a cell's border: cells reach in by
  // 0.15 m and what the lidar's noise adds, and there is no other way on.
  const VehicleParams wide = VehicleOfSize(1.52f, 1.5f);
  const auto judge_wide = [&](float y_m) {
    return Check(beside, StraightPath({0.0f, y_m, 0.0f}, 21, 0.25f), wide, 0.0f, {}, 0.1f, 20)
        .status;
  };
  EXPECT_EQ(judge_wide(0.0f), Status::kNarrowGap);
  EXPECT_EQ(judge_wide(-0.02f), Status::kNarrowGap);
  EXPECT_EQ(judge_wide(-0.04f), Status::kCollision);
  // Further into the way than kAcross_m, or in its middle.
  Ground deeper;
  deeper.SetHard({10, -3});
  EXPECT_EQ(judge(deeper, 20).status, Status::kCollision);
  Ground ahead;
  ahead.SetHard({10, 0});
  EXPECT_EQ(judge(ahead, 20).status, Status::kCollision);
}

// SR-GEO03: the rear swings out behind an axle far ahead: 3 m long, the axle 1 m ahead of its
// middle. Turning on the spot by 30 degrees the rear's right corner moves 1.3 m to the right.
TEST(PathCheck, SweepsTheRearOverhang) {
  Ground ground;
  ground.SetHard({-10, -7});  // x -2.0 .. -1.8, y -1.4 .. -1.2
  const VehicleParams vehicle = VehicleOfSize(3.0f, 1.0f, 1.0f);
  EXPECT_EQ(Check(ground, StraightPath({0.0f, 0.0f, 0.0f}, 9, 0.25f), vehicle).status, Status::kOk);
  EXPECT_EQ(Check(ground, PathOf({{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.52f}}), vehicle).status,
            Status::kCollision);
  EXPECT_EQ(Check(ground, PathOf({{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, -0.52f}}), vehicle).status,
            Status::kOk);
  // The same vehicle about its middle reaches no cell so far off.
  EXPECT_EQ(
      Check(ground, PathOf({{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.52f}}), VehicleOfSize(3.0f, 1.0f))
          .status,
      Status::kOk);
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
  const float length_m = 0.3f + 3.0f * unit(random);
  scene.vehicle =
      VehicleOfSize(length_m, 0.3f + 1.7f * unit(random), length_m * (unit(random) - 0.5f));
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

// SR-PLN01
TEST(PathCheck, AgreesWithASlowCheckOverEveryHardCell) {
  int collisions = 0;
  int clear = 0;
  for (uint32_t seed = 0; seed < Rounds(600u, 100u); ++seed) {
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
    const double expected = std::min(fine.clearance_m, reach);
    const double judged = double{result.smallest_clearance_m};
    // Never more than there is, and less by no more than half of what a sample's turn moves.
    EXPECT_LE(judged, expected + 0.003) << "seed " << seed;
    if (!result.start_overlaps) {
      EXPECT_GE(judged, expected - 0.028) << "seed " << seed;
    }
    if (result.overlap_points == 0) {
      EXPECT_GE(result.smallest_hard_distance_m, std::min(fine.hard_distance_m, reach) - 0.003)
          << "seed " << seed;
      EXPECT_LE(result.smallest_hard_distance_m, std::min(fine.hard_distance_m, reach) + 0.051)
          << "seed " << seed;
    }
    const bool collides = result.status == Status::kCollision || result.overlap_points > 0;
    EXPECT_EQ(collides, result.smallest_clearance_m <= 0.0f) << "seed " << seed;
    collisions += collides ? 1 : 0;
    clear += collides ? 0 : 1;
  }
  EXPECT_GT(collisions, Rounds(50, 8));
  EXPECT_GT(clear, Rounds(50, 8));
}

TEST(PathCheck, GivesTheSameResultInAnyPortions) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    const Scene scene = RandomScene(seed);
    const PathCheckResult whole = Check(scene.ground, scene.path, scene.vehicle);
    PathCheck check;
    ASSERT_EQ(check.Begin(scene.vehicle, {}, scene.path, 0.0f, 0.0f), Status::kOk);
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
