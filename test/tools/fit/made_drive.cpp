// SPDX-License-Identifier: Apache-2.0
#include "test/tools/fit/made_drive.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "tools/sim/vehicle/vehicle_model.h"

namespace hardpack::fit {
namespace {

constexpr int kSegmentsOfRun = 6;
constexpr int kSamples = 40;
constexpr int kMillisecondsOfSample = 50;
constexpr int kHold = 5;  // samples, of the wheels
constexpr double kTurn = 6.283185307179586;

double Normal(std::mt19937_64& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(random() >> 11) * 0x1.0p-53;
  return sum;
}

double Setpoint(std::mt19937_64& random) {
  return static_cast<double>(random() % 30001) / 1000.0 - 15.0;
}

// What was, ago.
struct Past {
  std::vector<sim::WheelSpeeds> wheels;
  std::vector<sim::Pose> poses;

  template <typename Value>
  static const Value& Ago(const std::vector<Value>& values, double seconds) {
    const auto milliseconds = static_cast<size_t>(std::lround(seconds * 1000.0));
    return values[values.size() - 1 - std::min(milliseconds, values.size() - 1)];
  }
};

}  // namespace

std::string MakeDriveCsv(const sim::VehicleModelParams& params, const MadeDrive& settings) {
  std::mt19937_64 random(settings.seed);
  std::string text = std::string(kDriveRecordHeader) + "\n";
  for (int run = 0; run < settings.runs; ++run) {
    sim::VehicleModel model(params);
    Past past;
    past.wheels.push_back({});
    past.poses.push_back({});
    sim::WheelSpeeds setpoints;
    sim::WheelSpeeds shown;
    sim::Pose shown_pose;
    for (int part = 0; part < kSegmentsOfRun; ++part) {
      if (part % 3 == 0) setpoints = {Setpoint(random), Setpoint(random)};
      for (int step = 0; step < kSamples; ++step) {
        const sim::WheelSpeeds& wheels = Past::Ago(past.wheels, settings.wheel_age_s);
        if (step % kHold == 1) {
          shown.left_radps = wheels.left_radps + settings.wheel_noise_radps * Normal(random);
        }
        if (step % kHold == 3) {
          shown.right_radps = wheels.right_radps + settings.wheel_noise_radps * Normal(random);
        }
        if (step % 2 == 0) {
          shown_pose = Past::Ago(past.poses, settings.pose_age_s);
          shown_pose.x_m += settings.position_noise_m * Normal(random);
          shown_pose.y_m += settings.position_noise_m * Normal(random);
          shown_pose.theta_rad += settings.yaw_noise_rad * Normal(random);
        }
        std::array<char, 256> line = {};
        std::snprintf(line.data(), line.size(),
                      "%d,%d,%.2f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,0.0,0.0,0.0,%.6f\n",
                      10 * run + part, step, 0.05 * step, setpoints.left_radps,
                      setpoints.right_radps, shown.left_radps, shown.right_radps, shown_pose.x_m,
                      shown_pose.y_m, std::remainder(shown_pose.theta_rad, kTurn));
        text += line.data();
        for (int i = 0; i < kMillisecondsOfSample; ++i) {
          model.Step({.speeds = setpoints});
          past.wheels.push_back(model.wheels());
          past.poses.push_back(model.pose());
        }
      }
    }
  }
  return text;
}

}  // namespace hardpack::fit
