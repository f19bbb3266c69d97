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

// How the wheels follow their command (core/tracking/drive_model.h): the common part is half the
// sum of both sides, the differential part half of right minus left. From recordings of a Warthog
// (docs/vehicle.md, "How it moves"). The ratio of ground to wheel speed is
// OdometryParams::ground_per_wheel, the baseline VehicleParams::skid_baseline_m.
struct DynamicsParams {
  float dead_time_s = 0.17f;   // from a command to the first change of the wheels
  float slew_radps2 = 17.0f;   // largest change of either part
  float common_lag_s = 0.48f;  // first order
  float differential_lag_s = 0.91f;
  float differential_gain = 0.907f;       // settled part over its command, for small ones ...
  float differential_limit_radps = 7.9f;  // ... and the most that any command reaches
};

// Following the committed plan (core/tracking).
struct TrackingParams {
  static constexpr int32_t kPurePursuit = 0;  // without the lags, for comparison
  static constexpr int32_t kLagAware = 1;
  int32_t method = kLagAware;
  float bandwidth_radps = 2.3f;      // of the feedback of place and heading, at most ...
  float settle_way_m = 0.6f;         // ... and at most the speed over this way
  float speed_gain_per_s = 3.0f;     // change of the speed per speed error
  float yaw_rate_gain_per_s = 4.0f;  // change of the yaw rate per yaw rate error, at least
  float integral_rate_per_s = 0.5f;  // how fast a lasting error of the yaw rate is learned
  float max_cross_track_m = 2.0f;    // further off its path the vehicle is brought to rest
  float lookahead_s = 0.5f;          // pure pursuit: way ahead that is aimed at, in time ...
  float min_lookahead_m = 0.8f;      // ... and at least
  float heading_gain_per_s = 2.0f;   // turn on the spot: yaw rate per heading error
  float max_pivot_rate_radps = 0.8f;
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
  DynamicsParams dynamics;
  TrackingParams tracking;
  SafetyParams safety;
  TickParams tick;
};
static_assert(std::is_trivially_copyable_v<OnboardParams>);

}  // namespace hardpack
