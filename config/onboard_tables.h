// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "config/onboard_parameters.h"
#include "config/parameter_tables.h"

// The table for config/onboard_parameters.h, as config/parameter_tables.h is for planning.

namespace hardpack {

#define HP_ENTRY(group, type, member, ...) \
  MakeEntry(group "." #member, #member, &type::member, __VA_ARGS__)

#define HP_DRIVE(...) HP_ENTRY("drive", DriveParams, __VA_ARGS__)
inline constexpr std::array kDriveTable = {
    HP_DRIVE(left_node, 1.0f, 127.0f, "CANopen node of the left drive."),
    HP_DRIVE(right_node, 1.0f, 127.0f, "CANopen node of the right drive."),
    HP_DRIVE(master_node, 1.0f, 127.0f, "Our node id; the drives monitor its heartbeat."),
    HP_DRIVE(left_sign, -1.0f, 1.0f,
             "1: a positive motor speed drives the left side forward; -1: backward."),
    HP_DRIVE(right_sign, -1.0f, 1.0f, "The same on the right."),
    HP_DRIVE(gear_ratio, 0.1f, 500.0f, "Motor turns per wheel turn; not public: measure it."),
    HP_DRIVE(max_motor_speed_rpm, 1.0f, 20000.0f, "Commands never exceed this."),
    HP_DRIVE(motor_acceleration_rpmps, 0.0f, 32767.0f,
             "Maximum acceleration rate (6083h) to write; 0: left unchanged."),
    HP_DRIVE(max_torque_permille, 1.0f, 1000.0f, "Torque limit in every command."),
    HP_DRIVE(operation_mode, 3.0f, 4.0f, "6060h: 3 profile velocity, 4 torque profile."),
    HP_DRIVE(command_period_ms, 10.0f, 100.0f, "Time between two commands to a drive."),
    HP_DRIVE(sync_period_ms, 0.0f, 100.0f,
             "Time between two of our SYNCs; 0: another node sends it."),
    HP_DRIVE(heartbeat_period_ms, 10.0f, 1000.0f, "Period of our heartbeat, and of the drives'."),
    HP_DRIVE(heartbeat_timeout_ms, 20.0f, 3000.0f,
             "A node not heard for this long counts as gone."),
    HP_DRIVE(command_timeout_ms, 20.0f, 1000.0f,
             "A drive that gets no command for this long stops on its own (1400h:5, if present)."),
    HP_DRIVE(command_timeout_scheme, 1.0f, 3.0f,
             "The drive's reaction to that (5902h): 1 warn and slow down, 2 inhibit, 3 severe."),
    HP_DRIVE(feedback_timeout_ms, 20.0f, 1000.0f,
             "A reported speed older than this counts as missing."),
    HP_DRIVE(
        max_frame_age_ms, 20.0f, 1000.0f,
        "Frames that a drive sent longer ago than this are dropped, except EMCY and restarts."),
    HP_DRIVE(sdo_timeout_ms, 10.0f, 2000.0f, "Time to wait for the answer to a request ..."),
    HP_DRIVE(sdo_retries, 0.0f, 10.0f, "... and number of retries."),
    HP_DRIVE(vendor_id, 0.0f, 16777216.0f, "1018h:1 that a drive must have; 0: any."),
    HP_DRIVE(product_code, 0.0f, 2147483520.0f, "1018h:2 that a drive must have; 0: any."),
    HP_DRIVE(login_user, 0.0f, 65535.0f, "5000h: user number for writing the configuration."),
    HP_DRIVE(login_password, 0.0f, 65535.0f, "5000h: the password."),
    HP_DRIVE(bit_rate_kbps, 20.0f, 1000.0f, "Bit rate of the bus, to compute its load."),
    HP_DRIVE(max_bus_load_percent, 1.0f, 90.0f,
             "Highest bus load of the frames that we send and request."),
    HP_DRIVE(opposite_speed_radps, 0.1f, 20.0f,
             "A wheel that turns against its command faster than this ..."),
    HP_DRIVE(opposite_time_s, 0.05f, 5.0f, "... for this long is a fault."),
    HP_DRIVE(standstill_radps, 0.01f, 5.0f, "Wheel speeds below this count as standstill."),
    HP_DRIVE(disable_delay_s, 0.0f, 10.0f, "Time at standstill before the drives are disabled."),
    HP_DRIVE(enable_timeout_s, 0.1f, 30.0f,
             "Drives that are not enabled after this time are faulty.")};
#undef HP_DRIVE

#define HP_TWIST(...) HP_ENTRY("twist_drive", TwistDriveParams, __VA_ARGS__)
inline constexpr std::array kTwistDriveTable = {
    HP_TWIST(turn, 0.0f, 1.0f,
             "How a turn is commanded to and reported by the controller: 0 yaw rate; 1 steering "
             "angle, with vehicle.kinematics 1."),
    HP_TWIST(command_id, 0.0f, 2047.0f, "CAN identifier of our commands."),
    HP_TWIST(feedback_id, 0.0f, 2047.0f, "CAN identifier of the controller's measurements."),
    HP_TWIST(status_id, 0.0f, 2047.0f, "CAN identifier of the controller's status."),
    HP_TWIST(feedback_timeout_ms, 20.0f, 1000.0f,
             "A measured motion older than this counts as missing; while driving, it is a fault."),
    HP_TWIST(echo_timeout_ms, 20.0f, 1000.0f,
             "A controller that has taken no command for longer does not receive them: a fault."),
    HP_TWIST(standstill_mps, 0.001f, 0.2f, "Speeds below this count as standstill."),
    HP_TWIST(disable_delay_s, 0.0f, 10.0f, "Time at standstill before the controller is disabled."),
    HP_TWIST(
        enable_timeout_s, 0.1f, 60.0f,
        "Longest time from requesting the controller to follow until it does; otherwise a fault.")};
#undef HP_TWIST

#define HP_INS(...) HP_ENTRY("ins", InsParams, __VA_ARGS__)
inline constexpr std::array kInsTable = {
    HP_INS(yaw_rad, -3.1415927f, 3.1415927f,
           "Orientation of the INS in the body frame, Rz(yaw) Ry(pitch) Rx(roll) with its x "
           "forward and its z down as in NED: yaw, anticlockwise seen from above."),
    HP_INS(pitch_rad, -1.5f, 1.5f, "The same: pitch."),
    HP_INS(roll_rad, -3.1415927f, 3.1415927f, "The same: roll.")};
#undef HP_INS

#define HP_ODOMETRY(...) HP_ENTRY("odometry", OdometryParams, __VA_ARGS__)
inline constexpr std::array kOdometryTable = {
    HP_ODOMETRY(ground_per_wheel, 0.5f, 1.5f,
                "Initial ratio of ground speed to wheel rim speed when driving straight; the "
                "default is recorded."),
    HP_ODOMETRY(
        max_rate_age_s, 0.005f, 1.0f,
        "A yaw rate of the INS older than this is not used; the wheels then give the yaw rate."),
    HP_ODOMETRY(max_lateness_s, 0.0f, 1.0f,
                "Measurements that arrive later than this after newer ones are not used."),
    HP_ODOMETRY(
        gate_sigma, 2.0f, 20.0f,
        "A measurement that is off by more than this many standard deviations is rejected ..."),
    HP_ODOMETRY(gate_open_s, 0.05f, 10.0f, "... but not for longer than this."),
    HP_ODOMETRY(gyro_sigma_radps, 1.0e-4f, 0.5f,
                "Noise of the INS's angular rate, including vibration."),
    HP_ODOMETRY(gyro_bias_sigma_radps, 1.0e-5f, 0.2f, "Initial uncertainty of its bias."),
    HP_ODOMETRY(gyro_bias_walk_radps, 1.0e-7f, 0.01f,
                "Change of the bias per second (random walk)."),
    HP_ODOMETRY(speed_walk_mps, 0.1f, 20.0f, "Change of the speed per second (random walk)."),
    HP_ODOMETRY(yaw_rate_walk_radps, 0.1f, 50.0f,
                "Change of the yaw rate per second (random walk)."),
    HP_ODOMETRY(wheel_sigma_mps, 0.001f, 1.0f, "Noise of a wheel's rim speed ..."),
    HP_ODOMETRY(wheel_slip_share, 0.0f, 0.5f, "... plus this share of that speed."),
    HP_ODOMETRY(wheel_lag_s, 0.0f, 2.0f,
                "Wheels slip while they accelerate or brake: the vehicle's speed lies between the "
                "wheels' present speed and their speed about this time ago, ..."),
    HP_ODOMETRY(
        wheel_lag_share, 0.0f, 2.0f,
        "... or this share of the way there: half of it is subtracted, all of it is noise."),
    HP_ODOMETRY(wheel_scale_sigma, 0.001f, 0.3f, "Initial uncertainty of ground_per_wheel."),
    HP_ODOMETRY(wheel_scale_walk, 1.0e-6f, 0.1f, "Its change per second of driving (random walk)."),
    HP_ODOMETRY(turn_slip_share, 0.01f, 1.0f,
                "Noise of the difference of the rim speeds in a turn, as a share of it."),
    HP_ODOMETRY(baseline_sigma_m, 0.001f, 1.0f, "Initial uncertainty of vehicle.skid_baseline_m."),
    HP_ODOMETRY(baseline_walk_m, 1.0e-5f, 1.0f, "Its change per second of turning (random walk)."),
    HP_ODOMETRY(min_turn_radps, 0.01f, 2.0f, "Slower turns are not used to learn the baseline."),
    HP_ODOMETRY(turning_point_m, 0.0f, 3.0f,
                "How far ahead of its centre, in the direction of driving, the vehicle turns at "
                "speed: its rear swings out; recorded."),
    HP_ODOMETRY(turning_point_speed_mps, 0.01f, 20.0f,
                "The speed at which 0.7 of that is reached; recorded."),
    HP_ODOMETRY(ground_speed_sigma_mps, 0.01f, 5.0f, "Noise of the INS's ground speed."),
    HP_ODOMETRY(min_ground_speed_mps, 0.1f, 10.0f,
                "Slower ground speeds are not used to learn the wheel scale."),
    HP_ODOMETRY(rest_wheel_radps, 0.001f, 1.0f, "Wheels slower than this count as standing."),
    HP_ODOMETRY(rest_time_s, 0.1f, 10.0f,
                "If the wheels stand for this long, the vehicle is at rest ..."),
    HP_ODOMETRY(rest_rate_radps, 0.001f, 0.5f,
                "... unless it turns faster than this; the gyro bias is learned then."),
    HP_ODOMETRY(frozen_time_s, 0.2f, 30.0f,
                "A sensor whose value is identical to the bit for this long, while others report a "
                "change, is frozen.")};
#undef HP_ODOMETRY

#define HP_MAP(...) HP_ENTRY("map_from_odom", MapFromOdomParams, __VA_ARGS__)
inline constexpr std::array kMapFromOdomTable = {
    HP_MAP(
        gate_sigma, 2.0f, 20.0f,
        "A pose of the INS that is off by more than this many standard deviations is rejected ..."),
    HP_MAP(persist_s, 0.5f, 120.0f, "... unless it stays there for this long."),
    HP_MAP(min_position_sigma_m, 0.01f, 20.0f,
           "Least uncertainty assumed for the INS's positions: their errors are correlated."),
    HP_MAP(position_sigma_m, 0.01f, 50.0f,
           "Uncertainty of a position if the INS does not report one."),
    HP_MAP(yaw_sigma_rad, 0.001f, 0.5f, "Uncertainty of the INS's heading."),
    HP_MAP(drift_share, 0.0f, 0.5f, "Drift of odom, as a share of the distance driven."),
    HP_MAP(yaw_drift_radps, 1.0e-6f, 0.1f, "Drift of its heading per second."),
    HP_MAP(slew_mps, 0.01f, 10.0f,
           "The transform moves the vehicle's position by no more than this ..."),
    HP_MAP(slew_radps, 0.0005f, 1.0f, "... and turns by no more than this."),
    HP_MAP(max_ins_age_s, 0.05f, 60.0f,
           "An older pose of the INS counts as missing: the transform is kept, and goals in "
           "latitude and longitude are refused.")};
#undef HP_MAP
#define HP_DYNAMICS(...) HP_ENTRY("dynamics", DynamicsParams, __VA_ARGS__)
inline constexpr std::array kDynamicsTable = {
    HP_DYNAMICS(dead_time_s, 0.0f, 0.5f,
                "From a command to the first change of the wheels; recorded: 0.13 to 0.15."),
    HP_DYNAMICS(common_lag_s, 0.05f, 3.0f,
                "First-order lag of the common wheel speed, half the sum of both sides; recorded."),
    HP_DYNAMICS(common_slew_radps2, 1.0f, 100.0f, "Its largest rate of change; recorded."),
    HP_DYNAMICS(differential_lag_s, 0.05f, 3.0f,
                "Lag of the differential wheel speed, half of right minus left; recorded."),
    HP_DYNAMICS(differential_slew_radps2, 1.0f, 100.0f, "Its largest rate of change; recorded."),
    HP_DYNAMICS(differential_limit_radps, 1.0f, 40.0f,
                "Highest differential wheel speed that any command achieves, at rest ..."),
    HP_DYNAMICS(differential_limit_slope, 0.0f, 1.0f,
                "... and its decrease for each rad/s of the common wheel speed; recorded."),
    HP_DYNAMICS(scrub_radps, 0.0f, 10.0f,
                "Loss of a differential command by tyre scrub; recorded. 0: none."),
    HP_DYNAMICS(scrub_width_radps, 0.05f, 10.0f,
                "The differential wheel speed at which the loss is 0.7 of that; recorded."),
    HP_DYNAMICS(
        integral_time_s, 0.2f, 100.0f,
        "Time of the drives' integral action, which eventually compensates for it; recorded."),
    HP_DYNAMICS(speed_lag_s, 0.0f, 2.0f,
                "First-order lag of the body's speed behind its wheels; recorded."),
    HP_DYNAMICS(yaw_rate_lag_s, 0.05f, 2.0f, "The same for its yaw rate; recorded.")};
#undef HP_DYNAMICS

#define HP_TRACKING(...) HP_ENTRY("tracking", TrackingParams, __VA_ARGS__)
inline constexpr std::array kTrackingTable = {
    HP_TRACKING(method, 0.0f, 1.0f,
                "0: pure pursuit, which ignores the drives' lags, for comparison; 1: feed-forward "
                "and feedback through the model of the drives (dynamics)."),
    HP_TRACKING(bandwidth_radps, 0.2f, 6.0f,
                "Bandwidth of the feedback on position and heading errors (frequency of two "
                "poles), at most ..."),
    HP_TRACKING(settle_way_m, 0.2f, 5.0f, "... and at most the speed divided by this distance."),
    HP_TRACKING(speed_gain_per_s, 0.2f, 10.0f, "Change of the speed per speed error."),
    HP_TRACKING(turn_bandwidth_radps, 1.0f, 15.0f,
                "Bandwidth of the feedback on yaw rate errors (frequency of two poles)."),
    HP_TRACKING(wheel_gain_per_s, 0.2f, 20.0f,
                "Change of the wheels' common speed per error in it."),
    HP_TRACKING(integral_rate_per_s, 0.0f, 3.0f,
                "How fast a lasting yaw rate error is learned; 0: not at all."),
    HP_TRACKING(max_cross_track_m, 0.3f, 20.0f,
                "Farther off its path than this, the vehicle is brought to rest."),
    HP_TRACKING(lookahead_s, 0.05f, 3.0f,
                "Pure pursuit: the look-ahead point is this time ahead ..."),
    HP_TRACKING(min_lookahead_m, 0.2f, 10.0f, "... and at least this distance."),
    HP_TRACKING(heading_gain_per_s, 0.1f, 10.0f, "Turns on the spot: yaw rate per heading error."),
    HP_TRACKING(max_pivot_rate_radps, 0.05f, 4.0f, "Turns on the spot: largest yaw rate.")};
#undef HP_TRACKING

#define HP_CLOCK(...) HP_ENTRY("clock", ClockParams, __VA_ARGS__)
inline constexpr std::array kClockTable = {
    HP_CLOCK(max_drift_ppm, 0.0f, 2000.0f,
             "A device's clock is followed when it falls behind ours by at most this rate ..."),
    HP_CLOCK(max_drift_s, 0.0f, 0.05f,
             "... plus this in total. Anything later than that is late, not new.")};
#undef HP_CLOCK

#define HP_SAFETY(...) HP_ENTRY("safety", SafetyParams, __VA_ARGS__)
inline constexpr std::array kSafetyTable = {
    HP_SAFETY(max_lidar_age_s, 0.02f, 2.0f,
              "Age of the newest lidar column beyond which the vehicle stops."),
    HP_SAFETY(max_look_age_s, 0.05f, 2.0f,
              "The same for the lidar's oldest look along the path, across the vehicle's width. At "
              "least two revolutions of the lidar, or it is never fresh."),
    HP_SAFETY(max_odometry_age_s, 0.02f, 2.0f, "The same for the wheel speeds."),
    HP_SAFETY(max_ins_age_s, 0.02f, 2.0f, "The same for the INS."),
    HP_SAFETY(needs_ins, 0.0f, 1.0f, "1: a silent INS stops the vehicle; 0: it does not."),
    HP_SAFETY(max_plan_age_s, 0.1f, 10.0f,
              "The same for the map on which the committed plan was checked."),
    HP_SAFETY(operator_timeout_s, 0.0f, 60.0f,
              "The same for the operator's last command or key press; 0: no operator required."),
    HP_SAFETY(max_stop_s, 0.5f, 30.0f,
              "A safe stop along the path that takes longer becomes zero speed."),
    HP_SAFETY(max_roll_rad, 0.0f, 1.5f,
              "A body that rolls further, or is about to, stops the vehicle, and keeps it from "
              "setting out; 0: none does. Friction of 0.5 ends at 0.46."),
    HP_SAFETY(max_pitch_rad, 0.0f, 1.5f, "The same for its pitch."),
    HP_SAFETY(hard_age_factor, 1.0f, 20.0f,
              "An age beyond this many times its limit: zero speed at once."),
    HP_SAFETY(corridor_margin_m, 0.0f, 0.5f,
              "Corridor beyond half the vehicle's width: a return this close to the path brakes at "
              "once. At most path.kept_margin_m: the plan being driven is checked for that."),
    HP_SAFETY(sweep_margin_m, 0.0f, 0.5f,
              "Margin of the outline when a stop is rolled out in every tick: a tenth of it at "
              "rest, all of it from 1.5 m/s on."),
    HP_SAFETY(max_wheel_acceleration_radps2, 1.0f, 2000.0f,
              "Largest change of a wheel's command; zero for both is sent at once."),
    HP_SAFETY(motion_speed_margin_mps, 0.1f, 5.0f,
              "Wheels that are faster than recently commanded by more than this ..."),
    HP_SAFETY(motion_yaw_margin_radps, 0.1f, 5.0f,
              "... or a yaw rate of the INS that is off by more than this ..."),
    HP_SAFETY(motion_time_s, 0.1f, 10.0f, "... for this long are a fault."),
    HP_SAFETY(stuck_time_s, 0.5f, 60.0f,
              "Wheels that stand for this long although they are commanded to turn are a fault."),
    HP_SAFETY(spin_speed_margin_mps, 0.1f, 5.0f,
              "Wheels that are faster than the INS's ground speed by more than this ..."),
    HP_SAFETY(spin_share, 0.0f, 1.0f, "... plus this share of the greater of both speeds ..."),
    HP_SAFETY(spin_time_s, 0.1f, 10.0f, "... for this long are spinning in place: a fault."),
    HP_SAFETY(sight_mask_from_rad, -3.15f, 3.15f,
              "From this direction of the body frame anticlockwise ..."),
    HP_SAFETY(sight_mask_to_rad, -3.15f, 3.15f,
              "... to this one, the vehicle itself blocks the lidar's view: no look is expected "
              "there. Equal values: nowhere.")};
#undef HP_SAFETY

#define HP_TICK(...) HP_ENTRY("tick", TickParams, __VA_ARGS__)
inline constexpr std::array kTickTable = {
    HP_TICK(period_ms, 5.0f, 100.0f, "Time between two ticks."),
    HP_TICK(planning_units, 64.0f, 1000000.0f,
            "Units of planning in every tick: fixed, so that a replay is reproducible."),
    HP_TICK(directions, 160.0f, 4096.0f,
            "Largest number of lidar directions that one tick classifies, and of columns that it "
            "takes. A lidar whose data of one period does not fit is refused at the start.")};
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
