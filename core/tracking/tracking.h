// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// From what a path says to wheel speeds, once a tick: pure pursuit of a point ahead, the plan's
// speed within its acceleration limits, turns on the spot, and a skid-steer mixer that keeps the
// turn and gives up speed when a wheel would be too fast. It does not choose the path, the place on
// it or whether to move (core/safety/supervisor.h). The paper hands its path to a tracker of its
// own ([OS] System Overview).
//
//   kappa = 2 y / (x^2 + y^2), of the point aimed at in the body frame;  w = v kappa
//   w_l,r = (v -+ w baseline / 2) / (r ground_per_wheel)

namespace hardpack {

// What the path says at a place.
struct TrackingPoint {
  Pose2 pose;  // odom
  float speed_mps = 0.0f;
};

struct TrackingInput {
  Pose2 pose;                    // odom, where the vehicle will be when this command takes effect
  float speed_limit_mps = 0.0f;  // of the path where the vehicle will be, and just ahead of it
  TrackingPoint aim;             // the point that is aimed at
  bool turn = false;             // on the spot, to aim.pose.theta_rad; the vehicle stands
};

struct TrackingOutput {
  float speed_mps = 0.0f;  // commanded
  float yaw_rate_radps = 0.0f;
  float curvature_per_m = 0.0f;  // 0 where it stands or turns on the spot
  WheelCommand wheels;
};

class Tracker {
 public:
  // At rest. kParameterOutOfRange: odometry or tracking; the others were checked before.
  Status Configure(const VehicleParams& vehicle, const SpeedParams& speed,
                   const OdometryParams& odometry, const TrackingParams& tracking);

  // The commands of one tick of dt_s. The speed goes towards speed_limit_mps by at most the plan's
  // acceleration and deceleration limits. kNotFinite: a number, then zero is commanded.
  Status Follow(const TrackingInput& input, float dt_s, TrackingOutput& output);

  // The same with the speed going to 0 by the deceleration limit, along the path. A turn on the
  // spot ends at once.
  Status StopAlong(const TrackingInput& input, float dt_s, TrackingOutput& output);

  // Zero at once.
  void Zero(TrackingOutput& output);

  float speed_mps() const { return speed_mps_; }  // commanded last
  float curvature_per_m() const { return curvature_per_m_; }

 private:
  Status Drive(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output);
  float CurvatureTo(const TrackingInput& input) const;
  void Mix(float speed_mps, float yaw_rate_radps, TrackingOutput& output);

  VehicleParams vehicle_;
  SpeedParams limits_;
  OdometryParams odometry_;
  TrackingParams params_;
  bool configured_ = false;
  float speed_mps_ = 0.0f;
  float curvature_per_m_ = 0.0f;
};
static_assert(std::is_trivially_copyable_v<Tracker>);

}  // namespace hardpack
