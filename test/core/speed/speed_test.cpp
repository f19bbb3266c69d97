// SPDX-License-Identifier: Apache-2.0
#include "core/speed/speed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

ActuatorPath Straight(int steps, float dr_m) {
  ActuatorPath path;
  for (int i = 0; i < steps; ++i) EXPECT_EQ(path.steps.PushBack({0.0f, dr_m}), Status::kOk);
  return path;
}

Status Plan(const ActuatorPath& path, const SpeedRequest& request, SpeedProfile& speed,
            const SpeedParams& params = {}) {
  return PlanSpeed(params, VehicleParams{}, path, request, speed);
}

// The limits of docs/algorithm.md section 6 once more, in double and from their own formulas.
double ShapeLimit(const SpeedParams& p, const VehicleParams& v, double kappa, double rate) {
  kappa = std::abs(kappa);
  rate = std::abs(rate);
  double limit = double{p.min_speed_mps} + (double{p.max_speed_mps} - double{p.min_speed_mps}) *
                                               (1.0 - std::min(kappa / double{p.gamma_per_m}, 1.0));
  if (kappa > 0.0) {
    limit = std::min(limit, std::sqrt(double{p.max_lateral_acceleration_mps2} / kappa));
    limit = std::min(limit, double{p.max_yaw_rate_radps} / kappa);
  }
  limit = std::min(limit, double{p.max_wheel_speed_share} * double{v.max_wheel_speed_radps} *
                              double{v.wheel_radius_m} /
                              (1.0 + kappa * double{v.skid_baseline_m} / 2.0));
  if (rate > 0.0) limit = std::min(limit, std::sqrt(double{p.max_curvature_rate_per_s2} / rate));
  return limit;
}

TEST(CurvatureSpeedLimit, IsMaximalOnAStraightAndMinimalAtGamma) {
  const SpeedParams params;
  const VehicleParams vehicle;
  // 0.9 * 17.5 rad/s * 0.3 m = 4.725 m/s: the wheels allow less than max_speed_mps.
  EXPECT_NEAR(CurvatureSpeedLimit(params, vehicle, 0.0f, 0.0f), 4.725f, 1e-5f);
  EXPECT_NEAR(CurvatureSpeedLimit(params, vehicle, 0.5f, 0.0f), 2.0f, 1e-5f);
}

TEST(CurvatureSpeedLimit, AgreesWithTheFormulasInDouble) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> exponent(-5.0f, 3.0f);
  const VehicleParams vehicle;
  for (int i = 0; i < 20000; ++i) {
    SpeedParams params;
    params.max_lateral_acceleration_mps2 = 0.5f + static_cast<float>(i % 7);
    params.max_yaw_rate_radps = 0.5f + static_cast<float>(i % 5);
    const float kappa = (i % 2 == 0 ? 1.0f : -1.0f) * std::pow(10.0f, exponent(random));
    const float rate = (i % 3 == 0 ? 1.0f : -1.0f) * std::pow(10.0f, exponent(random));
    const double expected = ShapeLimit(params, vehicle, double{kappa}, double{rate});
    EXPECT_NEAR(CurvatureSpeedLimit(params, vehicle, kappa, rate), expected, 1e-6 * expected)
        << kappa << " 1/m, " << rate << " 1/m^2";
  }
}

TEST(SpeedPlanner, StopsAtGoal) {
  SpeedProfile speed;
  SpeedRequest request;
  request.start_speed_mps = 1.5f;
  ASSERT_EQ(Plan(Straight(80, 0.25f), request, speed), Status::kOk);
  ASSERT_EQ(speed.size(), 81);
  EXPECT_EQ(speed[0], 1.5f);
  EXPECT_EQ(speed.back(), 0.0f);
  EXPECT_GT(*std::max_element(speed.begin(), speed.end()), 4.0f);
}

TEST(SpeedPlanner, PassesAWaypointAtItsSpeed) {
  SpeedProfile speed;
  SpeedRequest request;
  request.start_speed_mps = 3.0f;
  request.goal_speed_mps = 2.5f;
  ASSERT_EQ(Plan(Straight(40, 0.25f), request, speed), Status::kOk);
  EXPECT_EQ(speed.back(), 2.5f);
}

//  start 5 m/s -> a bend that allows 2: brakes at once, at the limit, into the bend if it must
TEST(SpeedPlanner, BrakesAtTheLimitFromTooHighAStartSpeed) {
  const SpeedParams params;
  ActuatorPath path = Straight(60, 0.25f);
  for (int i = 3; i < 50; ++i) path.steps[i].phi_rad = 0.125f;  // 0.5 1/m
  SpeedProfile speed;
  SpeedRequest request;
  request.start_speed_mps = 5.0f;
  ASSERT_EQ(Plan(path, request, speed), Status::kOk);
  EXPECT_EQ(speed[0], 5.0f);
  int k = 1;
  for (; speed[k] > 2.001f; ++k) {
    const float fall = speed[k - 1] * speed[k - 1] - speed[k] * speed[k];
    EXPECT_NEAR(fall, 2.0f * params.max_deceleration_mps2 * 0.25f, 1e-4f) << k;
  }
  EXPECT_EQ(k, 21);  // (25 - 4) / (2 * 2 * 0.25)
  for (; k < 40; ++k) EXPECT_NEAR(speed[k], 2.0f, 1e-4f);
  EXPECT_EQ(speed.back(), 0.0f);
}

TEST(SpeedPlanner, ShowsTheSpeedWithWhichItOverrunsTheEnd) {
  SpeedProfile speed;
  SpeedRequest request;
  request.start_speed_mps = 5.0f;
  ASSERT_EQ(Plan(Straight(4, 0.25f), request, speed), Status::kOk);
  EXPECT_NEAR(speed.back(), std::sqrt(25.0f - 2.0f * 2.0f * 1.0f), 1e-5f);
}

//  ------>(turn)
//            |
//            v
TEST(SpeedPlanner, StandsAtBothEndsOfATurnOnTheSpot) {
  ActuatorPath path = Straight(20, 0.25f);
  path.steps[8] = {1.5f, 0.0f};
  SpeedProfile speed;
  ASSERT_EQ(Plan(path, {}, speed), Status::kOk);
  EXPECT_EQ(speed[8], 0.0f);
  EXPECT_EQ(speed[9], 0.0f);
  EXPECT_GT(speed[7], 0.0f);
  EXPECT_GT(speed[10], 0.0f);
}

TEST(SpeedPlanner, StandsAtATurnOnTheSpotEvenWhenItCannotBrakeInTime) {
  ActuatorPath path = Straight(20, 0.25f);
  path.steps[2] = {1.5f, 0.0f};
  SpeedProfile speed;
  SpeedRequest request;
  request.start_speed_mps = 5.0f;
  ASSERT_EQ(Plan(path, request, speed), Status::kOk);
  EXPECT_EQ(speed[0], 5.0f);
  EXPECT_GT(speed[1], 4.0f);
  EXPECT_EQ(speed[2], 0.0f);
  EXPECT_EQ(speed[3], 0.0f);
}

TEST(SpeedPlanner, TurnsOnTheSpotAtTheVeryStart) {
  ActuatorPath path = Straight(20, 0.25f);
  path.steps[0] = {2.5f, 0.0f};
  SpeedProfile speed;
  ASSERT_EQ(Plan(path, {}, speed), Status::kOk);
  EXPECT_EQ(speed[0], 0.0f);
  EXPECT_EQ(speed[1], 0.0f);
  EXPECT_GT(speed[2], 0.0f);
}

TEST(SpeedPlanner, StandsWhereTheDirectionChanges) {
  ActuatorPath path = Straight(20, 0.25f);
  for (int i = 10; i < 20; ++i) path.steps[i].dr_m = -0.25f;
  SpeedProfile speed;
  ASSERT_EQ(Plan(path, {}, speed), Status::kOk);
  for (int k = 1; k < 20; ++k) EXPECT_EQ(speed[k] == 0.0f, k == 10) << k;
}

// Every pair of a long, a just long enough, a just too short and no chord, forward and in reverse.
TEST(SpeedPlanner, StandsBetweenTwoStepsThatItCannotDriveInOneGo) {
  const float too_short = std::nextafter(kLeastChord_m, 0.0f);
  for (const float before :
       {0.25f, kLeastChord_m, too_short, 0.0f, -0.0f, -too_short, -kLeastChord_m, -0.25f}) {
    for (const float after :
         {0.25f, kLeastChord_m, too_short, 0.0f, -0.0f, -too_short, -kLeastChord_m, -0.25f}) {
      ActuatorPath path = Straight(9, before);
      for (int i = 4; i < 9; ++i) path.steps[i].dr_m = after;
      SpeedProfile speed;
      SpeedRequest request;
      request.goal_speed_mps = 1.0f;
      ASSERT_EQ(Plan(path, request, speed), Status::kOk);
      const bool drives =
          HasLength(before) && HasLength(after) && (before < 0.0f) == (after < 0.0f);
      EXPECT_EQ(speed[4] > 0.0f, drives) << before << " m, then " << after << " m";
    }
  }
}

TEST(SpeedPlanner, DrivesInReverseAsFastAsForward) {
  ActuatorPath forward = Straight(60, 0.25f);
  for (int i = 10; i < 30; ++i) forward.steps[i].phi_rad = 0.05f;
  ActuatorPath reverse = forward;
  for (ActuatorStep& step : reverse.steps) step.dr_m = -step.dr_m;
  SpeedProfile a;
  SpeedProfile b;
  ASSERT_EQ(Plan(forward, {}, a), Status::kOk);
  ASSERT_EQ(Plan(reverse, {}, b), Status::kOk);
  for (int k = 0; k < a.size(); ++k) EXPECT_EQ(a[k], b[k]) << k;
}

// SR-SPD05
TEST(SpeedPlanner, IsSlowWhileLeavingAnObstacle) {
  const SpeedParams params;
  SpeedProfile speed;
  SpeedRequest request;
  request.slow_points = 12;
  ASSERT_EQ(Plan(Straight(60, 0.25f), request, speed), Status::kOk);
  for (int k = 0; k < 60; ++k) {
    EXPECT_LE(speed[k], k < 12 ? params.obstacle_start_speed_mps : params.max_speed_mps) << k;
  }
  EXPECT_EQ(speed[11], params.obstacle_start_speed_mps);
  EXPECT_GT(speed[40], params.min_speed_mps);
}

TEST(SpeedPlanner, KeepsToTheCapsAndBrakesBeforeThem) {
  std::vector<float> caps(61, 10.0f);
  caps[30] = 0.7f;
  SpeedProfile speed;
  SpeedRequest request;
  request.start_speed_mps = 3.0f;
  request.cap_mps = caps;
  ASSERT_EQ(Plan(Straight(60, 0.25f), request, speed), Status::kOk);
  EXPECT_FLOAT_EQ(speed[30], 0.7f);
  EXPECT_NEAR(speed[29], std::sqrt(0.49f + 2.0f * 2.0f * 0.25f), 1e-5f);
  EXPECT_GT(speed[20], 2.5f);
}

TEST(SpeedPlanner, RefusesBadInput) {
  SpeedProfile speed;
  const ActuatorPath good = Straight(10, 0.25f);
  EXPECT_EQ(Plan(ActuatorPath{}, {}, speed), Status::kPathTooShort);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    ActuatorPath path = good;
    path.steps[4].phi_rad = bad;
    EXPECT_EQ(Plan(path, {}, speed), Status::kNotFinite);
    path = good;
    path.steps[9].dr_m = bad;
    EXPECT_EQ(Plan(path, {}, speed), Status::kNotFinite);
    SpeedRequest request;
    request.start_speed_mps = bad;
    EXPECT_EQ(Plan(good, request, speed), Status::kNotFinite);
    request = {};
    request.start_curvature_per_m = bad;
    EXPECT_EQ(Plan(good, request, speed), Status::kNotFinite);
    request = {};
    request.goal_speed_mps = bad;
    EXPECT_EQ(Plan(good, request, speed), Status::kNotFinite);
    std::vector<float> caps(11, 1.0f);
    caps[10] = bad;
    request = {};
    request.cap_mps = caps;
    EXPECT_EQ(Plan(good, request, speed), Status::kNotFinite);
    EXPECT_TRUE(speed.empty());
  }
  SpeedRequest request;
  request.start_speed_mps = -0.1f;
  EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument);
  request = {};
  request.start_speed_mps = 101.0f;
  EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument);
  request = {};
  request.goal_speed_mps = -1.0f;
  EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument);
  request = {};
  request.slow_points = -1;
  EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument);
  for (const size_t length : {size_t{1}, size_t{10}, size_t{12}}) {
    const std::vector<float> caps(length, 1.0f);
    request = {};
    request.cap_mps = caps;
    EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument) << length;
  }
  const std::vector<float> negative(11, -1.0f);
  request.cap_mps = negative;
  EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument);
}

TEST(SpeedPlanner, SeesANumberThatIsNotFiniteWhereverItStands) {
  for (int steps = 1; steps <= 20; ++steps) {
    const ActuatorPath good = Straight(steps, 0.25f);
    SpeedProfile speed;
    for (int k = 0; k < steps; ++k) {
      ActuatorPath path = good;
      path.steps[k].phi_rad = kNaN;
      EXPECT_EQ(Plan(path, {}, speed), Status::kNotFinite) << k << " of " << steps;
      path = good;
      path.steps[k].dr_m = kInfinity;
      EXPECT_EQ(Plan(path, {}, speed), Status::kNotFinite) << k << " of " << steps;
    }
    for (size_t k = 0; k <= static_cast<size_t>(steps); ++k) {
      std::vector<float> caps(static_cast<size_t>(steps) + 1, 1.0f);
      SpeedRequest request;
      request.cap_mps = caps;
      caps[k] = -1.0f;
      EXPECT_EQ(Plan(good, request, speed), Status::kInvalidArgument) << k << " of " << steps;
      caps[k] = kNaN;
      EXPECT_EQ(Plan(good, request, speed), Status::kNotFinite) << k << " of " << steps;
    }
  }
}

TEST(SpeedPlanner, GivesFiniteSpeedsForExtremeNumbers) {
  const float most = std::numeric_limits<float>::max();
  const float least = std::numeric_limits<float>::denorm_min();
  const float values[] = {0.0f, -0.0f, least, -least, 1e-7f, 1e-6f,
                          0.3f, -0.3f, 1e10f, most,   -most};
  std::mt19937 random(4);
  std::uniform_int_distribution<size_t> pick(0, std::size(values) - 1);
  for (int i = 0; i < 5000; ++i) {
    ActuatorPath path;
    for (int k = 0; k < 12; ++k) {
      ASSERT_EQ(path.steps.PushBack({values[pick(random)], values[pick(random)]}), Status::kOk);
    }
    SpeedProfile speed;
    SpeedRequest request;
    request.start_speed_mps = 100.0f;
    request.start_curvature_per_m = values[pick(random)];
    request.slow_points = INT32_MAX;
    ASSERT_EQ(Plan(path, request, speed), Status::kOk);
    for (const float v : speed) {
      ASSERT_TRUE(std::isfinite(v) && v >= 0.0f && v <= 100.0f) << "case " << i;
    }
  }
}

struct Scene {
  ActuatorPath path;
  SpeedParams params;
  SpeedRequest request;
  std::vector<float> caps;
};

Scene RandomScene(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Scene scene;
  scene.params.max_acceleration_mps2 = 0.3f + 4.0f * unit(random);
  scene.params.max_deceleration_mps2 = 0.3f + 4.0f * unit(random);
  const int steps = 1 + static_cast<int>(unit(random) * static_cast<float>(kMaxPathPoints - 2));
  float direction = 1.0f;
  for (int k = 0; k < steps; ++k) {
    if (unit(random) < 0.02f) direction = -direction;
    ActuatorStep step{0.3f * (unit(random) - 0.5f), direction * (0.1f + 0.4f * unit(random))};
    if (unit(random) < 0.02f) step = {2.0f * (unit(random) - 0.5f), 0.0f};
    EXPECT_EQ(scene.path.steps.PushBack(step), Status::kOk);
  }
  scene.request.start_speed_mps = 5.0f * unit(random);
  scene.request.start_curvature_per_m = unit(random) - 0.5f;
  scene.request.goal_speed_mps = unit(random) < 0.5f ? 0.0f : 3.0f * unit(random);
  scene.request.slow_points = unit(random) < 0.3f ? static_cast<int32_t>(unit(random) * 30.0f) : 0;
  for (int k = 0; k <= steps; ++k) scene.caps.push_back(0.5f + 8.0f * unit(random));
  if (unit(random) < 0.5f) scene.caps.clear();
  return scene;
}

// The limit of a point without the passes, in double.
double PointLimit(const Scene& scene, int k) {
  const auto& steps = scene.path.steps;
  const int last = steps.size();
  const double before = double{steps[k - 1].dr_m};
  const double after = k < last ? double{steps[k].dr_m} : before;
  if (before == 0.0 || after == 0.0 || (before < 0.0) != (after < 0.0)) return 0.0;
  const auto kappa_at = [&](int i) {
    if (i == 0) return double{scene.request.start_curvature_per_m};
    const double a = double{steps[i - 1].dr_m};
    const double b = i < last ? double{steps[i].dr_m} : a;
    if (a * b <= 0.0) return 0.0;
    return double{steps[i - 1].phi_rad} / (0.5 * (std::abs(a) + std::abs(b)));
  };
  const double rate =
      (kappa_at(k) - kappa_at(k - 1)) / (0.5 * (std::abs(before) + std::abs(after)));
  double limit = ShapeLimit(scene.params, VehicleParams{}, kappa_at(k), rate);
  limit = std::min(limit, double{scene.params.max_speed_mps});
  if (k < scene.request.slow_points) {
    limit = std::min(limit, double{scene.params.obstacle_start_speed_mps});
  }
  if (!scene.caps.empty()) limit = std::min(limit, double{scene.caps[static_cast<size_t>(k)]});
  if (k == last) limit = std::min(limit, double{scene.request.goal_speed_mps});
  return limit;
}

// Every rule of the profile by itself: within the point's limit, or braking fully since the start;
// never gaining or losing more than the accelerations allow, except onto a stop that could not be
// reached; and nowhere slower than some limit or acceleration asks for.
void CheckProfile(const Scene& scene, const SpeedProfile& speed, uint32_t seed) {
  const auto& steps = scene.path.steps;
  ASSERT_EQ(speed.size(), steps.size() + 1);
  ASSERT_EQ(speed[0], scene.request.start_speed_mps);
  const double up = 2.0 * double{scene.params.max_acceleration_mps2};
  const double down = 2.0 * double{scene.params.max_deceleration_mps2};
  bool braking = true;
  for (int k = 1; k < speed.size(); ++k) {
    const double way = std::abs(double{steps[k - 1].dr_m});
    const double v2 = double{speed[k]} * double{speed[k]};
    const double before2 = double{speed[k - 1]} * double{speed[k - 1]};
    const double limit = PointLimit(scene, k);
    const double next2 = k + 1 < speed.size() ? double{speed[k + 1]} * double{speed[k + 1]} : 1e9;
    const double next_way = k < steps.size() ? std::abs(double{steps[k].dr_m}) : 0.0;
    const double tolerance = 1e-4;
    const bool brakes_fully = std::abs(before2 - down * way - v2) < tolerance;
    const bool overruns_end = braking && brakes_fully && k == speed.size() - 1;
    if (limit == 0.0 && !overruns_end) {
      ASSERT_EQ(speed[k], 0.0f) << "seed " << seed << " point " << k;
    }
    braking = braking && brakes_fully;
    ASSERT_TRUE(braking || v2 <= limit * limit + tolerance) << "seed " << seed << " point " << k;
    ASSERT_LE(v2, before2 + up * way + tolerance) << "seed " << seed << " point " << k;
    const bool stop = limit == 0.0;
    ASSERT_TRUE(stop || v2 >= before2 - down * way - tolerance)
        << "seed " << seed << " point " << k;
    const bool at_limit = v2 >= limit * limit - tolerance;
    const bool gains_fully = v2 >= before2 + up * way - tolerance;
    const bool must_brake = v2 >= next2 + down * next_way - tolerance;
    ASSERT_TRUE(braking || at_limit || gains_fully || must_brake)
        << "seed " << seed << " point " << k << " is slower than it need be";
  }
}

// The two passes one point after the other, in double, on the limits of PointLimit: what the order
// in which the gains are added may change is in the last bits.
std::vector<double> PlanPointByPoint(const Scene& scene) {
  const auto& steps = scene.path.steps;
  const int last = steps.size();
  std::vector<double> squared{std::pow(double{scene.request.start_speed_mps}, 2.0)};
  for (int k = 1; k <= last; ++k) squared.push_back(std::pow(PointLimit(scene, k), 2.0));
  const auto at = [&](int k) -> double& { return squared[static_cast<size_t>(k)]; };
  const auto way = [&](int k) { return std::abs(double{steps[k].dr_m}); };
  const double down = 2.0 * double{scene.params.max_deceleration_mps2};
  const double up = 2.0 * double{scene.params.max_acceleration_mps2};
  for (int k = last - 1; k >= 1; --k) at(k) = std::min(at(k), at(k + 1) + down * way(k));
  bool within = false;
  for (int k = 1; k <= last; ++k) {
    const double braked = at(k - 1) - down * way(k - 1);
    within = within || braked <= at(k);
    const bool stand = k < last ? PointLimit(scene, k) == 0.0 : way(k - 1) == 0.0;
    at(k) = within ? std::min(at(k), at(k - 1) + up * way(k - 1)) : stand ? 0.0 : braked;
  }
  return squared;
}

TEST(SpeedPlanner, AgreesWithThePassesPointByPointForEveryNumberOfPoints) {
  for (uint32_t seed = 0; seed < 2000; ++seed) {
    Scene scene = RandomScene(seed);
    scene.path.steps.Resize(std::min(scene.path.steps.size(), 1 + static_cast<int>(seed % 255)));
    scene.caps.resize(scene.caps.empty() ? 0 : static_cast<size_t>(scene.path.steps.size()) + 1);
    scene.request.cap_mps = scene.caps;
    SpeedProfile speed;
    ASSERT_EQ(Plan(scene.path, scene.request, speed, scene.params), Status::kOk);
    const std::vector<double> squared = PlanPointByPoint(scene);
    for (int k = 0; k < speed.size(); ++k) {
      ASSERT_NEAR(double{speed[k]} * double{speed[k]}, squared[static_cast<size_t>(k)], 2e-5)
          << "seed " << seed << " point " << k << " of " << speed.size();
    }
  }
}

// SR-SPD01
TEST(SpeedPlanner, KeepsEveryLimitAndWastesNoneOnRandomPaths) {
  for (uint32_t seed = 0; seed < 2000; ++seed) {
    Scene scene = RandomScene(seed);
    scene.request.cap_mps = scene.caps;
    SpeedProfile speed;
    ASSERT_EQ(Plan(scene.path, scene.request, speed, scene.params), Status::kOk);
    CheckProfile(scene, speed, seed);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace hardpack
