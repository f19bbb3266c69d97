// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "core/base/math.h"
#include "core/tracking/tracking.h"
#include "test/decision/random.h"
#include "test/decision/report.h"

// The tracker in a closed loop with a vehicle of the same kind, along a sine, with stops, turns on
// the spot and feedback that comes and goes.

namespace hardpack::decision {
namespace {

constinit Tracker tracker;  // too big for the stack

void AddState(const TrackingOutput& output, DecisionHash& hash) {
  hash.AddFloat(output.wheels.left_radps);
  hash.AddFloat(output.wheels.right_radps);
  hash.AddFloat(output.speed_mps);
  hash.AddFloat(tracker.predicted().pose.x_m);
  hash.AddFloat(tracker.predicted().pose.theta_rad);
}

TrackingInput InputAt(const Pose2& pose, int tick) {
  constexpr float kWave_per_m = 0.4f;
  TrackingInput input;
  const SinCosPair wave = SinCos(kWave_per_m * pose.x_m);
  input.pose = pose;
  input.path = {pose.x_m, 1.5f * wave.sin, Atan2(1.5f * kWave_per_m * wave.cos, 1.0f)};
  input.turn_curvature_per_m = -1.5f * kWave_per_m * kWave_per_m * wave.sin;
  input.wheel_curvature_per_m = input.turn_curvature_per_m;
  input.speed_limit_mps = tick % 700 < 500 ? 4.0f : 1.0f;
  input.left_m = tick % 900 < 850 ? 20.0f : 1.0f;
  input.aim.pose = {pose.x_m + 2.0f, pose.y_m * 0.5f, 1.0f};
  input.turn = tick % 1000 >= 900;
  return input;
}

// Wheels and body that come after what they were told.
void Roll(const TrackingOutput& output, WheelParts& wheels, Pose2& pose) {
  const WheelParts told = PartsOf(output.wheels.left_radps, output.wheels.right_radps);
  wheels.common_radps += 0.018f * (told.common_radps - wheels.common_radps);
  wheels.differential_radps += 0.012f * (told.differential_radps - wheels.differential_radps);
  const SinCosPair heading = SinCos(pose.theta_rad);
  pose.x_m += 0.0029f * wheels.common_radps * heading.cos;
  pose.y_m += 0.0029f * wheels.common_radps * heading.sin;
  pose.theta_rad = WrapAngle(pose.theta_rad + 0.0031f * wheels.differential_radps);
}

WheelFeedback FeedbackOf(const WheelParts& wheels, uint64_t now_ns, bool is_fresh) {
  return {.valid = is_fresh,
          .time_ns = now_ns - 6'000'000,
          .left_radps = wheels.common_radps - wheels.differential_radps,
          .right_radps = wheels.common_radps + wheels.differential_radps};
}

Status Steer(int tick, TrackingOutput& output) {
  const TrackingInput input = InputAt(tracker.predicted().pose, tick);
  return tick % 1300 < 1200 ? tracker.Follow(input, 0.01f, output)
                            : tracker.StopAlong(input, 0.01f, output);
}

BodyMotion BodyOf(const WheelParts& wheels, int tick) {
  return {.valid = tick % 50 < 40,
          .speed_mps = 0.29f * wheels.common_radps,
          .yaw_rate_radps = 0.31f * wheels.differential_radps};
}

TrackingParams WithMethod(int32_t method) {
  TrackingParams params;
  params.method = method;
  return params;
}

// Not on the stack of a function that is held to 512 bytes.
constexpr VehicleParams kVehicle;
constexpr SpeedParams kSpeed;
constexpr OdometryParams kOdometry;
constexpr DynamicsParams kDynamics;

DecisionHash Along(int32_t method) {
  DecisionHash hash;
  Random random(0x5eed0011u);
  hash.AddU8(static_cast<uint8_t>(
      tracker.Configure(kVehicle, kSpeed, kOdometry, kDynamics, WithMethod(method))));
  Pose2 pose;
  WheelParts wheels;
  TrackingOutput output;
  uint64_t now_ns = 1'000'000'000;
  for (int tick = 0; tick < 3000; ++tick) {
    now_ns += 10'000'000;
    Roll(output, wheels, pose);
    const bool is_fresh = random.Next() % 8u != 0u;
    hash.AddU8(static_cast<uint8_t>(
        tracker.Predict(now_ns, pose, FeedbackOf(wheels, now_ns, is_fresh), BodyOf(wheels, tick))));
    hash.AddU8(static_cast<uint8_t>(Steer(tick, output)));
    AddState(output, hash);
  }
  return hash;
}

}  // namespace

void RunTracking(Report& report) {
  report.Add("tracking.lag_aware", Along(TrackingParams::kLagAware));
  report.Add("tracking.pure_pursuit", Along(TrackingParams::kPurePursuit));
}

}  // namespace hardpack::decision
