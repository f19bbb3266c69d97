// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "config/onboard_parameters.h"
#include "config/parameter_tables.h"

// The table of config/onboard_parameters.h, as config/parameter_tables.h is of planning.

namespace hardpack {

#define HP_ENTRY(group, type, member, ...) \
  MakeEntry(group "." #member, #member, &type::member, __VA_ARGS__)

#define HP_DRIVE(...) HP_ENTRY("drive", DriveParams, __VA_ARGS__)
inline constexpr std::array kDriveTable = {
    HP_DRIVE(left_node, 1.0f, 127.0f, "CANopen node of the left drive."),
    HP_DRIVE(right_node, 1.0f, 127.0f, "CANopen node of the right drive."),
    HP_DRIVE(master_node, 1.0f, 127.0f, "Our node: its heartbeat is what the drives watch."),
    HP_DRIVE(left_sign, -1.0f, 1.0f,
             "1: a positive motor speed drives the left side forward; -1: backward."),
    HP_DRIVE(right_sign, -1.0f, 1.0f, "The same on the right."),
    HP_DRIVE(gear_ratio, 0.1f, 500.0f, "Motor turns per wheel turn; not public: measure it."),
    HP_DRIVE(max_motor_speed_rpm, 1.0f, 20000.0f, "No command exceeds this."),
    HP_DRIVE(motor_acceleration_rpmps, 0.0f, 32767.0f,
             "Maximum acceleration rate (6083h) that is written; 0: left as it is."),
    HP_DRIVE(max_torque_permille, 1.0f, 1000.0f, "Torque limit in every command."),
    HP_DRIVE(operation_mode, 3.0f, 4.0f, "6060h: 3 profile velocity, 4 torque profile."),
    HP_DRIVE(command_period_ms, 10.0f, 100.0f, "Between two commands to a drive."),
    HP_DRIVE(sync_period_ms, 0.0f, 100.0f, "Between two SYNC of ours; 0: another node sends it."),
    HP_DRIVE(heartbeat_period_ms, 10.0f, 1000.0f, "Of our heartbeat, and of the drives'."),
    HP_DRIVE(heartbeat_timeout_ms, 20.0f, 3000.0f, "A node not heard for this long is gone."),
    HP_DRIVE(command_timeout_ms, 20.0f, 1000.0f,
             "A drive that gets no command for this long stops by itself (1400h:5, where it is)."),
    HP_DRIVE(command_timeout_scheme, 1.0f, 3.0f,
             "What it does then (5902h): 1 warn and slow down, 2 inhibit, 3 severe."),
    HP_DRIVE(feedback_timeout_ms, 20.0f, 1000.0f, "A reported speed older than this is none."),
    HP_DRIVE(max_frame_age_ms, 20.0f, 1000.0f,
             "What a drive sent longer ago than this is dropped, but for EMCY and restarts."),
    HP_DRIVE(sdo_timeout_ms, 10.0f, 2000.0f, "An answer to a question is waited for so long."),
    HP_DRIVE(sdo_retries, 0.0f, 10.0f, "And asked again so often."),
    HP_DRIVE(vendor_id, 0.0f, 16777216.0f, "1018h:1 that a drive has to have; 0: any."),
    HP_DRIVE(product_code, 0.0f, 2147483520.0f, "1018h:2 that a drive has to have; 0: any."),
    HP_DRIVE(login_user, 0.0f, 65535.0f, "5000h: user number for writing the configuration."),
    HP_DRIVE(login_password, 0.0f, 65535.0f, "5000h: the password."),
    HP_DRIVE(bit_rate_kbps, 20.0f, 1000.0f, "Bit rate of the bus, to compute its load."),
    HP_DRIVE(max_bus_load_percent, 1.0f, 90.0f, "Load of what we send and ask for, at most."),
    HP_DRIVE(opposite_speed_radps, 0.1f, 20.0f,
             "A wheel that turns against its command faster than this ..."),
    HP_DRIVE(opposite_time_s, 0.05f, 5.0f, "... for this long is a fault."),
    HP_DRIVE(standstill_radps, 0.01f, 5.0f, "Wheel speeds below this are standstill."),
    HP_DRIVE(disable_delay_s, 0.0f, 10.0f,
             "Standstill lasts this long before drives are disabled."),
    HP_DRIVE(enable_timeout_s, 0.1f, 30.0f, "Drives that are not enabled after this are faulty.")};
#undef HP_DRIVE

#define HP_TWIST(...) HP_ENTRY("twist_drive", TwistDriveParams, __VA_ARGS__)
inline constexpr std::array kTwistDriveTable = {
    HP_TWIST(turn, 0.0f, 1.0f,
             "What the controller is told of a turn, and measures: 0 the yaw rate; 1 the steering "
             "angle, with vehicle.kinematics 1."),
    HP_TWIST(command_id, 0.0f, 2047.0f, "CAN identifier of our commands."),
    HP_TWIST(feedback_id, 0.0f, 2047.0f, "CAN identifier of what the controller measures."),
    HP_TWIST(status_id, 0.0f, 2047.0f, "CAN identifier of what the controller says of itself."),
    HP_TWIST(feedback_timeout_ms, 20.0f, 1000.0f,
             "A measured motion older than this is none; while it is driven, a fault."),
    HP_TWIST(echo_timeout_ms, 20.0f, 1000.0f,
             "A controller that has taken no command for longer does not hear us: a fault."),
    HP_TWIST(standstill_mps, 0.001f, 0.2f, "Slower is standing."),
    HP_TWIST(disable_delay_s, 0.0f, 10.0f, "At standstill, before the controller is disabled."),
    HP_TWIST(enable_timeout_s, 0.1f, 60.0f,
             "From asking it to follow until it does; else a fault.")};
#undef HP_TWIST

#define HP_INS(...) HP_ENTRY("ins", InsParams, __VA_ARGS__)
inline constexpr std::array kInsTable = {
    HP_INS(yaw_rad, -3.1415927f, 3.1415927f,
           "How the INS is turned in the body frame, Rz(yaw) Ry(pitch) Rx(roll) with its x forward "
           "and its z down as in NED: yaw, anticlockwise seen from above."),
    HP_INS(pitch_rad, -1.5f, 1.5f, "The same: pitch."),
    HP_INS(roll_rad, -3.1415927f, 3.1415927f, "The same: roll.")};
#undef HP_INS

#define HP_ODOMETRY(...) HP_ENTRY("odometry", OdometryParams, __VA_ARGS__)
inline constexpr std::array kOdometryTable = {
    HP_ODOMETRY(ground_per_wheel, 0.5f, 1.5f,
                "Ground speed over wheel rim speed, straight on, to begin with; the default is the "
                "recorded one."),
    HP_ODOMETRY(max_rate_age_s, 0.005f, 1.0f,
                "A yaw rate of the INS that is older is not used: then the wheels tell it."),
    HP_ODOMETRY(max_lateness_s, 0.0f, 1.0f,
                "What comes later than this after newer measurements is not used."),
    HP_ODOMETRY(gate_sigma, 2.0f, 20.0f,
                "A measurement that is off by more standard deviations is rejected ..."),
    HP_ODOMETRY(gate_open_s, 0.05f, 10.0f, "... but not for longer than this."),
    HP_ODOMETRY(gyro_sigma_radps, 1.0e-4f, 0.5f, "Noise of the INS's angular rate, vibration too."),
    HP_ODOMETRY(gyro_bias_sigma_radps, 1.0e-5f, 0.2f, "Its bias, to begin with."),
    HP_ODOMETRY(gyro_bias_walk_radps, 1.0e-7f, 0.01f, "How the bias changes in a second."),
    HP_ODOMETRY(speed_walk_mps, 0.1f, 20.0f, "How the speed changes in a second."),
    HP_ODOMETRY(yaw_rate_walk_radps, 0.1f, 50.0f, "How the yaw rate changes in a second."),
    HP_ODOMETRY(wheel_sigma_mps, 0.001f, 1.0f, "Noise of a wheel's rim speed ..."),
    HP_ODOMETRY(wheel_slip_share, 0.0f, 0.5f, "... and besides, so much of that speed."),
    HP_ODOMETRY(
        wheel_lag_s, 0.0f, 2.0f,
        "Wheels slip while they gather speed or lose it: the vehicle is between their speed "
        "and what that was about this time ago, ..."),
    HP_ODOMETRY(wheel_lag_share, 0.0f, 2.0f,
                "... or so much of the way there: half of it is taken off, all of it is noise."),
    HP_ODOMETRY(wheel_scale_sigma, 0.001f, 0.3f, "Of ground_per_wheel, to begin with."),
    HP_ODOMETRY(wheel_scale_walk, 1.0e-6f, 0.1f, "How it changes in a second of driving."),
    HP_ODOMETRY(turn_slip_share, 0.01f, 1.0f,
                "Noise of the rim speeds' difference in a turn, as its share."),
    HP_ODOMETRY(baseline_sigma_m, 0.001f, 1.0f, "Of vehicle.skid_baseline_m, to begin with."),
    HP_ODOMETRY(baseline_walk_m, 1.0e-5f, 1.0f, "How it changes in a second of turning."),
    HP_ODOMETRY(min_turn_radps, 0.01f, 2.0f, "Slower turns do not tell the baseline."),
    HP_ODOMETRY(turning_point_m, 0.0f, 3.0f,
                "How far ahead of its middle, in the direction of driving, lies the point about "
                "which the vehicle turns at speed: its hind part swings out; recorded."),
    HP_ODOMETRY(turning_point_speed_mps, 0.01f, 20.0f,
                "The speed at which 0.7 of that is reached; recorded."),
    HP_ODOMETRY(ground_speed_sigma_mps, 0.01f, 5.0f, "Noise of the INS's speed over ground."),
    HP_ODOMETRY(min_ground_speed_mps, 0.1f, 10.0f, "A slower one does not tell the wheel scale."),
    HP_ODOMETRY(rest_wheel_radps, 0.001f, 1.0f, "Wheels slower than this stand."),
    HP_ODOMETRY(rest_time_s, 0.1f, 10.0f, "Wheels that stand for so long: the vehicle rests ..."),
    HP_ODOMETRY(rest_rate_radps, 0.001f, 0.5f,
                "... unless it turns faster than this; the gyro's bias is learned then."),
    HP_ODOMETRY(frozen_time_s, 0.2f, 30.0f,
                "A sensor that says the same to the bit for so long, while others say that it "
                "changed, is frozen.")};
#undef HP_ODOMETRY

#define HP_MAP(...) HP_ENTRY("map_from_odom", MapFromOdomParams, __VA_ARGS__)
inline constexpr std::array kMapFromOdomTable = {
    HP_MAP(gate_sigma, 2.0f, 20.0f,
           "A pose of the INS that is off by more standard deviations is rejected ..."),
    HP_MAP(persist_s, 0.5f, 120.0f, "... unless it stays there for so long."),
    HP_MAP(min_position_sigma_m, 0.01f, 20.0f,
           "The INS's positions are not taken to be better than this: their errors last."),
    HP_MAP(position_sigma_m, 0.01f, 50.0f, "Where it does not say how good they are."),
    HP_MAP(yaw_sigma_rad, 0.001f, 0.5f, "Of the INS's heading."),
    HP_MAP(drift_share, 0.0f, 0.5f, "What odom drifts by, as a share of the way."),
    HP_MAP(yaw_drift_radps, 1.0e-6f, 0.1f, "What its heading drifts by in a second."),
    HP_MAP(slew_mps, 0.01f, 10.0f, "The transform moves the vehicle's place by no more than this."),
    HP_MAP(slew_radps, 0.0005f, 1.0f, "And turns by no more than this."),
    HP_MAP(max_ins_age_s, 0.05f, 60.0f,
           "An older pose of the INS is none: the transform is kept, and no goal is taken in "
           "latitude and longitude.")};
#undef HP_MAP
#define HP_DYNAMICS(...) HP_ENTRY("dynamics", DynamicsParams, __VA_ARGS__)
inline constexpr std::array kDynamicsTable = {
    HP_DYNAMICS(dead_time_s, 0.0f, 0.5f,
                "From a command to the first change of the wheels; recorded: 0.13 to 0.15."),
    HP_DYNAMICS(common_lag_s, 0.05f, 3.0f,
                "First-order lag of the common wheel speed, half the sum of both sides; recorded."),
    HP_DYNAMICS(common_slew_radps2, 1.0f, 100.0f, "Largest change of it; recorded."),
    HP_DYNAMICS(differential_lag_s, 0.05f, 3.0f,
                "Lag of the differential wheel speed, half of right minus left; recorded."),
    HP_DYNAMICS(differential_slew_radps2, 1.0f, 100.0f, "Largest change of it; recorded."),
    HP_DYNAMICS(differential_limit_radps, 1.0f, 40.0f,
                "The differential wheel speed that no command exceeds, at rest ..."),
    HP_DYNAMICS(differential_limit_slope, 0.0f, 1.0f,
                "... and how much lower that is for each rad/s of the common one; recorded."),
    HP_DYNAMICS(scrub_radps, 0.0f, 10.0f,
                "What the tyres' sideways scrubbing takes of a differential command; recorded. 0: "
                "nothing."),
    HP_DYNAMICS(scrub_width_radps, 0.05f, 10.0f,
                "The differential wheel speed at which it is 0.7 of that; recorded."),
    HP_DYNAMICS(integral_time_s, 0.2f, 100.0f,
                "Of the drives' integral action, which makes up for it in the end; recorded."),
    HP_DYNAMICS(speed_lag_s, 0.0f, 2.0f,
                "First-order lag of the body's speed behind its wheels; recorded."),
    HP_DYNAMICS(yaw_rate_lag_s, 0.05f, 2.0f, "The same of its yaw rate; recorded.")};
#undef HP_DYNAMICS

#define HP_TRACKING(...) HP_ENTRY("tracking", TrackingParams, __VA_ARGS__)
inline constexpr std::array kTrackingTable = {
    HP_TRACKING(method, 0.0f, 1.0f,
                "0: pure pursuit, which knows nothing of the drives' lags, for comparison; 1: "
                "feed-forward and feedback through the model of the drives (dynamics)."),
    HP_TRACKING(
        bandwidth_radps, 0.2f, 6.0f,
        "Place and heading errors are brought back this fast (frequency of two poles), at most "
        "..."),
    HP_TRACKING(settle_way_m, 0.2f, 5.0f, "... and at most as fast as the speed over this way."),
    HP_TRACKING(speed_gain_per_s, 0.2f, 10.0f, "Change of the speed per speed error."),
    HP_TRACKING(turn_bandwidth_radps, 1.0f, 15.0f,
                "Yaw rate errors are brought back this fast (frequency of two poles)."),
    HP_TRACKING(wheel_gain_per_s, 0.2f, 20.0f,
                "Change of the wheels' common speed per error of it."),
    HP_TRACKING(integral_rate_per_s, 0.0f, 3.0f,
                "How fast a lasting error of the yaw rate is learned; 0: not at all."),
    HP_TRACKING(max_cross_track_m, 0.3f, 20.0f,
                "Further off its path than this the vehicle is brought to rest."),
    HP_TRACKING(lookahead_s, 0.05f, 3.0f,
                "Pure pursuit: the point that is aimed at lies this long ahead ..."),
    HP_TRACKING(min_lookahead_m, 0.2f, 10.0f, "... and at least so far."),
    HP_TRACKING(heading_gain_per_s, 0.1f, 10.0f, "Turns on the spot: yaw rate per heading error."),
    HP_TRACKING(max_pivot_rate_radps, 0.05f, 4.0f, "Turns on the spot: largest yaw rate.")};
#undef HP_TRACKING

#define HP_CLOCK(...) HP_ENTRY("clock", ClockParams, __VA_ARGS__)
inline constexpr std::array kClockTable = {
    HP_CLOCK(max_drift_ppm, 0.0f, 2000.0f,
             "A device's clock is followed when it falls behind ours by so much in a million ..."),
    HP_CLOCK(max_drift_s, 0.0f, 0.05f,
             "... and besides by this in sum. What comes later than that is late, not new.")};
#undef HP_CLOCK

#define HP_SAFETY(...) HP_ENTRY("safety", SafetyParams, __VA_ARGS__)
inline constexpr std::array kSafetyTable = {
    HP_SAFETY(max_lidar_age_s, 0.02f, 2.0f,
              "Age of the newest lidar column beyond which the vehicle stops."),
    HP_SAFETY(
        max_look_age_s, 0.05f, 2.0f,
        "The same of the lidar's oldest look along the way, over the vehicle's width. At least "
        "two revolutions of the lidar, or it is never fresh."),
    HP_SAFETY(max_odometry_age_s, 0.02f, 2.0f, "The same of the wheel speeds."),
    HP_SAFETY(max_ins_age_s, 0.02f, 2.0f, "The same of the INS."),
    HP_SAFETY(needs_ins, 0.0f, 1.0f, "1: a silent INS stops the vehicle; 0: it does not."),
    HP_SAFETY(max_plan_age_s, 0.1f, 10.0f,
              "The same of the map on which the committed plan was checked."),
    HP_SAFETY(operator_timeout_s, 0.0f, 60.0f,
              "The same of the operator's last command or press; 0: nobody has to be there."),
    HP_SAFETY(max_stop_s, 0.5f, 30.0f,
              "A safe stop along the path that takes longer becomes zero speed."),
    HP_SAFETY(hard_age_factor, 1.0f, 20.0f,
              "An age beyond this many times its limit: zero speed at once."),
    HP_SAFETY(corridor_margin_m, 0.0f, 0.5f,
              "Beyond half the vehicle's width a return so near to the path brakes at once. Not "
              "more than path.kept_margin_m: the plan that is driven is checked for that."),
    HP_SAFETY(
        sweep_margin_m, 0.0f, 0.5f,
        "The outline's margin while a stop is rolled out in every tick: a tenth of it at rest, "
        "all of it from 1.5 m/s on."),
    HP_SAFETY(max_wheel_acceleration_radps2, 1.0f, 2000.0f,
              "No wheel's command changes faster; zero for both goes out at once."),
    HP_SAFETY(motion_speed_margin_mps, 0.1f, 5.0f,
              "Wheels that are faster than commanded lately by more than this ..."),
    HP_SAFETY(motion_yaw_margin_radps, 0.1f, 5.0f,
              "... or a yaw rate of the INS that is off by more than this ..."),
    HP_SAFETY(motion_time_s, 0.1f, 10.0f, "... for this long are a fault."),
    HP_SAFETY(stuck_time_s, 0.5f, 60.0f,
              "Wheels that stand for this long although they are told to turn are a fault."),
    HP_SAFETY(spin_speed_margin_mps, 0.1f, 5.0f,
              "Wheels that are faster than the ground speed of the INS by more than this ..."),
    HP_SAFETY(spin_share, 0.0f, 1.0f, "... and so much of what they say ..."),
    HP_SAFETY(spin_time_s, 0.1f, 10.0f, "... for this long spin in place: a fault."),
    HP_SAFETY(sight_mask_from_rad, -3.15f, 3.15f,
              "From this direction of the body frame anticlockwise ..."),
    HP_SAFETY(sight_mask_to_rad, -3.15f, 3.15f,
              "... to this one the vehicle itself hides what is behind it from the lidar: no look "
              "is asked for there. The same: nowhere.")};
#undef HP_SAFETY

#define HP_TICK(...) HP_ENTRY("tick", TickParams, __VA_ARGS__)
inline constexpr std::array kTickTable = {
    HP_TICK(period_ms, 5.0f, 100.0f, "Between two ticks."),
    HP_TICK(planning_units, 64.0f, 1000000.0f,
            "Units of planning in every tick: fixed, so that a replay repeats."),
    HP_TICK(
        directions, 160.0f, 4096.0f,
        "Directions of the lidar that one tick classes at most, and columns that it takes. What a "
        "lidar sends in one period has to fit, or nothing starts.")};
#undef HP_TICK

#undef HP_ENTRY

static_assert(NamesAllMembers(kDriveTable));
static_assert(NamesAllMembers(kTwistDriveTable));
static_assert(NamesAllMembers(kInsTable));
static_assert(NamesAllMembers(kOdometryTable));
static_assert(NamesAllMembers(kMapFromOdomTable));
static_assert(NamesAllMembers(kClockTable));
static_assert(NamesAllMembers(kDynamicsTable));
static_assert(NamesAllMembers(kTrackingTable));
static_assert(NamesAllMembers(kSafetyTable));
static_assert(NamesAllMembers(kTickTable));

}  // namespace hardpack
