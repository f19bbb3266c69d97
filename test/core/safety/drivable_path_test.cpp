// SPDX-License-Identifier: Apache-2.0
// What the check of a path says of one that a vehicle with steered wheels cannot drive.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/costmap/costmap.h"
#include "core/kinematics/kinematics.h"
#include "core/safety/path_check.h"

namespace hardpack {
namespace {

// Least turning radius 3.1 m.
VehicleParams Ackermann() {
  VehicleParams vehicle;
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.wheelbase_m = 1.5f;
  vehicle.max_steering_rad = 0.45f;
  return vehicle;
}

WorldPath Arc(float curvature_per_m, float step_m, int points) {
  WorldPath path;
  Pose2 pose;
  for (int k = 0; k < points; ++k) {
    EXPECT_EQ(path.PushBack(pose), Status::kOk);
    pose = PlanarModel::Forward(pose, {curvature_per_m * step_m, step_m});
  }
  return path;
}

Status StatusOf(const WorldPath& path, const VehicleParams& vehicle) {
  static const std::unique_ptr<Costmap> map = [] {
    auto made = std::make_unique<Costmap>();
    made->window = {{-256, -256}};
    for (auto& distance2 : made->hard_distance2) distance2 = 255;
    return made;
  }();
  OptimizerParams limits;
  limits.max_curvature_per_m = 2.0f;
  limits.max_curvature_rate_per_m2 = 20.0f;
  PathCheck check;
  EXPECT_EQ(check.Begin(vehicle, limits, path, 0.0f, 0.0f), Status::kOk);
  EXPECT_EQ(check.Step(*map, path, PathCheck::kMaxUnits), Progress::kDone);
  return check.result().status;
}

// SR-PLN05
TEST(DrivablePath, BendsNoMoreThanTheWheelsAreSteered) {
  const float most_per_m = MostCurvature(Ackermann());
  for (const float side : {1.0f, -1.0f}) {
    EXPECT_EQ(StatusOf(Arc(side * most_per_m, 0.275f, 60), Ackermann()), Status::kOk);
    EXPECT_EQ(StatusOf(Arc(side * 1.03f * most_per_m, 0.275f, 60), Ackermann()),
              Status::kNeedsManoeuvre);
    EXPECT_EQ(StatusOf(Arc(side * 1.03f * most_per_m, 0.275f, 60), {}), Status::kOk);
  }
}

// SR-PLN05
TEST(DrivablePath, OneSharpBendAnywhereIsEnough) {
  for (int at = 1; at < 19; ++at) {
    WorldPath path = Arc(0.0f, 0.3f, 20);
    for (int k = at; k < path.size(); ++k) {
      path[k].theta_rad = 0.2f;
      if (k == at) continue;
      path[k].x_m = path[k - 1].x_m + 0.3f * std::cos(0.2f);
      path[k].y_m = path[k - 1].y_m + 0.3f * std::sin(0.2f);
    }
    EXPECT_EQ(StatusOf(path, Ackermann()), Status::kNeedsManoeuvre) << at;
    EXPECT_EQ(StatusOf(path, {}), Status::kOk) << at;
  }
}

// SR-PLN06
TEST(DrivablePath, HasNoTurnOnTheSpot) {
  for (const int at : {0, 7, 18}) {
    WorldPath path = Arc(0.0f, 0.3f, 19);
    WorldPath turned;
    for (int k = 0; k < path.size(); ++k) {
      EXPECT_EQ(turned.PushBack(path[k]), Status::kOk);
      if (k != at) continue;
      EXPECT_EQ(turned.PushBack({path[k].x_m, path[k].y_m, 0.01f}), Status::kOk);
    }
    EXPECT_EQ(StatusOf(turned, Ackermann()), Status::kNeedsManoeuvre) << at;
    EXPECT_EQ(StatusOf(turned, {}), Status::kOk) << at;
  }
}

}  // namespace
}  // namespace hardpack
