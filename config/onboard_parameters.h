// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/drive_parameters.h"
#include "config/parameters.h"
#include "config/twist_drive_parameters.h"

// The parameters of the onboard chain beyond perception and planning: what a tick needs besides.
// Ranges and descriptions: config/onboard_tables.h. What only the Linux port needs (addresses,
// paths, priorities) is the port's (port_linux/files/configuration.h).

namespace hardpack {

// The inertial navigation system's place in the body frame.
struct InsParams {
  float yaw_rad = 0.0f;  // of its x axis in the body frame, anticlockwise
  float pitch_rad = 0.0f;
  float roll_rad = 0.0f;
};

// The filter of core/odometry/odometry.h. A walk is one standard deviation of what a state changes
// by in a second; it grows with the root of the time.
struct OdometryParams {
  float ground_per_wheel = 0.962f;  // ground speed over wheel rim speed, straight on: to begin with
  float max_rate_age_s = 0.05f;     // an older yaw rate of the INS is not used: wheels alone
  float max_lateness_s = 0.1f;      // what comes later than this after newer ones is not used
  float gate_sigma = 5.0f;          // what is further off is rejected ...
  float gate_open_s = 0.3f;         // ... but not for longer than this
  float gyro_sigma_radps = 0.01f;
  float gyro_bias_sigma_radps = 0.01f;  // to begin with
  float gyro_bias_walk_radps = 1.0e-5f;
  float speed_walk_mps = 1.5f;
  float yaw_rate_walk_radps = 3.0f;
  float wheel_sigma_mps = 0.05f;    // of a rim speed
  float wheel_slip_share = 0.03f;   // and besides, of what it says
  float wheel_lag_s = 0.29f;        // and of what it has changed by in about so long ...
  float wheel_lag_share = 1.0f;     // ... so much
  float wheel_scale_sigma = 0.05f;  // to begin with
  float wheel_scale_walk = 0.001f;  // while it drives
  float turn_slip_share = 0.2f;     // of the difference of the rim speeds in a turn
  float baseline_sigma_m = 0.3f;    // to begin with
  float baseline_walk_m = 0.05f;    // while it turns
  float min_turn_radps = 0.15f;     // slower turns do not tell the baseline
  float turning_point_m = 0.8f;     // at speed the vehicle turns about a point so far ahead ...
  float turning_point_speed_mps = 1.67f;  // ... of which 0.7 at this speed
  float ground_speed_sigma_mps = 0.15f;   // of the INS's speed over ground
  float min_ground_speed_mps = 1.0f;      // a slower one does not tell the wheel scale
  float rest_wheel_radps = 0.03f;         // slower wheels stand; for ...
  float rest_time_s = 0.5f;               // ... so long: the vehicle is at rest,
  float rest_rate_radps = 0.05f;          // unless it turns faster than this
  float frozen_time_s = 1.0f;  // the same to the bit for so long, against the others: frozen
};

// The slowly changing transform from map to odom (core/odometry/map_from_odom.h).
struct MapFromOdomParams {
  float gate_sigma = 4.0f;            // what is further off is rejected ...
  float persist_s = 5.0f;             // ... unless it stays there for so long
  float min_position_sigma_m = 0.5f;  // the INS's positions are not taken to be better than this
  float position_sigma_m = 1.5f;      // where it does not say how good they are
  float yaw_sigma_rad = 0.03f;        // of the INS's heading
  float drift_share = 0.02f;          // of the way: what odom drifts by
  float yaw_drift_radps = 0.001f;     // a walk, as in OdometryParams
  float slew_mps = 0.2f;              // the transform moves by no more than this at the vehicle ...
  float slew_radps = 0.01f;           // ... and turns by no more than this
  float max_ins_age_s = 1.0f;         // an older position of the INS is none
};

// How the wheels follow their command, and the body the wheels (core/tracking/drive_model.h): the
// common part is half the sum of both sides, the differential part half of right minus left. From
// config/vehicles/warthog_paper.toml, a fit to recordings of a Warthog (docs/simulation.md). The
// ratio of ground to wheel speed and the turning point are in OdometryParams, the baseline is
// VehicleParams::skid_baseline_m.
struct DynamicsParams {
  float dead_time_s = 0.14f;         // from a command to the first change of the wheels
  float common_lag_s = 0.23f;        // first order
  float common_slew_radps2 = 14.0f;  // largest change
  float differential_lag_s = 0.43f;  // the same of the differential part
  float differential_slew_radps2 = 5.8f;
  float differential_limit_radps = 7.07f;  // that no command exceeds, at rest ...
  float differential_limit_slope = 0.12f;  // ... and less by this for each rad/s of the common part
  float scrub_radps = 1.82f;               // what tyres that scrub sideways take of a command ...
  float scrub_width_radps = 1.04f;         // ... 0.7 of it at this differential speed ...
  float integral_time_s = 3.7f;            // ... until the drives have made up for it, after this
  float speed_lag_s = 0.3f;                // of the body's speed behind its wheels, first order
  float yaw_rate_lag_s = 0.2f;             // of its yaw rate
};

// Following the committed plan (core/tracking).
struct TrackingParams {
  static constexpr int32_t kPurePursuit = 0;  // without the lags, for comparison
  static constexpr int32_t kLagAware = 1;
  int32_t method = kLagAware;
  float bandwidth_radps = 1.5f;       // of the feedback of place and heading, at most ...
  float settle_way_m = 0.6f;          // ... and at most the speed over this way
  float speed_gain_per_s = 2.0f;      // change of the speed per speed error
  float turn_bandwidth_radps = 6.0f;  // of that of the yaw rate within it
  float wheel_gain_per_s = 4.0f;      // change of the wheels' common speed per error of it
  float integral_rate_per_s = 0.5f;   // how fast a lasting error of the yaw rate is learned
  float max_cross_track_m = 2.0f;     // further off its path the vehicle is brought to rest
  float lookahead_s = 0.5f;           // pure pursuit: way ahead that is aimed at, in time ...
  float min_lookahead_m = 0.8f;       // ... and at least
  float heading_gain_per_s = 2.0f;    // turn on the spot: yaw rate per heading error
  float max_pivot_rate_radps = 0.8f;
};

// How far a device's clock is believed to drift from ours (core/timebase/timebase.h).
struct ClockParams {
  float max_drift_ppm = 500.0f;  // what a time server that slews a clock keeps to
  float max_drift_s = 0.02f;     // and besides, in sum, since the earliest datagram so far
};

// When the vehicle may move (core/safety/supervisor.h).
struct SafetyParams {
  float max_lidar_age_s = 0.3f;     // of the newest column
  float max_look_age_s = 0.42f;     // of the oldest look along the way (core/scan/sight_watch.h)
  float max_odometry_age_s = 0.1f;  // of the wheel speeds
  float max_ins_age_s = 0.2f;
  int32_t needs_ins = 1;        // 0: a silent INS does not stop the vehicle
  float max_plan_age_s = 1.0f;  // since the map was begun on which the plan was checked
  float operator_timeout_s =
      3.0f;                      // without a word or a press of the operator's; 0: nobody is missed
  float max_stop_s = 8.0f;       // a safe stop that takes longer becomes zero speed
  float hard_age_factor = 3.0f;  // an age beyond this many times its limit: zero speed at once
  // The corridor that single returns are held against (core/safety/corridor.h).
  float corridor_margin_m = 0.05f;  // beyond half the vehicle's width
  float sweep_margin_m = 0.05f;     // beyond the outline, on the way to a stop (motion_sweep.h)
  // The last limits of a command (core/safety/command_gate.h).
  float max_wheel_acceleration_radps2 = 200.0f;
  // Motion against command (core/safety/motion_watch.h).
  float motion_speed_margin_mps = 1.0f;
  float motion_yaw_margin_radps = 0.6f;
  float motion_time_s = 1.0f;  // so long beyond a margin is a fault
  float stuck_time_s = 5.0f;   // told to move, and standing
  // Wheels that are faster than the ground by the INS.
  float spin_speed_margin_mps = 1.0f;
  float spin_share = 0.25f;  // and besides, so much of what the wheels say
  float spin_time_s = 1.0f;  // so long is a fault
  // Where the vehicle itself hides what is behind it from the lidar: anticlockwise from one angle
  // of the body frame to the other. The same: nowhere.
  float sight_mask_from_rad = 0.0f;
  float sight_mask_to_rad = 0.0f;
};

// The work of one tick (hal/onboard/vehicle_loop.h).
struct TickParams {
  int32_t period_ms = 10;
  int32_t planning_units = 4000;  // of the stages, in every tick
  int32_t directions = 256;       // of the lidar that are classed in a tick, at most
};

struct OnboardParams {
  DriveParams drive;
  TwistDriveParams twist_drive;
  InsParams ins;
  OdometryParams odometry;
  MapFromOdomParams map_from_odom;
  ClockParams clock;
  DynamicsParams dynamics;
  TrackingParams tracking;
  SafetyParams safety;
  TickParams tick;
};
static_assert(std::is_trivially_copyable_v<OnboardParams>);

}  // namespace hardpack
