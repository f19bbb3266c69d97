// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/vehicle/body_on_ground.h"
#include "tools/sim/vehicle/pose.h"
#include "tools/sim/vehicle/steered_model_params.h"
#include "tools/sim/vehicle/wheel_dynamics.h"

// A vehicle with steered front wheels (Ackermann), on level ground that holds or on what SetGround
// says (body_on_ground.h). With v the wheels' speed and, where they hold, that of the rear
// axle's middle, delta the mean steering angle, L the wheelbase, and u the setpoint of each after
// its dead time:
//
//   v'     = clamp((u_v - v) / tau_v, -deceleration, acceleration)     toward or away from rest
//   delta' = clamp((u_delta - delta) / tau_delta, -rate, rate),  |delta| <= max_steering
//   w      follows v tan(delta) / (L (1 + understeer v^2))  after a first-order lag
//
// The rear axle's middle is the origin of the body frame and does not slip sideways. At speed the
// front tyres do, so the vehicle turns less than its wheels point (understeer, a linear
// single-track model in a steady turn). Explicit Euler steps; the same calls give the same bits on
// every processor.

namespace hardpack::sim {

struct SteeredSetpoints {
  bool driven = false;  // false: its brake holds, and the wheels keep their angle
  double speed_mps = 0.0;
  double steering_rad = 0.0;
};

class SteeredModel {
 public:
  // Standing at `start`, wheels straight. The parameters have passed CheckVehicleModel.
  SteeredModel(const SteeredModelParams& params, const Pose& start, double step_s);

  // What it stands on from now on.
  void SetGround(const GroundUnder& ground) { body_.SetGround(ground); }
  void Step(const SteeredSetpoints& setpoints);

  const SteeredModelParams& params() const { return params_; }
  const Pose& pose() const { return pose_; }  // of the rear axle's middle
  double speed_mps() const { return speed_mps_; }
  double yaw_rate_radps() const { return yaw_rate_radps_; }
  double driven_m() const { return driven_m_; }
  // As measured by its own sensors.
  double measured_speed_mps() const { return params_.measured_speed_share * wheels_mps_; }
  double steering_rad() const { return steering_rad_; }
  const BodyOnGround& body() const { return body_; }

 private:
  void Drive(const SteeredSetpoints& setpoints);
  void Steer(const SteeredSetpoints& setpoints);
  void Move();

  SteeredModelParams params_;
  double step_s_;
  DelayLine speed_setpoint_;
  DelayLine steering_setpoint_;
  BodyOnGround body_;
  Pose pose_;
  double wheels_mps_ = 0.0;
  double speed_mps_ = 0.0;
  double steering_rad_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  double driven_m_ = 0.0;
};

}  // namespace hardpack::sim
