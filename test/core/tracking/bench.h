// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/committed_plan/path_target.h"
#include "core/speed/speed.h"
#include "core/tracking/tracking.h"
#include "tools/sim/vehicle/vehicle_model.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

// Vehicles to try the tracker on, in double precision and steps of a millisecond, with parameters
// of their own, which the tracker does not know, and noise in what it is told: those of the fit to
// the recordings (tools/sim/vehicle/vehicle_model.h), and simpler ones, which the tracker's model
// is not made for.

namespace hardpack::testing {

// First-order lags, a gain that saturates, no scrubbing, no lag of the body.
struct SimpleVehicle {
  double dead_time_s = 0.17;
  double slew_radps2 = 17.0;
  double common_lag_s = 0.48;
  double differential_lag_s = 0.91;
  double differential_gain = 0.907;
  double differential_limit_radps = 7.9;
  double baseline_m = 1.87;
  double ground_per_wheel = 0.962;
  double wheel_radius_m = 0.30;
  double max_wheel_radps = 17.5;
};

// One of the two.
struct TrueVehicle {
  sim::VehicleModelParams fitted;
  bool is_simple = false;
  SimpleVehicle simple;
};

inline sim::UncertainVehicle Warthog() {
  sim::UncertainVehicle vehicle;
  const ReadOutcome outcome =
      sim::ReadVehicle(HARDPACK_SOURCE "/config/vehicles/warthog_paper.toml", vehicle);
  EXPECT_EQ(outcome.status, Status::kOk);
  return vehicle;
}

inline TrueVehicle Typical() {
  return {.fitted = Warthog().typical, .simple = {}};
}

// One of the many of the fit.
inline TrueVehicle Spread(unsigned seed) {
  static const sim::UncertainVehicle warthog = Warthog();
  return {.fitted = sim::Draw(warthog, seed), .simple = {}};
}

inline TrueVehicle Simple(const SimpleVehicle& vehicle) {
  return {.fitted = {}, .is_simple = true, .simple = vehicle};
}

struct TruePose {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;
};

class VehicleBench {
 public:
  explicit VehicleBench(const TrueVehicle& vehicle)
      : vehicle_(vehicle), fitted_(vehicle.fitted), commands_(kMaxDead_ms, WheelCommand{}) {}

  void Place(const TruePose& pose) {
    pose_ = pose;
    fitted_ = sim::VehicleModel(vehicle_.fitted, {pose.x_m, pose.y_m, pose.theta_rad});
  }
  void Step_ms(const WheelCommand& command) {
    if (vehicle_.is_simple) return StepSimple(command);
    fitted_.Step({.speeds = {command.left_radps, command.right_radps}});
    const sim::Pose& pose = fitted_.pose();
    pose_ = {pose.x_m, pose.y_m, pose.theta_rad};
    common_ = fitted_.wheels().common_radps();
    differential_ = fitted_.wheels().differential_radps();
    speed_mps_ = fitted_.speed_mps();
    yaw_rate_radps_ = fitted_.yaw_rate_radps();
  }
  const TruePose& pose() const { return pose_; }
  double left_radps() const { return common_ - differential_; }
  double right_radps() const { return common_ + differential_; }
  double speed_mps() const { return speed_mps_; }
  double yaw_rate_radps() const { return yaw_rate_radps_; }

 private:
  static constexpr size_t kMaxDead_ms = 1000;

  void StepSimple(const WheelCommand& command) {
    const SimpleVehicle& vehicle = vehicle_.simple;
    commands_[at_ % kMaxDead_ms] = command;
    const auto dead_ms = static_cast<size_t>(std::lround(1000.0 * vehicle.dead_time_s));
    const WheelCommand& late = commands_[(at_ + kMaxDead_ms - dead_ms) % kMaxDead_ms];
    ++at_;
    const double limit = vehicle.max_wheel_radps;
    const double left = std::clamp(static_cast<double>(late.left_radps), -limit, limit);
    const double right = std::clamp(static_cast<double>(late.right_radps), -limit, limit);
    const double most = vehicle.differential_limit_radps;
    const double settled =
        most * std::tanh(vehicle.differential_gain * 0.5 * (right - left) / most);
    const auto toward = [&](double& wheels, double target, double lag_s) {
      wheels +=
          1e-3 * std::clamp((target - wheels) / lag_s, -vehicle.slew_radps2, vehicle.slew_radps2);
    };
    toward(common_, 0.5 * (left + right), vehicle.common_lag_s);
    toward(differential_, settled, vehicle.differential_lag_s);
    const double rim = vehicle.wheel_radius_m * vehicle.ground_per_wheel;
    speed_mps_ = rim * common_;
    yaw_rate_radps_ = 2.0 * differential_ * rim / vehicle.baseline_m;
    const double turn = yaw_rate_radps_ * 1e-3;
    pose_.x_m += speed_mps_ * 1e-3 * std::cos(pose_.theta_rad + 0.5 * turn);
    pose_.y_m += speed_mps_ * 1e-3 * std::sin(pose_.theta_rad + 0.5 * turn);
    pose_.theta_rad += turn;
  }

  TrueVehicle vehicle_;
  sim::VehicleModel fitted_;
  std::vector<WheelCommand> commands_;
  size_t at_ = kMaxDead_ms;
  double common_ = 0.0;
  double differential_ = 0.0;
  double speed_mps_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  TruePose pose_;
};

// A path of even steps from a heading as a function of the way.
inline WorldPath PathOf(double length_m, const std::function<double(double)>& heading_rad) {
  constexpr int kFine = 50;
  const int points = std::min(kMaxPathPoints, static_cast<int>(length_m / 0.25) + 1);
  const double step_m = length_m / (points - 1) / kFine;
  WorldPath path;
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < points; ++i) {
    path.Resize(i + 1);
    path[i] = {static_cast<float>(x), static_cast<float>(y), 0.0f};
    for (int k = 0; k < kFine; ++k) {
      const double heading = heading_rad((i * kFine + k + 0.5) * step_m);
      x += step_m * std::cos(heading);
      y += step_m * std::sin(heading);
    }
  }
  SetHeadingsFromChords(path);
  return path;
}

inline WorldPath Reversed(const WorldPath& forward) {
  WorldPath path = forward;
  for (Pose2& pose : path) pose.theta_rad = WrapAngle(pose.theta_rad + kPi);
  return path;
}

inline CommittedPlan PlanOf(const WorldPath& path, const SpeedParams& speed,
                            const VehicleParams& vehicle) {
  CommittedPlan plan;
  plan.number = 1;
  plan.status = Status::kOk;
  plan.path = path;
  EXPECT_EQ(ToActuator<PlanarModel>(path, plan.actuator), Status::kOk);
  EXPECT_EQ(PlanSpeed(speed, vehicle, plan.actuator, {}, plan.speed), Status::kOk);
  return plan;
}

struct DriveNoise {
  double position_m = 0.03;
  double heading_rad = 0.5 * std::numbers::pi / 180.0;
  double speed_mps = 0.05;
  double yaw_rate_radps = 0.02;
};

struct Driven {
  std::vector<double> off_m;  // every tick, true
  std::vector<TruePose> poses;
  double overrun_m = 0.0;  // along the path's last heading beyond its end, at most
  double short_m = 0.0;    // of the end, where it came to rest
  double fastest_mps = 0.0;
  double time_s = 0.0;
  double heading_off_rad = 0.0;  // at the end
  bool stood = false;
  bool within_limits = true;
  double most_differential_radps = 0.0;  // of the commands
  double change2_sum = 0.0;              // of their changes from tick to tick, differential part
  double fastest_turn_radps = 0.0;
};

struct DriveSetup {
  TrueVehicle vehicle = Typical();
  VehicleParams params;
  SpeedParams speed;
  OdometryParams odometry;
  DynamicsParams dynamics;
  TrackingParams tracking;
  DriveNoise noise;
  double offset_m = 0.0;  // where it starts, left of the path
  double limit_s = 60.0;
  double feedback_until_s = 1e9;  // then it is lost
  bool feedback_freezes = false;  // or stays what it was, with new times
};

inline double DistanceTo(const WorldPath& path, const TruePose& pose) {
  double best = 1e9;
  for (int i = 0; i + 1 < path.size(); ++i) {
    const double ax = path[i].x_m;
    const double ay = path[i].y_m;
    const double bx = path[i + 1].x_m - ax;
    const double by = path[i + 1].y_m - ay;
    const double length2 = bx * bx + by * by;
    if (length2 == 0.0) continue;
    const double share =
        std::clamp(((pose.x_m - ax) * bx + (pose.y_m - ay) * by) / length2, 0.0, 1.0);
    best = std::min(best, std::hypot(pose.x_m - ax - share * bx, pose.y_m - ay - share * by));
  }
  return best;
}

inline WheelFeedback FeedbackOf(const VehicleBench& bench, uint64_t time_ns) {
  return {.valid = true,
          .time_ns = time_ns,
          .left_radps = static_cast<float>(bench.left_radps()),
          .right_radps = static_cast<float>(bench.right_radps())};
}

// What odometry says of the motion, with noise.
template <typename Random>
BodyMotion BodyOf(const VehicleBench& bench, const DriveNoise& noise, Random& random) {
  std::normal_distribution<double> normal;
  return {.valid = true,
          .speed_mps = static_cast<float>(bench.speed_mps() + noise.speed_mps * normal(random)),
          .yaw_rate_radps =
              static_cast<float>(bench.yaw_rate_radps() + noise.yaw_rate_radps * normal(random))};
}

// Drives the path to its end, ticks of 10 ms: the loop of hal/onboard/vehicle_loop with a fixed
// plan.
inline Driven Drive(const WorldPath& path, const DriveSetup& setup, unsigned seed) {
  constexpr uint64_t kTick_ns = 10'000'000;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const CommittedPlan plan = PlanOf(path, setup.speed, setup.params);
  VehicleBench bench(setup.vehicle);
  const Pose2& first = path[0];
  bench.Place({first.x_m - setup.offset_m * std::sin(first.theta_rad),
               first.y_m + setup.offset_m * std::cos(first.theta_rad), first.theta_rad});
  Tracker tracker;
  EXPECT_EQ(
      tracker.Configure(setup.params, setup.speed, setup.odometry, setup.dynamics, setup.tracking),
      Status::kOk);
  Driven driven;
  TrackingOutput output;
  WheelFeedback feedback;
  PathPlace place;
  uint64_t now_ns = 1'000'000'000;
  int standing = 0;
  double before = 0.0;
  const Pose2& end = path.back();
  const bool reverse = std::cos(HeadingOf({path[1].x_m - first.x_m, path[1].y_m - first.y_m}) -
                                first.theta_rad) < 0.0;
  const double way_sign = reverse ? -1.0 : 1.0;
  for (int tick = 0; tick < static_cast<int>(100.0 * setup.limit_s) && standing < 50; ++tick) {
    now_ns += kTick_ns;
    const double now_s = 0.01 * tick;
    const TruePose& pose = bench.pose();
    const Pose2 seen = {
        static_cast<float>(pose.x_m + setup.noise.position_m * normal(random)),
        static_cast<float>(pose.y_m + setup.noise.position_m * normal(random)),
        WrapAngle(static_cast<float>(pose.theta_rad + setup.noise.heading_rad * normal(random)))};
    const bool lost = now_s > setup.feedback_until_s;
    if (tick % 2 == 0 && !lost) feedback = FeedbackOf(bench, now_ns - 4'000'000);
    if (lost && setup.feedback_freezes) feedback.time_ns = now_ns - 4'000'000;
    static_cast<void>(tracker.Predict(now_ns, seen, feedback, BodyOf(bench, setup.noise, random)));
    const DriveState& ahead = tracker.predicted();
    const bool stands = tracker.speed_mps() <= 0.05f && std::fabs(bench.speed_mps()) <= 0.1;
    place = Project(path, ahead.pose, stands,
                    place.along_m + std::fabs(ahead.speed_mps) * 0.01f + 3.0f);
    TrackingInput target;
    EXPECT_EQ(PathTarget(plan,
                         {.pose = ahead.pose,
                          .place = place,
                          .speed_mps = tracker.speed_mps(),
                          .turn_ahead_m = tracker.TurnAhead_m(),
                          .wheel_ahead_m = tracker.WheelAhead_m(),
                          .stands = stands},
                         setup.tracking, target),
              Status::kOk);
    EXPECT_TRUE(IsUsable(tracker.Follow(target, 0.01f, output)));
    for (int ms = 0; ms < 10; ++ms) bench.Step_ms(output.wheels);

    const double told =
        0.5 * static_cast<double>(output.wheels.right_radps - output.wheels.left_radps);
    driven.most_differential_radps = std::max(driven.most_differential_radps, std::fabs(told));
    driven.change2_sum += (told - before) * (told - before);
    before = told;
    driven.fastest_turn_radps =
        std::max(driven.fastest_turn_radps, std::fabs(bench.yaw_rate_radps()));
    const TruePose& now = bench.pose();
    driven.poses.push_back(now);
    const double beyond_m = way_sign * (std::cos(end.theta_rad) * (now.x_m - end.x_m) +
                                        std::sin(end.theta_rad) * (now.y_m - end.y_m));
    const bool near_end = std::hypot(now.x_m - end.x_m, now.y_m - end.y_m) < 3.0 &&
                          place.along_m > 0.5f * LengthOf(path);
    if (near_end) driven.overrun_m = std::max(driven.overrun_m, beyond_m);
    if (near_end) driven.short_m = -beyond_m;
    if (!near_end || beyond_m < 0.0) driven.off_m.push_back(DistanceTo(path, now));
    driven.fastest_mps = std::max(driven.fastest_mps, std::fabs(bench.speed_mps()));
    driven.time_s = now_s;
    const float most = setup.params.max_wheel_speed_radps * 1.0001f;
    driven.within_limits &=
        std::fabs(output.wheels.left_radps) <= most && std::fabs(output.wheels.right_radps) <= most;
    const bool is_still = near_end && std::fabs(bench.speed_mps()) < 0.02 &&
                          std::fabs(bench.right_radps() - bench.left_radps()) < 0.1;
    standing = is_still ? standing + 1 : 0;
    driven.stood = standing > 0;
    driven.heading_off_rad =
        std::fabs(std::remainder(now.theta_rad - end.theta_rad, 2.0 * std::numbers::pi));
  }
  return driven;
}

inline double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace hardpack::testing
