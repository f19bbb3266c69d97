// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// How the wheels of one side follow a commanded speed: dead time, a first-order lag with limited
// slew, a maximum speed; and a spring-applied brake when they are not driven.
//
//   w' = clamp((u(t - dead time) - w) / tau, -slew, slew),  |w| <= limit
//
// Defaults close to the recording of the vehicle (docs/vehicle.md), each side independently.

namespace hardpack::sim {

struct MotorModel {
  double dead_time_s = 0.15;
  double time_constant_s = 0.48;
  double slew_radps2 = 17.0;
  double limit_radps = 13.4;
  double brake_radps2 = 30.0;
};

class WheelMotor {
 public:
  WheelMotor(const MotorModel& model, double step_s);

  // One step. Not driven: the brake holds, and earlier commands are dropped.
  void Step(bool driven, double target_radps);

  double speed_radps() const { return speed_radps_; }
  double acceleration_radps2() const { return acceleration_radps2_; }
  void Stop() { speed_radps_ = 0.0; }  // as against a wall
  // A step in which something else turns the wheels.
  void Turn(double speed_radps) {
    acceleration_radps2_ = (speed_radps - speed_radps_) / step_s_;
    speed_radps_ = speed_radps;
  }

 private:
  MotorModel model_;
  double step_s_;
  std::vector<double> delayed_radps_;  // a ring: the commands within the dead time
  size_t oldest_ = 0;
  double speed_radps_ = 0.0;
  double acceleration_radps2_ = 0.0;
};

}  // namespace hardpack::sim
