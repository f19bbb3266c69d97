// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "hal/can_bus.h"
#include "hal/datagram_socket.h"
#include "hal/onboard/control/messages.h"
#include "hal/recorder.h"

// Everything that an operator may want to see of the onboard program, as plain numbers: the port
// fills it in on request, and an operator's program shows it. Codes are the numbers of enums that
// this stage does not know (each field names its enum); counters have the same names as where they
// are counted. hal/onboard/control/status_table.h describes each field; encoding, decoding and all
// display of a report use that one table.

namespace hardpack::control {

// How long ago something happened, and the limit for that.
struct Age {
  static constexpr uint64_t kNever = UINT64_MAX;
  uint64_t age_ns = kNever;
  uint64_t limit_ns = 0;  // 0: no limit
  constexpr bool operator==(const Age&) const = default;
};

// The age at now_ns of what happened at then_ns; then_ns 0: it never happened. A time in the future
// gives age 0.
constexpr Age AgeAt(uint64_t now_ns, uint64_t then_ns, uint64_t limit_ns = 0) {
  if (then_ns == 0) return {Age::kNever, limit_ns};
  return {then_ns < now_ns ? now_ns - then_ns : 0, limit_ns};
}

inline constexpr int kTextBytes = 32;

struct ProgramPart {
  char version[kTextBytes] = {};  // printable ASCII, zero-terminated, like the next one
  char vehicle[kTextBytes] = {};  // its type
  uint64_t uptime_ns = 0;         // since the first tick
  uint64_t tick_index = 0;
  uint64_t missed_ticks = 0;
  uint64_t dropped_datagrams = 0;   // had waited too long to count as new
  uint64_t last_missed_tick = 0;    // index of the newest one ...
  uint64_t last_miss_late_ns = 0;   // ... and by how much the tick after it was late
  uint64_t worst_late_ns = 0;       // largest delay of the start of a tick
  uint64_t worst_tick_ns = 0;       // longest duration of a tick
  uint64_t worst_tick_index = 0;    // index of that tick
  uint64_t heap_allocations = 0;    // since the first tick
  bool realtime_scheduled = false;  // SCHED_FIFO
  bool memory_locked = false;
  uint64_t watchdog_fed = 0;
  uint64_t decision_hash = 0;
};

struct VehiclePart {
  uint8_t mode = 0;         // Mode
  uint8_t stop_reason = 0;  // StopReason
  uint8_t last_stop = 0;    // StopReason
  uint8_t motion = 0;       // Motion
  Age stop_reason_age;      // time since stop_reason last changed
  float x_m = 0.0f;         // pose, odom
  float y_m = 0.0f;
  float yaw_rad = 0.0f;
  float speed_mps = 0.0f;
  float yaw_rate_radps = 0.0f;
  bool uses_ins_rate = false;
  uint32_t odometry_gaps = 0;
  float commanded_speed_mps = 0.0f;
  float commanded_yaw_rate_radps = 0.0f;
  // The state of its drives as a whole, whatever their kind.
  bool drives_ready = false;
  bool drives_enabled = false;
  bool drives_faulty = false;
  bool drives_off = false;  // none can produce torque
};

// The filter, and the position of odom on earth.
struct OdometryPart {
  float position_sigma_m = 0.0f;  // since the start, the larger of x and y
  float yaw_sigma_rad = 0.0f;
  float driven_m = 0.0f;
  bool at_rest = false;
  float gyro_bias_radps = 0.0f;
  float gyro_bias_sigma_radps = 0.0f;
  float wheel_scale = 0.0f;  // ground speed over rim speed
  float wheel_scale_sigma = 0.0f;
  float skid_baseline_m = 0.0f;
  float skid_baseline_sigma_m = 0.0f;
  uint32_t gyro_rejected = 0;
  uint32_t wheel_speed_rejected = 0;
  uint32_t wheel_turn_rejected = 0;
  uint32_t ground_speed_rejected = 0;
  uint32_t reopened = 0;
  uint32_t late = 0;
  uint32_t too_late = 0;
  uint32_t repeated = 0;
  uint32_t refused = 0;
  uint32_t gyro_frozen = 0;
  uint32_t wheels_frozen = 0;
  uint32_t restarts = 0;
  uint8_t map_status = 0;  // MapStatus
  float map_x_m = 0.0f;    // of odom's origin, east and north of map's
  float map_y_m = 0.0f;
  float map_yaw_rad = 0.0f;           // of odom's x axis, anticlockwise from east
  float map_position_sigma_m = 0.0f;  // at the vehicle
  float map_yaw_sigma_rad = 0.0f;
  uint32_t map_taken = 0;
  uint32_t map_rejected = 0;
  uint32_t map_relocations = 0;
};

// Age of the newest input of each kind.
struct AgePart {
  Age lidar_age;
  Age ins_age;
  Age odometry_age;
  Age operator_age;
};

struct GoalPart {
  uint32_t goals = 0;       // given; 0: none
  uint32_t goal_index = 0;  // of the current goal, from 0
  float goal_x_m = 0.0f;    // of the current goal, odom
  float goal_y_m = 0.0f;
  float distance_to_goal_m = 0.0f;  // straight line
  bool paused = false;              // by the operator
  bool at_waypoint = false;         // holds there, as the mission says
  bool may_resume = false;          // a stopped mission, which a resume continues
};

struct PlanPart {
  uint8_t decision = 0;     // ReplanDecision
  uint8_t reason = 0;       // ReplanReason
  uint8_t status = 0;       // Status, of the last round
  uint8_t plan_status = 0;  // Status, of the last new plan
  // Of the committed plan.
  uint32_t number = 0;  // 0: no plan
  Age check_age;        // of the map on which it was checked
  float distance_to_end_m = 0.0f;
  bool reaches_goal = false;
  bool is_stop = false;
  bool narrow = false;
};

// What is monitored besides planning (core/safety).
struct SafetyPart {
  bool obstacle_ahead = false;       // a return in the corridor of the committed path ...
  bool person_ahead = false;         // ... of a person
  float obstacle_distance_m = 0.0f;  // along the path from the vehicle's middle; 0: none
  // The reaction radius (core/safety/reaction_meter.h): the time from a column's stamp to the first
  // command whose path takes it into account, and that time times the speed. 1e6: never.
  float reaction_median_s = 0.0f;
  float reaction_p99_s = 0.0f;
  float reaction_median_m = 0.0f;
  float reaction_p99_m = 0.0f;
  uint32_t reaction_columns = 0;
  uint32_t reaction_lost = 0;  // of these, never in any map
  // Commands at the gate (core/safety/command_gate.h).
  uint32_t commands_not_finite = 0;
  uint32_t commands_not_permitted = 0;
  uint32_t commands_above_speed = 0;
  uint32_t commands_above_change = 0;
};

// The areas (core/areas): the configured ones first, then the operator's.
struct AreasPart {
  uint32_t areas = 0;
  uint32_t configured = 0;     // of these, from the configuration
  uint32_t expected = 0;       // of the operator, announced
  bool unknown = false;        // not all have arrived, or one on earth has no place: no driving
  bool breached = false;       // the vehicle is where an area forbids it
  uint32_t breached_area = 0;  // the first such, counted from 1; 0: none
};

inline constexpr int kReplanReasonCount = 8;

struct ReplanPart {
  uint32_t plans = 0;
  uint32_t kept = 0;
  uint32_t extended = 0;
  uint32_t replaced[kReplanReasonCount] = {};  // by ReplanReason
  uint32_t stopped = 0;
  uint32_t failed = 0;
  uint32_t reanchored = 0;
  uint32_t late = 0;
  uint32_t refused = 0;
};

struct InsPart {
  uint8_t mode = 0;  // InsMode
  bool gnss_fix = false;
  bool time_error = false;
  bool imu_error = false;
  bool magnetometer_or_pressure_error = false;
  bool gnss_error = false;
  bool has_position = false;
  int64_t latitude_ndeg = 0;
  int64_t longitude_ndeg = 0;
  float position_uncertainty_m = 0.0f;  // 0: not reported
};

// The parts of devices: `present` if the vehicle has such a device.
struct InsStreamPart {
  bool present = false;
  uint64_t bytes = 0;
  uint64_t skipped_bytes = 0;
  uint64_t binary_messages = 0;
  uint64_t ascii_messages = 0;
  uint64_t samples = 0;
  uint64_t unused = 0;
  uint64_t not_finite = 0;
  uint64_t out_of_range = 0;
  uint64_t bad_checksum = 0;
  uint64_t unsupported = 0;
};

struct PoseDatagramPart {
  bool present = false;
  uint64_t bytes = 0;
  uint64_t skipped_bytes = 0;
  uint64_t samples = 0;
  uint64_t refused = 0;
  uint64_t repeated = 0;
  uint64_t missed = 0;
  uint64_t restarts = 0;
  uint64_t bad_crc = 0;
};

struct DrivePart {
  bool present = false;
  uint8_t state = 0;         // sevcon::DriveState
  uint8_t fault = 0;         // sevcon::DriveFault
  uint8_t nmt_state = 0xff;  // CiA 301; ff: none received
  uint16_t statusword = 0;
  uint16_t emergency_code = 0;
  uint8_t emergency_register = 0;
  uint16_t sevcon_fault_id = 0;
  uint32_t sdo_abort_code = 0;
  uint16_t sdo_index = 0;
  uint16_t sdo_abort_reason = 0;
  float wheel_radps = 0.0f;
  Age wheel_age;
  float torque_share = 0.0f;
  bool has_supply = false;
  float battery_V = 0.0f;
  float battery_A = 0.0f;
  float capacitor_V = 0.0f;
  int32_t heatsink_degC = 0;
  uint32_t emergencies = 0;
  uint32_t reboots = 0;
  uint32_t sdo_timeouts = 0;
  uint32_t sdo_aborts = 0;
  uint32_t heartbeats_missed = 0;
  uint32_t doubled_reports = 0;
};

// A motion controller (hal/twist_drive).
struct MotionControllerPart {
  bool present = false;
  uint8_t state = 0;  // twist_drive::ControllerState
  uint8_t fault = 0;  // twist_drive::Fault
  float speed_mps = 0.0f;
  float yaw_rate_radps = 0.0f;
  Age feedback_age;
  uint16_t controller_faults = 0;  // bits defined by the controller
  float battery_V = 0.0f;
  int32_t temperature_degC = 0;
  uint32_t frames_repeated = 0;
  uint32_t frames_missed = 0;
};

struct CanPart {
  uint8_t state = 0;              // CanBusState
  uint32_t bus_load_percent = 0;  // from what we send and request, as configured
  CanBusCounters bus;
  // How the drives handled the frames.
  uint32_t frames_taken = 0;
  uint32_t frames_ignored = 0;
  uint32_t frames_malformed = 0;
  uint32_t foreign_frames = 0;
  uint32_t frames_old = 0;
};

// For any lidar; counters of errors that its packets cannot have stay 0.
struct LidarPacketPart {
  uint64_t accepted = 0;
  uint64_t wrong_size = 0;
  uint64_t wrong_type = 0;
  uint64_t bad_crc = 0;
  uint64_t wrong_sensor = 0;
  uint64_t not_resumed = 0;
  uint64_t before_start = 0;
  uint64_t duplicates = 0;
  uint64_t restarts = 0;
  uint64_t out_of_order = 0;
  uint64_t missing = 0;
  uint64_t jumps = 0;
  uint64_t unplaced = 0;
  uint64_t wrong_mode = 0;
  uint64_t wrong_rate = 0;
  uint64_t bad_azimuth = 0;
  uint64_t bad_time = 0;
};

struct LidarClockPart {
  bool started = false;
  bool suspect = false;
  int64_t offset_ns = 0;  // smallest difference host minus device; 0 before the start
  uint32_t observations = 0;
  uint32_t jumps = 0;
  uint32_t late = 0;
  uint32_t beyond_drift = 0;
  uint32_t refused = 0;
};

struct MapperPart {
  uint32_t columns_without_pose = 0;
  uint32_t columns_over_limit = 0;
  uint32_t folded_with_labels = 0;
  uint32_t folded_without_labels = 0;
  uint32_t folded_early = 0;
  uint32_t late_unclassed_columns = 0;
  uint32_t returns_off_map = 0;
  uint32_t overhead_returns = 0;
  uint32_t height_jumps = 0;
  uint32_t position_jumps = 0;
  uint32_t sensor_restarts = 0;
};

inline constexpr int kInputSourceCount = 3;  // INS, labels, lidar

struct LoopPart {
  uint64_t ticks = 0;
  uint64_t missed_ticks = 0;   // gaps of the index
  uint64_t refused_ticks = 0;  // impossible input: time or index ran backwards
  uint64_t datagrams[kInputSourceCount] = {};
  uint64_t refused_datagrams[kInputSourceCount] = {};
  uint64_t refused_columns = 0;  // including those beyond a tick's directions
  uint64_t suspect_columns = 0;  // dropped while the lidar's clock was unreliable
  uint64_t lidar_restarts = 0;
  uint64_t clock_jumps = 0;     // of the lidar
  uint64_t untimed_ins = 0;     // INS messages dropped while its clock was unreliable
  uint64_t odometry_gaps = 0;   // pauses that odometry does not bridge: the map was restarted
  uint64_t odometry_jumps = 0;  // steps that no vehicle can make: the map was restarted
  uint64_t refused_labels = 0;  // label columns that the map can no longer use
  uint64_t commands = 0;
  uint64_t refused_commands = 0;
  uint64_t plans = 0;           // planning rounds that were judged
  uint64_t refused_states = 0;  // not accepted by the planner
};

// Traffic on the control socket, counted by the port.
struct ControlCounters {
  uint64_t clients = 0;        // connections accepted, in total
  uint64_t connected = 0;      // of these, now
  uint64_t turned_away = 0;    // connections refused for lack of a free place
  uint64_t displaced = 0;      // clients whose place was given to another
  uint64_t messages = 0;       // returned by Receive
  uint64_t not_permitted = 0;  // commands from clients without permission
  uint64_t malformed = 0;      // invalid messages, and data that such a socket does not carry
  uint64_t dropped_slow = 0;   // clients that did not read their answers
  uint64_t system_errors = 0;  // refusals of the operating system
};

// Where the lidar looks (core/scan/sight_watch.h). Parts of the circle: 0 begins straight behind,
// counting anticlockwise, so 7 and 8 are ahead.
struct SightPart {
  static constexpr int kParts = 16;
  Age look_age;              // of the oldest look along the path
  uint32_t sectors = 0;      // around the vehicle
  uint32_t old_sectors = 0;  // of these, not looked along recently
  uint32_t covered_sectors = 0;
  uint32_t frozen_sectors = 0;
  bool lidar_turned = false;  // in its mount
  float ground_tilt_rad = 0.0f;
  uint64_t revolution_ns = 0;
  uint16_t columns_permille[kParts] = {};  // received, of those expected
  uint16_t returns_permille[kParts] = {};  // of beams that would hit the ground nearby
};

struct StatusReport {
  ProgramPart program;
  VehiclePart vehicle;
  OdometryPart odometry;
  AgePart inputs;
  GoalPart goal;
  PlanPart plan;
  SafetyPart safety;
  AreasPart areas;
  SightPart sight;
  InsPart ins;
  DrivePart left_drive;
  DrivePart right_drive;
  MotionControllerPart motion_controller;
  CanPart can;
  LidarPacketPart lidar_packets;
  LidarClockPart lidar_clock;
  MapperPart mapper;
  InsStreamPart ins_stream;
  PoseDatagramPart pose_datagrams;
  DatagramCounters lidar_socket;
  DatagramCounters ins_socket;
  DatagramCounters label_socket;
  LoopPart loop;
  ReplanPart replan;
  RecorderCounters recorder;
  ControlCounters control;
};
static_assert(std::is_trivially_copyable_v<StatusReport>);

// Writes the answer to the kGetStatus with that sequence number and sets `size_bytes`.
// kCapacityExceeded: the buffer is too small; kInvalidArgument: the version or the vehicle is not
// valid text. On failure nothing is written, and size_bytes is 0. Cost: one pass over the fields.
Status Encode(const StatusReport& report, uint32_t sequence, std::span<uint8_t> buffer,
              int& size_bytes);

// Reads such an answer. The statuses of ReadHeader; kWrongPacketType: another kind of message;
// kUnsupported: from a program with another table of fields; kTruncated, kOversized: not the
// table's size; kInvalidArgument: a flag that is neither 0 nor 1, an invalid text. On failure
// `report` is untouched. Other numbers are taken as they are, even if not finite.
Status Decode(std::span<const uint8_t> message, StatusReport& report);

}  // namespace hardpack::control
