// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sim/vehicle/body_on_ground.h"
#include "tools/sim/vehicle/pose.h"
#include "tools/sim/vehicle/vehicle_model_params.h"
#include "tools/sim/vehicle/wheel_dynamics.h"

// A skid-steered vehicle, from the setpoints of its wheels to its pose: the wheels of
// wheel_dynamics.h, and a body that they move, on level ground that holds or on what SetGround says
// (body_on_ground.h: what follows is the speed then that its tyres are asked for). With c and d the
// common and the differential wheel speed, r the wheels' radius:
//
//   v_x follows ground_per_wheel r c (1 - turn_slip d^2 / (c^2 + d^2))  after a first-order lag
//   w   follows 2 r d / skid_baseline                                    after a first-order lag
//   v_y = -w turning_point v_x / sqrt(v_x^2 + turning_point_speed^2)
//
// A lag of 0 s means no lag. The last line is the sideways slip in turns: the faster it drives, the
// further ahead of its middle lies the centre of rotation (its rear swings out). Body frame: x
// forward, y left; yaw rate and angles anticlockwise; metres, seconds, radians.
//
// One instance is one vehicle, without clock or randomness. For another kind of vehicle use other
// parameters, for one of many use Draw(). The same calls give the same bits on every processor.
//
// For a simulator with drives: setpoints at 1 ms; speeds() is what the drives' encoders measure.

namespace hardpack::sim {

class VehicleModel {
 public:
  static constexpr double kStep_s = 0.001;

  // Standing at `start`. The parameters have passed CheckVehicleModel; step_s > 0.
  explicit VehicleModel(const VehicleModelParams& params, const Pose& start = {},
                        double step_s = kStep_s);

  // As if it had driven for a while with its wheels at `speeds` and the setpoints at `command`.
  void Settle(const WheelSpeeds& speeds, const WheelSpeeds& command);
  void Settle(const WheelSpeeds& speeds, const WheelSpeeds& command, double integral_radps);
  // What it stands on from now on.
  void SetGround(const GroundUnder& ground) { body_.SetGround(ground); }
  void Step(const WheelSetpoints& setpoints);
  // The same step for the body only, with its wheels turning at `speeds`.
  void StepBody(const WheelSpeeds& speeds);

  const WheelSpeeds& wheels() const { return wheels_.speeds(); }  // true, forward positive
  double integral_radps() const { return wheels_.integral_radps(); }
  const Pose& pose() const { return pose_; }                       // of the body's middle
  double speed_mps() const { return speed_mps_; }                  // v_x
  double lateral_speed_mps() const { return lateral_speed_mps_; }  // v_y, to the left
  double yaw_rate_radps() const { return yaw_rate_radps_; }
  // Acceleration of the body's middle over ground, in the body's axes, as an accelerometer there
  // measures it on level ground; over the last step.
  double acceleration_x_mps2() const { return acceleration_x_mps2_; }
  double acceleration_y_mps2() const { return acceleration_y_mps2_; }
  double driven_m() const { return driven_m_; }  // distance covered, forwards or backwards
  const BodyOnGround& body() const { return body_; }

 private:
  void SettleBody();
  double GroundSpeed_mps() const;
  double KinematicYawRate_radps() const;
  double LateralSpeed_mps() const;
  double Followed(double value, double target, double time_constant_s) const;
  void MoveBody();
  void Move();

  VehicleModelParams params_;
  double step_s_;
  WheelDynamics wheels_;
  BodyOnGround body_;
  Pose pose_;
  double speed_mps_ = 0.0;
  double lateral_speed_mps_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  double acceleration_x_mps2_ = 0.0;
  double acceleration_y_mps2_ = 0.0;
  double driven_m_ = 0.0;
};

}  // namespace hardpack::sim
