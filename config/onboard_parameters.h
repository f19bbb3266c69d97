// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/drive_parameters.h"
#include "config/parameters.h"

// The parameters of the onboard chain beyond perception and planning: what a tick needs besides.
// Ranges and descriptions: config/onboard_tables.h. What only the Linux port needs (addresses,
// paths, priorities) is the port's (port_linux/configuration.h).

namespace hardpack {

// The inertial navigation system's place in the body frame.
struct InsParams {
  float yaw_rad = 0.0f;  // of its x axis in the body frame, anticlockwise
  float pitch_rad = 0.0f;
  float roll_rad = 0.0f;
};

// Dead reckoning (core/odometry).
struct OdometryParams {
  float ground_per_wheel = 0.962f;  // ground speed over wheel rim speed, straight on
  float max_rate_age_s = 0.05f;     // an older yaw rate of the INS is not used: wheels alone
};

// Following the committed plan (core/tracking).
struct TrackingParams {
  float lookahead_s = 0.5f;         // way ahead that is aimed at, in time ...
  float min_lookahead_m = 0.8f;     // ... and at least
  float heading_gain_per_s = 2.0f;  // turn on the spot: yaw rate per heading error
  float max_pivot_rate_radps = 0.8f;
  float prediction_s = 0.2f;  // dead time of the drives: the pose is carried on by it
};

// When the vehicle may move (core/safety/supervisor.h).
struct SafetyParams {
  float max_lidar_age_s = 0.3f;     // of the newest column
  float max_odometry_age_s = 0.1f;  // of the wheel speeds
  float max_ins_age_s = 0.2f;
  int32_t needs_ins = 1;            // 0: a silent INS does not stop the vehicle
  float max_plan_age_s = 1.0f;      // since the map was begun on which the plan was checked
  float operator_timeout_s = 0.0f;  // silence of the operator's program that stops; 0: none does
  float max_stop_s = 8.0f;          // a safe stop that takes longer becomes zero speed
  float hard_age_factor = 3.0f;     // an age beyond this many times its limit: zero speed at once
  // The corridor that single returns are held against (core/safety/corridor.h).
  float corridor_margin_m = 0.05f;  // beyond half the vehicle's width
  // The last limits of a command (core/safety/command_gate.h).
  float max_wheel_acceleration_radps2 = 200.0f;
  // Motion against command (core/safety/motion_watch.h).
  float motion_speed_margin_mps = 1.0f;
  float motion_yaw_margin_radps = 0.6f;
  float motion_time_s = 1.0f;  // so long beyond a margin is a fault
  float stuck_time_s = 5.0f;   // told to move, and standing
};

// The work of one tick (hal/vehicle_loop.h).
struct TickParams {
  int32_t period_ms = 10;
  int32_t planning_units = 4000;  // of the stages, in every tick
};

struct OnboardParams {
  DriveParams drive;
  InsParams ins;
  OdometryParams odometry;
  TrackingParams tracking;
  SafetyParams safety;
  TickParams tick;
};
static_assert(std::is_trivially_copyable_v<OnboardParams>);

}  // namespace hardpack
