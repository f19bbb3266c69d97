// SPDX-License-Identifier: Apache-2.0
#include "core/path/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "core/base/footprint.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// A second vehicle model: its wheels slip, so it comes only nine tenths of the way it drives.
struct SlippingModel {
  static Pose2 Forward(const Pose2& from, const ActuatorStep& step) {
    return PlanarModel::Forward(from, {step.phi_rad, 0.9f * step.dr_m});
  }
  static ActuatorStep Inverse(const Pose2& from, const Pose2& to) {
    const ActuatorStep step = PlanarModel::Inverse(from, to);
    return {step.phi_rad, step.dr_m / 0.9f};
  }
};

ActuatorPath RandomSteps(unsigned seed, int steps, float start_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  ActuatorPath path;
  path.start = {start_m * unit(random), start_m * unit(random), 3.0f * unit(random)};
  for (int i = 0; i < steps; ++i) {
    const unsigned kind = static_cast<unsigned>(random() % 8);
    ActuatorStep step = {0.3f * unit(random), 0.25f + 0.05f * unit(random)};
    if (kind == 0) step = {3.1f * unit(random), 0.0f};  // a pivot
    if (kind == 1) step.dr_m = -step.dr_m;              // reverse
    EXPECT_EQ(path.steps.PushBack(step), Status::kOk);
  }
  return path;
}

TEST(Path, ReturnsToTheSameStepsThroughTheWorld) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    const ActuatorPath there = RandomSteps(seed, 255, 50.0f);
    WorldPath world;
    ActuatorPath back;
    ASSERT_EQ(ToWorld<PlanarModel>(there, world), Status::kOk);
    ASSERT_EQ(ToActuator<PlanarModel>(world, back), Status::kOk);
    ASSERT_EQ(back.steps.size(), 255);
    EXPECT_EQ(back.start.x_m, there.start.x_m);
    for (int i = 0; i < 255; ++i) {
      // Positions within 128 m are rounded to 7.6e-6 m.
      EXPECT_NEAR(back.steps[i].dr_m, there.steps[i].dr_m, 2e-5f) << i;
      EXPECT_NEAR(WrapAngle(back.steps[i].phi_rad - there.steps[i].phi_rad), 0.0f, 2e-6f) << i;
      if (there.steps[i].dr_m == 0.0f) {
        EXPECT_EQ(back.steps[i].dr_m, 0.0f) << i;
      }
    }
  }
}

TEST(Path, ReturnsToTheSamePosesThroughTheSteps) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    WorldPath there;
    WorldPath back;
    ActuatorPath steps;
    ASSERT_EQ(ToWorld<PlanarModel>(RandomSteps(seed, 255, 20.0f), there), Status::kOk);
    ASSERT_EQ(ToActuator<PlanarModel>(there, steps), Status::kOk);
    ASSERT_EQ(ToWorld<PlanarModel>(steps, back), Status::kOk);
    ASSERT_EQ(back.size(), there.size());
    for (int i = 0; i < there.size(); ++i) {
      // One rounding of a position (4e-6 m) and of a heading (2e-7 rad) a step, added up.
      EXPECT_NEAR(back[i].x_m, there[i].x_m, 5e-4f) << i;
      EXPECT_NEAR(back[i].y_m, there[i].y_m, 5e-4f) << i;
      EXPECT_NEAR(WrapAngle(back[i].theta_rad - there[i].theta_rad), 0.0f, 5e-5f) << i;
    }
  }
}

TEST(Path, DrivesThenTurns) {
  //  3 <- 2   forward and a left turn, forward and a right turn, then in reverse
  //       ^
  //  0 -> 1
  ActuatorPath path;
  path.start = {1.0f, 2.0f, 0.0f};
  ASSERT_EQ(path.steps.PushBack({kHalfPi, 2.0f}), Status::kOk);
  ASSERT_EQ(path.steps.PushBack({-kHalfPi, 2.0f}), Status::kOk);
  ASSERT_EQ(path.steps.PushBack({0.0f, -2.0f}), Status::kOk);
  WorldPath world;
  ASSERT_EQ(ToWorld<PlanarModel>(path, world), Status::kOk);
  ASSERT_EQ(world.size(), 4);
  EXPECT_NEAR(world[1].x_m, 3.0f, 1e-6f);
  EXPECT_NEAR(world[1].y_m, 2.0f, 1e-6f);
  EXPECT_NEAR(world[1].theta_rad, kHalfPi, 1e-6f);
  EXPECT_NEAR(world[2].y_m, 4.0f, 1e-6f);
  EXPECT_NEAR(world[2].theta_rad, 0.0f, 1e-6f);
  EXPECT_NEAR(world[3].x_m, 1.0f, 1e-6f);
  ActuatorPath back;
  ASSERT_EQ(ToActuator<PlanarModel>(world, back), Status::kOk);
  EXPECT_LT(back.steps[2].dr_m, 0.0f);
}

TEST(Path, TakesAnotherVehicleModel) {
  ActuatorPath there = RandomSteps(7, 40, 1.0f);
  WorldPath world;
  WorldPath planar;
  ActuatorPath back;
  ASSERT_EQ(ToWorld<SlippingModel>(there, world), Status::kOk);
  ASSERT_EQ(ToWorld<PlanarModel>(there, planar), Status::kOk);
  ASSERT_EQ(ToActuator<SlippingModel>(world, back), Status::kOk);
  EXPECT_NEAR(LengthOf(world), 0.9f * LengthOf(planar), 1e-4f);
  for (int i = 0; i < 40; ++i) EXPECT_NEAR(back.steps[i].dr_m, there.steps[i].dr_m, 1e-5f);
}

TEST(Path, TurnsTheWayBehindAPointAsIntegrationDoes) {
  const ActuatorPath steps = RandomSteps(11, 30, 5.0f);
  ActuatorPath turned = steps;
  constexpr float kTurn_rad = 0.3f;
  turned.steps[4].phi_rad += kTurn_rad;
  WorldPath before;
  WorldPath after;
  ASSERT_EQ(ToWorld<PlanarModel>(steps, before), Status::kOk);
  ASSERT_EQ(ToWorld<PlanarModel>(turned, after), Status::kOk);
  const Pose2 pivot = before[5];
  for (int i = 5; i < before.size(); ++i) {
    const Vec2 arm = PlanarModel::Turned({before[i].x_m - pivot.x_m, before[i].y_m - pivot.y_m},
                                         SinCos(kTurn_rad));
    EXPECT_NEAR(pivot.x_m + arm.x_m, after[i].x_m, 2e-5f) << i;
    EXPECT_NEAR(pivot.y_m + arm.y_m, after[i].y_m, 2e-5f) << i;
  }
}

TEST(Path, RefusesWhatIsTooShortOrNotFinite) {
  WorldPath world;
  ActuatorPath actuator;
  EXPECT_EQ(ToWorld<PlanarModel>(actuator, world), Status::kPathTooShort);
  world.Resize(1);
  EXPECT_EQ(ToActuator<PlanarModel>(world, actuator), Status::kPathTooShort);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int field = 0; field < 3; ++field) {
      WorldPath path;
      path.Resize(5);
      float* const fields[] = {&path[3].x_m, &path[3].y_m, &path[3].theta_rad};
      *fields[field] = bad;
      EXPECT_EQ(ToActuator<PlanarModel>(path, actuator), Status::kNotFinite);
      EXPECT_TRUE(actuator.steps.empty());
    }
    ActuatorPath steps = RandomSteps(1, 5, 1.0f);
    steps.steps[2].dr_m = bad;
    EXPECT_EQ(ToWorld<PlanarModel>(steps, world), Status::kNotFinite);
    EXPECT_TRUE(world.empty());
    steps = RandomSteps(1, 5, 1.0f);
    steps.steps[2].phi_rad = bad;
    EXPECT_EQ(ToWorld<PlanarModel>(steps, world), Status::kNotFinite);
  }
}

TEST(Path, RefusesFiniteNumbersThatOverflow) {
  WorldPath world;
  ActuatorPath actuator;
  world.Resize(2);
  world[0].x_m = -3e38f;
  world[1].x_m = 3e38f;
  EXPECT_EQ(ToActuator<PlanarModel>(world, actuator), Status::kNotFinite);
  actuator.start = {3e38f, 0.0f, 0.0f};
  ASSERT_EQ(actuator.steps.PushBack({0.0f, 3e38f}), Status::kOk);
  EXPECT_EQ(ToWorld<PlanarModel>(actuator, world), Status::kNotFinite);
}

TEST(Path, TakesHeadingsFromChords) {
  //      2 = 3
  //      |
  //  0 - 1
  WorldPath path;
  path.Resize(5);
  path[1] = {1.0f, 0.0f, 9.0f};
  path[2] = {1.0f, 1.0f, 9.0f};
  path[3] = {1.0f, 1.0f, 9.0f};
  path[4] = {0.0f, 1.0f, 9.0f};
  SetHeadingsFromChords(path);
  EXPECT_EQ(path[0].theta_rad, 0.0f);
  EXPECT_NEAR(path[1].theta_rad, kHalfPi, 1e-6f);
  EXPECT_EQ(path[2].theta_rad, path[1].theta_rad);  // a chord of no length: the one before it
  EXPECT_NEAR(path[3].theta_rad, kPi, 1e-6f);
  EXPECT_EQ(path[4].theta_rad, path[3].theta_rad);  // the last repeated
  EXPECT_NEAR(LengthOf(path), 3.0f, 1e-6f);
}

TEST(Path, KeepsTheFirstHeadingWhereNothingMoves) {
  WorldPath path;
  SetHeadingsFromChords(path);
  path.Resize(3);
  path[0].theta_rad = 0.7f;
  SetHeadingsFromChords(path);
  EXPECT_EQ(path[2].theta_rad, 0.7f);
  EXPECT_EQ(LengthOf(path), 0.0f);
}

TEST(Path, LooksOneMetreAheadForTheBaseHeading) {
  //        . . .     the first chord points elsewhere
  //   0 .
  WorldPath path;
  path.Resize(10);
  for (int i = 0; i < 10; ++i) {
    path[i] = {0.275f * static_cast<float>(i), i == 0 ? 0.0f : 0.2f, 0.0f};
  }
  EXPECT_NEAR(BaseHeading(path), std::atan2(0.2f, 0.275f * 4.0f), 1e-5f);
  path.Resize(2);
  EXPECT_NEAR(BaseHeading(path), std::atan2(0.2f, 0.275f), 1e-5f);
  path.Resize(1);
  EXPECT_EQ(BaseHeading(path), 0.0f);
}

class Pivot : public ::testing::Test {
 protected:
  Pivot() { map_->window = GridWindow::CenteredAt({0.0f, 0.0f}); }

  void Set(Cell cell, uint8_t flag) { map_->flags[map_->window.Index(cell)] = flag; }
  bool FreeAt(Vec2 position) const { return PivotIsFree(*map_, vehicle_, params_, position); }

  std::unique_ptr<Costmap> map_ = std::make_unique<Costmap>();
  VehicleParams vehicle_;
  PathParams params_;
};

TEST_F(Pivot, AgreesWithADenseSampleOfTheCircle) {
  const float radius_m = PivotRadiusOf(vehicle_) + params_.pivot_margin_m;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  int blocked = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Cell cell = {static_cast<int>(8.0f * unit(random)),
                       static_cast<int>(8.0f * unit(random))};
    const Vec2 at = {0.3f * unit(random), 0.3f * unit(random)};
    const double low_x = cell.x * 0.2;
    const double low_y = cell.y * 0.2;
    const double dx = std::max({low_x - at.x_m, at.x_m - low_x - 0.2, 0.0});
    const double dy = std::max({low_y - at.y_m, at.y_m - low_y - 0.2, 0.0});
    const double distance_m = std::hypot(dx, dy);
    if (std::abs(distance_m - radius_m) < 1e-4) continue;
    Set(cell, trial % 2 == 0 ? Costmap::kHard : Costmap::kPerson);
    EXPECT_EQ(FreeAt(at), distance_m > radius_m) << trial;
    blocked += distance_m > radius_m ? 0 : 1;
    Set(cell, 0);
  }
  EXPECT_GT(blocked, 200);
}

TEST_F(Pivot, IsFreeOfEverythingButHardCells) {
  for (uint8_t& flags : map_->flags) flags = Costmap::kSoft | Costmap::kObserved | Costmap::kLethal;
  EXPECT_TRUE(FreeAt({0.0f, 0.0f}));
}

TEST_F(Pivot, IsNotFreeAtTheMapsEdgeNorAnywhereWithoutNumbers) {
  EXPECT_FALSE(FreeAt({50.5f, 0.0f}));
  EXPECT_FALSE(FreeAt({1e9f, 0.0f}));
  EXPECT_FALSE(FreeAt({kNaN, 0.0f}));
  EXPECT_FALSE(FreeAt({0.0f, kInfinity}));
  params_.pivot_margin_m = kNaN;
  EXPECT_FALSE(FreeAt({0.0f, 0.0f}));
  params_.pivot_margin_m = 10.0f;
  EXPECT_FALSE(FreeAt({0.0f, 0.0f}));
}

}  // namespace
}  // namespace hardpack
