// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/drive_parameters.h"
#include "config/parameters.h"
#include "config/twist_drive_parameters.h"

// The parameters of the onboard chain beyond perception and planning. Ranges and descriptions:
// config/onboard_tables.h. Parameters of the Linux port only (addresses, paths, priorities) are in
// port_linux/files/configuration.h.

namespace hardpack {

// The orientation of the inertial navigation system in the body frame.
struct InsParams {
  float yaw_rad = 0.0f;  // of its x axis in the body frame, anticlockwise
  float pitch_rad = 0.0f;
  float roll_rad = 0.0f;
};

// The filter of core/odometry/odometry.h. A walk is one standard deviation of a state's change per
// second; it grows with the square root of time.
struct OdometryParams {
  float ground_per_wheel = 0.962f;  // ground speed over wheel rim speed, straight: initial value
  float max_rate_age_s = 0.05f;     // an older yaw rate of the INS is not used: wheels only
  float max_lateness_s = 0.1f;      // measurements later than this after newer ones are not used
  float gate_sigma = 5.0f;          // measurements farther off are rejected ...
  float gate_open_s = 0.3f;         // ... but not for longer than this
  float gyro_sigma_radps = 0.01f;
  float gyro_bias_sigma_radps = 0.01f;  // initial
  float gyro_bias_walk_radps = 1.0e-5f;
  float speed_walk_mps = 1.5f;
  float yaw_rate_walk_radps = 3.0f;
  float wheel_sigma_mps = 0.05f;    // of a rim speed
  float wheel_slip_share = 0.03f;   // plus this share of it
  float wheel_lag_s = 0.29f;        // plus, of its change in about this time, ...
  float wheel_lag_share = 1.0f;     // ... this share
  float wheel_scale_sigma = 0.05f;  // initial
  float wheel_scale_walk = 0.001f;  // while driving
  float turn_slip_share = 0.2f;     // of the difference of the rim speeds in a turn
  float baseline_sigma_m = 0.3f;    // initial
  float baseline_walk_m = 0.05f;    // while turning
  float min_turn_radps = 0.15f;     // slower turns do not teach the baseline
  float turning_point_m = 0.8f;     // at speed the vehicle turns about a point this far ahead ...
  float turning_point_speed_mps = 1.67f;  // ... of which 0.7 at this speed
  float ground_speed_sigma_mps = 0.15f;   // of the INS's ground speed
  float min_ground_speed_mps = 1.0f;      // slower ones do not teach the wheel scale
  float rest_wheel_radps = 0.03f;         // slower wheels stand; after ...
  float rest_time_s = 0.5f;               // ... this time the vehicle is at rest,
  float rest_rate_radps = 0.05f;          // unless it turns faster than this
  float frozen_time_s = 1.0f;  // identical to the bit for this long, unlike the others: frozen
};

// The slowly changing transform from map to odom (core/odometry/map_from_odom.h).
struct MapFromOdomParams {
  float gate_sigma = 4.0f;            // poses farther off are rejected ...
  float persist_s = 5.0f;             // ... unless they persist for this long
  float min_position_sigma_m = 0.5f;  // least uncertainty assumed for the INS's positions
  float position_sigma_m = 1.5f;      // if the INS does not report one
  float yaw_sigma_rad = 0.03f;        // of the INS's heading
  float drift_share = 0.02f;          // of the distance driven: drift of odom
  float yaw_drift_radps = 0.001f;     // a walk, as in OdometryParams
  float slew_mps = 0.2f;              // the transform moves by at most this at the vehicle ...
  float slew_radps = 0.01f;           // ... and turns by at most this
  float max_ins_age_s = 1.0f;         // an older position of the INS counts as missing
};

// How the wheels follow their command, and the body the wheels (core/tracking/drive_model.h): the
// common part is half the sum of both sides, the differential part half of right minus left. From
// config/vehicles/warthog_paper.toml, a fit to recordings of a Warthog (docs/simulation.md). The
// ratio of ground to wheel speed and the turning point are in OdometryParams, the baseline is
// VehicleParams::skid_baseline_m.
struct DynamicsParams {
  float dead_time_s = 0.14f;         // from a command to the first change of the wheels
  float common_lag_s = 0.23f;        // first order
  float common_slew_radps2 = 14.0f;  // largest rate of change
  float differential_lag_s = 0.43f;  // the same for the differential part
  float differential_slew_radps2 = 5.8f;
  float differential_limit_radps = 7.07f;  // no command exceeds it, at rest ...
  float differential_limit_slope = 0.12f;  // ... and lower by this per rad/s of the common part
  float scrub_radps = 1.82f;               // loss of a command by tyre scrub ...
  float scrub_width_radps = 1.04f;         // ... 0.7 of it at this differential speed ...
  float integral_time_s = 3.7f;            // ... until the drives compensate for it, in this time
  float speed_lag_s = 0.3f;                // of the body's speed behind its wheels, first order
  float yaw_rate_lag_s = 0.2f;             // of its yaw rate
};

// Following the committed plan (core/tracking).
struct TrackingParams {
  static constexpr int32_t kPurePursuit = 0;  // ignores the lags, for comparison
  static constexpr int32_t kLagAware = 1;
  int32_t method = kLagAware;
  float bandwidth_radps = 1.5f;       // of the feedback of position and heading, at most ...
  float settle_way_m = 0.6f;          // ... and at most the speed divided by this distance
  float speed_gain_per_s = 2.0f;      // change of the speed per speed error
  float turn_bandwidth_radps = 6.0f;  // of the yaw rate feedback within it
  float wheel_gain_per_s = 4.0f;      // change of the wheels' common speed per error in it
  float integral_rate_per_s = 0.5f;   // how fast a lasting yaw rate error is learned
  float max_cross_track_m = 2.0f;     // farther off its path the vehicle is brought to rest
  float lookahead_s = 0.5f;           // pure pursuit: look-ahead time ...
  float min_lookahead_m = 0.8f;       // ... and least look-ahead distance
  float heading_gain_per_s = 2.0f;    // turn on the spot: yaw rate per heading error
  float max_pivot_rate_radps = 0.8f;
};

// Assumed drift of a device's clock against ours (core/timebase/timebase.h).
struct ClockParams {
  float max_drift_ppm = 500.0f;  // the limit of a time server that slews a clock
  float max_drift_s = 0.02f;     // plus this in total, since the earliest datagram so far
};

// When the vehicle may move (core/safety/supervisor.h).
struct SafetyParams {
  float max_lidar_age_s = 0.3f;     // of the newest column
  float max_look_age_s = 0.42f;     // of the oldest look along the path (core/scan/sight_watch.h)
  float max_odometry_age_s = 0.1f;  // of the wheel speeds
  float max_ins_age_s = 0.2f;
  int32_t needs_ins = 1;            // 0: a silent INS does not stop the vehicle
  float max_plan_age_s = 1.0f;      // since the map was begun on which the plan was checked
  float operator_timeout_s = 3.0f;  // without a command or key press; 0: no operator required
  float max_stop_s = 8.0f;          // a safe stop that takes longer becomes zero speed
  float hard_age_factor = 3.0f;     // an age beyond this many times its limit: zero speed at once
  // The corridor that single returns are tested against (core/safety/corridor.h).
  float corridor_margin_m = 0.05f;  // beyond half the vehicle's width
  float sweep_margin_m = 0.05f;     // beyond the outline, during a stop (motion_sweep.h)
  // The final limits of a command (core/safety/command_gate.h).
  float max_wheel_acceleration_radps2 = 200.0f;
  // Of the body, now or soon (core/safety/tilt_watch.h); 0: no limit.
  float max_roll_rad = 0.45f;
  float max_pitch_rad = 0.5f;
  // Motion against command (core/safety/motion_watch.h).
  float motion_speed_margin_mps = 1.0f;
  float motion_yaw_margin_radps = 0.6f;
  float motion_time_s = 1.0f;  // beyond a margin for this long: a fault
  float stuck_time_s = 5.0f;   // commanded to move, but standing
  // Wheels faster than the INS's ground speed.
  float spin_speed_margin_mps = 1.0f;
  float spin_share = 0.25f;  // plus this share of the greater of both speeds
  float spin_time_s = 1.0f;  // for this long: a fault
  // Directions in which the vehicle itself blocks the lidar's view: anticlockwise from one angle of
  // the body frame to the other. Equal: none.
  float sight_mask_from_rad = 0.0f;
  float sight_mask_to_rad = 0.0f;
};

// The work of one tick (hal/onboard/vehicle_loop/vehicle_loop.h).
struct TickParams {
  int32_t period_ms = 10;
  int32_t planning_units = 4000;  // units of the stages, in every tick
  int32_t directions = 256;       // most lidar directions classed in a tick
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
