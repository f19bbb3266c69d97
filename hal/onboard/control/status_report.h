// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "hal/can_bus.h"
#include "hal/datagram_socket.h"
#include "hal/onboard/control/messages.h"
#include "hal/recorder.h"

// Everything that an operator may want to see of the onboard program, as plain numbers: what the
// port fills in once it is asked, and an operator's program shows. Codes are the numbers of enums
// that this stage does not know (each names its own); counters have the names that they have where
// they are counted. hal/onboard/control/status_table.h says what each field is; encoding, decoding
// and every way of showing a report go by that one table.

namespace hardpack::control {

// How long ago something was, and how long it may be.
struct Age {
  static constexpr uint64_t kNever = UINT64_MAX;
  uint64_t age_ns = kNever;
  uint64_t limit_ns = 0;  // 0: there is none
  constexpr bool operator==(const Age&) const = default;
};

// The age at now_ns of what was at then_ns; 0 there: it never was. The future is age 0.
constexpr Age AgeAt(uint64_t now_ns, uint64_t then_ns, uint64_t limit_ns = 0) {
  if (then_ns == 0) return {Age::kNever, limit_ns};
  return {then_ns < now_ns ? now_ns - then_ns : 0, limit_ns};
}

inline constexpr int kTextBytes = 32;

struct ProgramPart {
  char version[kTextBytes] = {};  // printable ASCII, ended by a zero; so is the next one
  char vehicle[kTextBytes] = {};  // its type
  uint64_t uptime_ns = 0;         // since the first tick
  uint64_t tick_index = 0;
  uint64_t missed_ticks = 0;
  uint64_t dropped_datagrams = 0;   // that had waited for too long to be told as new
  uint64_t last_missed_tick = 0;    // index of the newest one ...
  uint64_t last_miss_late_ns = 0;   // ... and by how much the tick after it was late
  uint64_t worst_late_ns = 0;       // a tick began after it was due
  uint64_t worst_tick_ns = 0;       // from a tick's begin to its end
  uint64_t worst_tick_index = 0;    // that one
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
  Age stop_reason_age;      // since when stop_reason is what it is
  float x_m = 0.0f;         // pose, odom
  float y_m = 0.0f;
  float yaw_rad = 0.0f;
  float speed_mps = 0.0f;
  float yaw_rate_radps = 0.0f;
  bool uses_ins_rate = false;
  uint32_t odometry_gaps = 0;
  float commanded_speed_mps = 0.0f;
  float commanded_yaw_rate_radps = 0.0f;
  // What its drives say together, whatever drives they are.
  bool drives_ready = false;
  bool drives_enabled = false;
  bool drives_faulty = false;
  bool drives_off = false;  // none can push
};

// The filter, and where odom lies on earth.
struct OdometryPart {
  float position_sigma_m = 0.0f;  // since the start, the larger one of x and y
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

// Age of the newest of each.
struct AgePart {
  Age lidar_age;
  Age ins_age;
  Age odometry_age;
  Age operator_age;
};

struct GoalPart {
  uint32_t goals = 0;       // given; 0: there is none
  uint32_t goal_index = 0;  // the one that is driven to, from 0
  float goal_x_m = 0.0f;    // of that one, odom
  float goal_y_m = 0.0f;
  float distance_to_goal_m = 0.0f;  // straight
};

struct PlanPart {
  uint8_t decision = 0;     // ReplanDecision
  uint8_t reason = 0;       // ReplanReason
  uint8_t status = 0;       // Status, of the last round
  uint8_t plan_status = 0;  // Status, of the last new plan
  // Of the committed plan.
  uint32_t number = 0;  // 0: there is none
  Age check_age;        // of the map on which it was checked
  float distance_to_end_m = 0.0f;
  bool reaches_goal = false;
  bool is_stop = false;
  bool narrow = false;
};

// What is looked after besides planning (core/safety).
struct SafetyPart {
  bool obstacle_ahead = false;       // a return in the corridor of the committed path ...
  bool person_ahead = false;         // ... of a person
  float obstacle_distance_m = 0.0f;  // along the path from the vehicle's middle; 0: none
  // The reaction radius (core/safety/reaction_meter.h): from a column's stamp to the first
  // command whose path knows it, and that time times the speed. 1e6: never.
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
  float position_uncertainty_m = 0.0f;  // 0: not told
};

// The parts of devices: `present` where the vehicle has such a device.
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
  uint8_t nmt_state = 0xff;  // CiA 301; ff: not heard
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
  uint16_t controller_faults = 0;  // bits of its own
  float battery_V = 0.0f;
  int32_t temperature_degC = 0;
  uint32_t frames_repeated = 0;
  uint32_t frames_missed = 0;
};

struct CanPart {
  uint8_t state = 0;              // CanBusState
  uint32_t bus_load_percent = 0;  // of what we send and ask for, as configured
  CanBusCounters bus;
  // What the drives took of it.
  uint32_t frames_taken = 0;
  uint32_t frames_ignored = 0;
  uint32_t frames_malformed = 0;
  uint32_t foreign_frames = 0;
  uint32_t frames_old = 0;
};

// Of any lidar; what its packets cannot have wrong stays 0.
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
  int64_t offset_ns = 0;  // smallest host minus device; 0 before it has started
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
  uint64_t refused_ticks = 0;  // input that no tick can have: time or index ran backwards
  uint64_t datagrams[kInputSourceCount] = {};
  uint64_t refused_datagrams[kInputSourceCount] = {};
  uint64_t refused_columns = 0;  // those beyond a tick's directions among them
  uint64_t suspect_columns = 0;  // dropped while the lidar's clock was not to be relied upon
  uint64_t lidar_restarts = 0;
  uint64_t clock_jumps = 0;     // of the lidar
  uint64_t untimed_ins = 0;     // INS messages dropped while its clock was not to be relied upon
  uint64_t odometry_gaps = 0;   // pauses that odometry does not bridge: the map began anew
  uint64_t odometry_jumps = 0;  // steps that no vehicle makes: the same
  uint64_t refused_labels = 0;  // columns of labels that the map has no use for any more
  uint64_t commands = 0;
  uint64_t refused_commands = 0;
  uint64_t plans = 0;           // rounds of planning that were judged
  uint64_t refused_states = 0;  // that the planner would not take
};

// What came over the control socket. The port counts it.
struct ControlCounters {
  uint64_t clients = 0;        // connections taken, in all
  uint64_t connected = 0;      // of these, now
  uint64_t turned_away = 0;    // connections for which there was no place
  uint64_t displaced = 0;      // clients whose place was given to another
  uint64_t messages = 0;       // given by Receive
  uint64_t not_permitted = 0;  // commands of those who may not command
  uint64_t malformed = 0;      // messages that are none, and what does not go over such a socket
  uint64_t dropped_slow = 0;   // clients that did not take their answers
  uint64_t system_errors = 0;  // refusals of the operating system
};

// Where the lidar looks (core/scan/sight_watch.h). Parts of the circle: 0 begins straight behind,
// anticlockwise, so that 7 and 8 are ahead.
struct SightPart {
  static constexpr int kParts = 16;
  Age look_age;              // of the oldest look along the way
  uint32_t sectors = 0;      // around the vehicle
  uint32_t old_sectors = 0;  // of them, not looked along lately
  uint32_t covered_sectors = 0;
  uint32_t frozen_sectors = 0;
  bool lidar_turned = false;  // in its mount
  float ground_tilt_rad = 0.0f;
  uint64_t revolution_ns = 0;
  uint16_t columns_permille[kParts] = {};  // that came, of those expected
  uint16_t returns_permille[kParts] = {};  // of beams that would meet the ground near by
};

struct StatusReport {
  ProgramPart program;
  VehiclePart vehicle;
  OdometryPart odometry;
  AgePart inputs;
  GoalPart goal;
  PlanPart plan;
  SafetyPart safety;
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

// Writes the answer to a kGetStatus of that number and sets `size_bytes`. kCapacityExceeded: the
// buffer is too small; kInvalidArgument: the version or the vehicle is no text. Then nothing is
// written, and size_bytes is 0. Cost: one pass over the fields.
Status Encode(const StatusReport& report, uint32_t sequence, std::span<uint8_t> buffer,
              int& size_bytes);

// Reads such an answer. The statuses of ReadHeader; kWrongPacketType: another kind of message;
// kUnsupported: of a program with another table of fields; kTruncated, kOversized: not of the
// table's size; kInvalidArgument: a flag that is neither 0 nor 1, a text that is none. Then
// `report` is untouched. Other numbers are taken as they are, those that are not finite too.
Status Decode(std::span<const uint8_t> message, StatusReport& report);

}  // namespace hardpack::control
