// SPDX-License-Identifier: Apache-2.0
// What changes while the lidar looks: people, rain, the vehicle's own motion and its odometry.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "test/core/autonomy/perception_scene.h"

namespace hardpack::perception {
namespace {

constexpr uint8_t kHardOrSoft = Costmap::kHard | Costmap::kSoft;

Area Around(double x, double y, double reach) {
  return {x - reach, y - reach, x + reach, y + reach};
}

//              ^ 1.5 m/s, from 4 m on the right to 4 m on the left and on
//   [====]     P
//              . 6.1 m
class PersonWalking : public ::testing::TestWithParam<bool> {};

// SR-PER10
TEST_P(PersonWalking, LeavesNoTrail) {
  const bool with_labels = GetParam();
  constexpr double kX = 6.1;
  constexpr double kFrom_y = -4.0;
  constexpr double kSpeed_mps = 1.5;
  constexpr Area kWay = {5.0, -6.0, 7.5, 4.0};
  Chain chain(with_labels, Sector{40.0});
  chain.world.bodies = {Person(kX, kFrom_y, {0.0, kSpeed_mps, 0.0})};
  for (double now = 0.6; now < 5.0; now += 0.57) {
    chain.RunUntil(now);
    chain.Build();
    // 0.1 s of labels, and the way of half a revolution.
    const double y = kFrom_y + kSpeed_mps * (now - 0.1);
    const Area here = Around(kX, y, 0.4);
    EXPECT_GT(chain.Count(here, with_labels ? Costmap::kPerson : Costmap::kHard), 0)
        << "at " << now << " s" << chain.Picture(kWay);
    const Area trail = {kWay.low_x, kWay.low_y, kWay.high_x, y - 1.2};
    EXPECT_EQ(chain.Count(trail, kHardOrSoft | Costmap::kPerson), 0)
        << "at " << now << " s" << chain.Picture(kWay);
  }
  chain.RunUntil(7.5);
  chain.Build();
  EXPECT_EQ(chain.Count(kWay, kHardOrSoft | Costmap::kPerson), 0) << chain.Picture(kWay);
}

INSTANTIATE_TEST_SUITE_P(PerceptionScenes, PersonWalking, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "WithLabels" : "ByGeometry"; });

// Drops that end one beam in a hundred:
//
//   [====]   .    .  '   .   .
//     .   '   .  .     .
// SR-PER07
TEST(PerceptionScenes, RainDoesNotBecomeWalls) {
  constexpr Area kOpen = {1.0, -12.0, 18.0, 12.0};
  constexpr int kHandful_cells = 8;
  Chain chain(false, Sector{45.0});
  chain.world.rain_share = 0.01;
  std::vector<int> age(kMapCells, 0);  // builds in a row in which the cell was hard
  int oldest = 0;
  for (int build = 0; build < 10; ++build) {
    chain.RunUntil(0.3 * (build + 1));
    const Costmap& map = chain.Build();
    EXPECT_LE(chain.Count(kOpen, Costmap::kHard), kHandful_cells) << chain.Picture(kOpen);
    kOpen.ForEach([&](Cell cell) {
      int& builds = age[static_cast<size_t>(map.window.Index(cell))];
      builds = chain.Has(cell, Costmap::kHard) ? builds + 1 : 0;
      oldest = std::max(oldest, builds);
    });
  }
  EXPECT_LE(oldest, 3);  // for a second
}

// With labels that say what it is, rain is nothing at all once it is folded.
TEST(PerceptionScenes, RainThatIsLabelledVoidIsNotFiled) {
  constexpr Area kOpen = {1.0, -12.0, 18.0, 12.0};
  Chain chain(true, Sector{45.0});
  chain.world.rain_share = 0.01;
  chain.label_delay_s = 0.05;
  chain.RunUntil(1.0);
  chain.world.rain_share = 0.0;
  chain.RunUntil(1.2);
  chain.Build();
  EXPECT_EQ(chain.Count(kOpen, kHardOrSoft), 0) << chain.Picture(kOpen);
}

// While the vehicle drives past a box, its odometry's height goes up by half a metre and later down
// again.
class HeightJump : public ::testing::TestWithParam<bool> {};

TEST_P(HeightJump, DoesNotTurnGroundIntoObstacles) {
  const bool with_labels = GetParam();
  constexpr Area kBox = {9.0, 2.0, 9.8, 2.8};
  constexpr Area kOpen = {-3.0, -6.0, 20.0, 6.0};
  Chain chain(with_labels, Sector{60.0});
  chain.world.bodies = {Box({9.05, 2.05, 0.0}, {9.75, 2.75, 1.0})};
  chain.truth = [](double t) { return Pose{2.0 * t, 0.0, 0.0, 0.0, 0.0, 0.0}; };
  chain.odometry = [&](double t) {
    Pose pose = chain.truth(t);
    pose.z = t >= 1.0 && t < 2.0 ? 0.5 : 0.0;
    return pose;
  };
  for (const double now : {0.9, 1.0, 1.05, 1.2, 1.5, 1.99, 2.03, 2.2, 3.0}) {
    chain.RunUntil(now);
    chain.Build();
    const int on_box = chain.Count(kBox, Costmap::kHard);
    EXPECT_GE(on_box, 3) << "at " << now << " s" << chain.Picture(kBox);
    // Noise may put a return of the box beside it.
    const int near_box = chain.Count({8.8, 1.8, 10.0, 3.0}, kHardOrSoft);
    EXPECT_EQ(chain.Count(kOpen, kHardOrSoft), near_box)
        << "at " << now << " s" << chain.Picture(kOpen);
  }
  EXPECT_EQ(chain.mapper().counters().height_jumps, 2u);
  EXPECT_EQ(chain.mapper().counters().position_jumps, 0u);
}

INSTANTIATE_TEST_SUITE_P(PerceptionScenes, HeightJump, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "WithLabels" : "ByGeometry"; });

// SR-ODO01
TEST(PerceptionScenes, PositionJumpEmptiesTheMap) {
  Chain chain(false, Sector{30.0});
  chain.world.bodies = {Box({7.05, -0.35, 0.0}, {7.75, 0.35, 1.0})};
  chain.poses_may_lack = true;
  double jump_m = 0.0;
  chain.odometry = [&](double) { return Pose{jump_m, 0.0, 0.0, 0.0, 0.0, 0.0}; };
  chain.RunUntil(1.0);
  chain.Build();
  EXPECT_GT(chain.Count({-30.0, -30.0, 30.0, 30.0}, Costmap::kHard), 0);
  jump_m = 4.0;
  chain.RunUntil(1.01);
  chain.Build();
  EXPECT_EQ(chain.mapper().counters().position_jumps, 1u);
  EXPECT_EQ(chain.Count({-30.0, -30.0, 30.0, 30.0}, kHardOrSoft), 0);
  EXPECT_EQ(chain.Count({5.0, -3.0, 9.0, 3.0}, Costmap::kObserved), 0);
  // And there it is again, where the new odometry has it.
  chain.RunUntil(1.7);
  chain.Build();
  EXPECT_GT(chain.Count({11.0, -0.4, 11.2, 0.4}, Costmap::kHard), 0);
  EXPECT_EQ(chain.Count({-30.0, -30.0, 10.7, 30.0}, kHardOrSoft), 0);
}

// Driving at 5 m/s in a circle of 2.5 m, poles all around it at 8 m:
//
//          |                    |
//                 .-''-.
//                :  <-= :  5 m/s, 2 rad/s: 11 degrees a revolution
//                 '-..-'
//          |                    |
constexpr double kPoles_m = 8.0;
constexpr double kPole_radius_m = 0.1;
constexpr int kPoles = 8;

Point PoleAt(int index) {
  const double angle = 2.0 * kPi_rad * (index + 0.3) / kPoles;
  return {kPoles_m * std::cos(angle), kPoles_m * std::sin(angle), 0.0};
}

struct Sharpness {
  int found = 0;    // poles with a hard cell
  int outside = 0;  // hard cells more than a cell beside those of a pole
};

Sharpness DriveInCircle(bool one_pose_a_revolution) {
  Chain chain(false, Sector{});
  for (int i = 0; i < kPoles; ++i) {
    const Point at = PoleAt(i);
    chain.world.bodies.push_back(Cylinder(at.x, at.y, kPole_radius_m, 2.0, kTreeCode));
  }
  chain.truth = [](double t) {
    const double turned = 2.0 * t;
    return Pose{2.5 * std::sin(turned), -2.5 * std::cos(turned), 0.0, 0.0, 0.0, turned};
  };
  if (one_pose_a_revolution) {
    chain.odometry = [&](double t) {
      return chain.truth(kRevolution_s * std::floor(t / kRevolution_s + 1e-6));
    };
  }
  chain.RunUntil(0.6);
  chain.Build();
  Sharpness sharpness;
  for (int i = 0; i < kPoles; ++i) {
    const Point at = PoleAt(i);
    sharpness.found += chain.Count(Around(at.x, at.y, 0.3), Costmap::kHard) > 0 ? 1 : 0;
  }
  Around(0.0, 0.0, 14.0).ForEach([&](Cell cell) {
    if (!chain.Has(cell, Costmap::kHard)) return;
    bool beside = false;
    for (int i = 0; i < kPoles; ++i) {
      const Point at = PoleAt(i);
      const double low_x = 0.2 * (cell.x - 1), high_x = 0.2 * (cell.x + 2);
      const double low_y = 0.2 * (cell.y - 1), high_y = 0.2 * (cell.y + 2);
      const double dx = at.x - std::clamp(at.x, low_x, high_x);
      const double dy = at.y - std::clamp(at.y, low_y, high_y);
      beside = beside || std::hypot(dx, dy) <= kPole_radius_m;
    }
    sharpness.outside += beside ? 0 : 1;
  });
  return sharpness;
}

TEST(PerceptionScenes, PolesStaySharpWhileTheVehicleTurns) {
  const Sharpness sharp = DriveInCircle(false);
  EXPECT_EQ(sharp.found, kPoles);
  EXPECT_EQ(sharp.outside, 0);
  // The scene can tell: with one pose for a whole revolution they are smeared.
  const Sharpness smeared = DriveInCircle(true);
  EXPECT_GT(smeared.outside, kPoles);
}

// From afar the rings lie further apart than a ditch is wide, and it is bridged; from near it is
// not.
//
//   [==] ->        ______   ______
//                        |_|   1 m wide, 1 m deep
// SR-PER09
TEST(PerceptionScenes, DitchThatIsDrivenAtBecomesUnknown) {
  for (const double width_m : {1.0, 1.5, 2.0}) {
    SCOPED_TRACE(width_m);
    World world;
    world.ground = Ground({{-1000.0, 0.0},
                           {20.0, 0.0},
                           {20.0, -1.0},
                           {20.0 + width_m, -1.0},
                           {20.0 + width_m, 0.0},
                           {1000.0, 0.0}},
                          0.0);
    Chain chain(false, Sector{12.0});
    chain.world = world;
    chain.truth = [](double t) {
      Pose pose;
      pose.x = std::min(3.0 * t, 14.0);
      return pose;
    };
    chain.RunUntil(5.5);
    chain.Build();
    const Area ditch = {20.0, -0.6, 20.0 + width_m, 0.6};
    const int unknown = Chain::Cells(ditch) - chain.Count(ditch, Costmap::kObserved);
    EXPECT_GE(unknown, 0.5 * Chain::Cells(ditch)) << chain.Picture({18.0, -0.6, 24.0, 0.6});
    EXPECT_GE(chain.Count({15.0, -0.6, 19.8, 0.6}, Costmap::kObserved), 0.95 * 24 * 6);
  }
}

// Where the vehicle starts on a slope, a person uphill is above what is assumed of the ground.
//
//                 o
//             ___/|
//   [==]_____/
TEST(PerceptionScenes, PersonUphillOfTheStartIsHard) {
  for (const double distance_m : {4.5, 5.0, 6.0}) {
    SCOPED_TRACE(distance_m);
    World world;
    const double steep = std::tan(25.0 * kDegree_rad);
    world.ground = Ground({{-1000.0, 0.0}, {1.0, 0.0}, {1000.0, 999.0 * steep}}, 0.0);
    const double feet_m = (distance_m - 1.0) * steep;
    world.bodies = {Cylinder(distance_m, 0.0, 0.25, feet_m + 1.8, kPersonCode)};
    Chain chain(false, Sector{20.0});
    chain.world = world;
    chain.truth = [](double) { return Pose{}; };
    chain.RunUntil(1.0);
    chain.Build();
    const Area person = {distance_m - 0.4, -0.4, distance_m + 0.4, 0.4};
    EXPECT_GE(chain.Count(person, Costmap::kHard), 2) << chain.Picture({3.0, -1.0, 8.0, 1.0});
  }
}

}  // namespace
}  // namespace hardpack::perception
