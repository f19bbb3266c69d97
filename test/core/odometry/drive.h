// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "core/odometry/odometry.h"

// A vehicle whose truth is known, and what its sensors say of it, into an Odometry: the INS at
// 200 Hz, ticks with wheel speeds at 100 Hz.

namespace hardpack::testing {

struct Flaws {
  double gyro_bias_radps = 0.0;
  double gyro_noise_radps = 0.002;
  double wheel_noise_radps = 0.02;
  double wheel_scale = 0.962;    // ground speed over rim speed
  double baseline_m = 1.87;      // ground speeds' difference over the yaw rate
  double turning_point_m = 0.8;  // at speed, ahead of the middle; 0.7 of it at ...
  double turning_point_speed_mps = 1.67;
  bool has_ground_speed = true;
  double ground_speed_noise_mps = 0.05;
};

class KnownDrive {
 public:
  static constexpr uint64_t kHalfTick_ns = 5'000'000;

  explicit KnownDrive(const Flaws& what = {}, uint32_t seed = 20250208,
                      const OdometryParams& params = {}, const InsParams& ins = {})
      : flaws(what), random_(seed) {
    EXPECT_EQ(odometry.Configure(vehicle, params, ins), Status::kOk);
  }

  // Half a tick of truth.
  void Move(double v_mps, double w_radps) {
    const double dt_s = static_cast<double>(kHalfTick_ns) * 1e-9;
    const double middle_rad = yaw_rad + w_radps * dt_s / 2.0;
    const double left_mps =
        -w_radps * flaws.turning_point_m * v_mps / std::hypot(v_mps, flaws.turning_point_speed_mps);
    const double level_s = dt_s * std::cos(grade_rad);
    aside_mps = left_mps + slide_mps;
    x_m += level_s * (v_mps * std::cos(middle_rad) - aside_mps * std::sin(middle_rad));
    y_m += level_s * (v_mps * std::sin(middle_rad) + aside_mps * std::cos(middle_rad));
    z_m += dt_s * v_mps * std::sin(grade_rad);
    yaw_rad += w_radps * dt_s;
    driven_m += std::fabs(v_mps) * dt_s;
    now_ns += kHalfTick_ns;
    this->v_mps = v_mps;
    this->w_radps = w_radps;
  }

  InsSample Ins() {
    InsSample sample;
    sample.has_timestamp = true;
    sample.timestamp_ns = now_ns - 7;
    sample.has_angular_rate = true;
    // z down
    sample.angular_rate = {0.0f, 0.0f,
                           static_cast<float>(-(w_radps + flaws.gyro_bias_radps +
                                                flaws.gyro_noise_radps * normal_(random_)))};
    sample.has_attitude = true;
    sample.yaw_rad = static_cast<float>(std::remainder(north_rad - yaw_rad, 2.0 * M_PI));
    sample.pitch_rad = static_cast<float>(grade_rad - dip_rad);
    sample.has_velocity = sample.has_status = flaws.has_ground_speed;
    const double speed_mps =
        v_mps * std::cos(grade_rad) + flaws.ground_speed_noise_mps * normal_(random_);
    const double climb_mps = v_mps * std::sin(grade_rad) + climb_error_mps;
    const double cos = std::cos(north_rad - yaw_rad);
    const double sin = std::sin(north_rad - yaw_rad);
    sample.roll_rad = static_cast<float>(-bank_rad);
    sample.velocity_ned = {static_cast<float>(speed_mps * cos + aside_mps * sin),
                           static_cast<float>(speed_mps * sin - aside_mps * cos),
                           static_cast<float>(-climb_mps)};
    sample.status.mode = InsMode::kTracking;
    sample.status.gnss_fix = true;
    return sample;
  }

  WheelFeedback Wheels() {
    const double rim_m = static_cast<double>(vehicle.wheel_radius_m) * flaws.wheel_scale;
    const double half_mps = w_radps * flaws.baseline_m / 2.0;
    // A drive that stands says zero.
    const bool stands = v_mps == 0.0 && w_radps == 0.0;
    const double noise_radps = stands ? 0.0 : flaws.wheel_noise_radps;
    WheelFeedback wheels;
    wheels.valid = true;
    wheels.time_ns = now_ns;
    wheels.left_radps = static_cast<float>((v_mps / (1.0 + creep) - half_mps) / rim_m +
                                           noise_radps * normal_(random_));
    wheels.right_radps = static_cast<float>((v_mps / (1.0 + creep) + half_mps) / rim_m +
                                            noise_radps * normal_(random_));
    return wheels;
  }

  // One tick of 10 ms with all that belongs to it.
  void Tick(double v, double w) {
    Move(v, w);
    ASSERT_EQ(odometry.TakeIns(Ins(), now_ns), Status::kOk);
    Move(v, w);
    ASSERT_EQ(odometry.TakeIns(Ins(), now_ns), Status::kOk);
    ASSERT_EQ(odometry.Advance(now_ns, Wheels()), Status::kOk);
  }
  // With ramps of 2 m/s^2 and 2 rad/s^2 to the new speeds.
  void Ticks(int count, double v, double w) {
    for (int i = 0; i < count && !::testing::Test::HasFatalFailure(); ++i) {
      Tick(v_mps + std::clamp(v - v_mps, -0.02, 0.02),
           w_radps + std::clamp(w - w_radps, -0.02, 0.02));
    }
  }

  double PositionError() const {
    return std::hypot(static_cast<double>(odometry.pose().position.x_m) - x_m,
                      static_cast<double>(odometry.pose().position.y_m) - y_m);
  }
  double YawError() const {
    return std::remainder(static_cast<double>(odometry.pose().yaw_rad) - yaw_rad, 2.0 * M_PI);
  }

  VehicleParams vehicle;
  Flaws flaws;
  Odometry odometry;
  uint64_t now_ns = 1'000'000'000;
  double north_rad = 0.6;  // of x, clockwise from north
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  double grade_rad = 0.0;  // of the ground along its heading, upwards
  double bank_rad = 0.0;   // of the ground to the left of its heading, downwards
  double slide_mps = 0.0;  // to the left, beyond what a turn does
  double creep = 0.0;      // share by which it is faster than its wheels
  double dip_rad = 0.0;    // of its nose, against the ground
  double climb_error_mps = 0.0;
  double aside_mps = 0.0;  // to the left, all of it
  double yaw_rad = 0.0;
  double v_mps = 0.0;
  double w_radps = 0.0;
  double driven_m = 0.0;

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace hardpack::testing
