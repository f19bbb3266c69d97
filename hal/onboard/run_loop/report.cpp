// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/path/path.h"
#include "hal/onboard/run_loop/run_loop.h"

// RunLoop: what an operator sees. Copies, field by field, from where each thing is known.

namespace hardpack {
namespace {

constexpr control::StatusReport kNothing;  // 2 KiB: not on the stack

// To the microsecond: of parameters, which are at most some minutes.
uint64_t InNanoseconds(float seconds) {
  constexpr uint64_t kNanosecondsPerMicrosecond = 1000;
  const int32_t microseconds = RoundToInt(Max(seconds, 0.0f) * 1.0e6f);
  return static_cast<uint64_t>(microseconds) * kNanosecondsPerMicrosecond;
}

template <typename From, typename To, size_t kSize>
void Copy(const From (&from)[kSize], To (&to)[kSize]) {
  HP_LOOP_BOUND(kSize)
  for (size_t i = 0; i < kSize; ++i) to[i] = from[i];
}

void Fill(const VehicleLoop& loop, control::VehiclePart& part) {
  const Permission& permission = loop.permission();
  part.mode = static_cast<uint8_t>(permission.mode);
  part.stop_reason = static_cast<uint8_t>(permission.reason);
  part.last_stop = static_cast<uint8_t>(loop.supervisor().last_stop());
  part.motion = static_cast<uint8_t>(permission.motion);
  const Odometry& odometry = loop.odometry();
  part.stop_reason_age = control::AgeAt(loop.now_ns(), permission.reason_since_ns);
  part.x_m = odometry.pose().position.x_m;
  part.y_m = odometry.pose().position.y_m;
  part.yaw_rad = odometry.pose().yaw_rad;
  part.speed_mps = odometry.speed_mps();
  part.yaw_rate_radps = odometry.yaw_rate_radps();
  part.uses_ins_rate = odometry.uses_ins_rate();
  part.odometry_gaps = odometry.gaps();
  part.commanded_speed_mps = loop.tracking().speed_mps;
  part.commanded_yaw_rate_radps = loop.tracking().yaw_rate_radps;
}

void Fill(const Odometry& odometry, control::OdometryPart& part) {
  part.position_sigma_m = Max(odometry.Sigma(kStateX), odometry.Sigma(kStateY));
  part.yaw_sigma_rad = odometry.Sigma(kStateYaw);
  part.driven_m = odometry.driven_m();
  part.at_rest = odometry.at_rest();
  part.gyro_bias_radps = odometry.gyro_bias_radps();
  part.gyro_bias_sigma_radps = odometry.Sigma(kStateGyroBias);
  part.wheel_scale = odometry.wheel_scale();
  part.wheel_scale_sigma = odometry.Sigma(kStateWheelScale);
  part.skid_baseline_m = odometry.skid_baseline_m();
  part.skid_baseline_sigma_m = odometry.Sigma(kStateBaseline) * odometry.wheel_scale();
  const OdometryCounters& counters = odometry.counters();
  part.gyro_rejected = counters.gyro_rejected;
  part.wheel_speed_rejected = counters.wheel_speed_rejected;
  part.wheel_turn_rejected = counters.wheel_turn_rejected;
  part.ground_speed_rejected = counters.ground_speed_rejected;
  part.reopened = counters.reopened;
  part.late = counters.late;
  part.too_late = counters.too_late;
  part.repeated = counters.repeated;
  part.refused = counters.refused;
  part.gyro_frozen = counters.gyro_frozen;
  part.wheels_frozen = counters.wheels_frozen;
  part.restarts = counters.restarts;
}

void Fill(const MapFromOdom& map, control::OdometryPart& part) {
  part.map_status = static_cast<uint8_t>(map.status());
  part.map_taken = map.counters().taken;
  part.map_rejected = map.counters().rejected;
  part.map_relocations = map.counters().relocations;
  if (!map.has_transform()) return;
  part.map_x_m = map.map_from_odom().x_m;
  part.map_y_m = map.map_from_odom().y_m;
  part.map_yaw_rad = map.map_from_odom().theta_rad;
  part.map_position_sigma_m = map.position_sigma_m();
  part.map_yaw_sigma_rad = map.yaw_sigma_rad();
}

void Fill(const VehicleLoop& loop, control::AgePart& part) {
  const SafetyParams& safety = loop.config().onboard.safety;
  const uint64_t now_ns = loop.now_ns();
  part.lidar_age = control::AgeAt(now_ns, loop.lidar_ns(), InNanoseconds(safety.max_lidar_age_s));
  part.ins_age = control::AgeAt(now_ns, loop.ins_ns(),
                                safety.needs_ins != 0 ? InNanoseconds(safety.max_ins_age_s) : 0);
  part.odometry_age =
      control::AgeAt(now_ns, loop.odometry().moved_ns(), InNanoseconds(safety.max_odometry_age_s));
  part.operator_age =
      control::AgeAt(now_ns, loop.operator_ns(), InNanoseconds(safety.operator_timeout_s));
}

void Fill(const VehicleLoop& loop, control::SightPart& part) {
  static_assert(control::SightPart::kParts == SightWatch::kShown);
  const uint64_t now_ns = loop.now_ns();
  const float limit_s = loop.config().onboard.safety.max_look_age_s;
  const SightWatch& sight = loop.sight();
  part.look_age = control::AgeAt(now_ns, loop.OldestLook().time_ns, InNanoseconds(limit_s));
  part.sectors = static_cast<uint32_t>(sight.sectors());
  part.old_sectors = static_cast<uint32_t>(sight.OldSectors(now_ns, limit_s));
  part.covered_sectors = static_cast<uint32_t>(sight.covered_sectors());
  part.frozen_sectors = static_cast<uint32_t>(sight.frozen_sectors());
  part.lidar_turned = loop.mount().has_turned();
  part.ground_tilt_rad = loop.mount().tilt_rad();
  part.revolution_ns = sight.revolution_ns();
  HP_LOOP_BOUND(SightWatch::kShown)
  for (int i = 0; i < SightWatch::kShown; ++i) {
    const SightWatch::Shares shares = sight.SharesOf(i, now_ns);
    part.columns_permille[i] = shares.columns_permille;
    part.returns_permille[i] = shares.returns_permille;
  }
}

void Fill(const VehicleLoop& loop, control::GoalPart& part) {
  part.goals = static_cast<uint32_t>(loop.goals());
  if (part.goals == 0) return;
  const Vec2 goal = loop.goal_odom();
  const Vec3& here = loop.odometry().pose().position;
  part.goal_index = static_cast<uint32_t>(loop.goal_index());
  part.goal_x_m = goal.x_m;
  part.goal_y_m = goal.y_m;
  const float dx_m = goal.x_m - here.x_m;
  const float dy_m = goal.y_m - here.y_m;
  part.distance_to_goal_m = Sqrt(dx_m * dx_m + dy_m * dy_m);
}

void Fill(const VehicleLoop& loop, control::PlanPart& part) {
  const Replanner& replanner = loop.replanner();
  const ReplanOutcome& outcome = replanner.outcome();
  part.decision = static_cast<uint8_t>(outcome.decision);
  part.reason = static_cast<uint8_t>(outcome.reason);
  part.status = static_cast<uint8_t>(outcome.status);
  part.plan_status = static_cast<uint8_t>(outcome.plan_status);
  const CommittedPlan& plan = replanner.committed();
  part.number = plan.number;
  if (plan.number == 0) return;
  part.check_age = control::AgeAt(loop.now_ns(), plan.checked_ns,
                                  InNanoseconds(loop.config().onboard.safety.max_plan_age_s));
  part.distance_to_end_m = LengthOf(plan.path) - replanner.place().along_m;
  part.reaches_goal = plan.reaches_goal;
  part.is_stop = plan.is_stop;
  part.narrow = plan.narrow;
}

void Fill(const VehicleLoop& loop, control::SafetyPart& part) {
  const Corridor& corridor = loop.corridor();
  part.obstacle_ahead = corridor.has_obstacle();
  part.person_ahead = corridor.is_person();
  if (corridor.has_obstacle()) {
    part.obstacle_distance_m = corridor.obstacle_along_m() - loop.replanner().place().along_m;
  }
  const ReactionMeter& reaction = loop.reaction();
  part.reaction_median_s = reaction.Time_s(0.5f);
  part.reaction_p99_s = reaction.Time_s(0.99f);
  part.reaction_median_m = reaction.Radius_m(0.5f);
  part.reaction_p99_m = reaction.Radius_m(0.99f);
  part.reaction_columns = reaction.columns();
  part.reaction_lost = reaction.lost();
  const GateCounters& gate = loop.gate().counters();
  part.commands_not_finite = gate.not_finite;
  part.commands_not_permitted = gate.not_permitted;
  part.commands_above_speed = gate.above_speed;
  part.commands_above_change = gate.above_change;
}

void Fill(const ReplanCounters& counters, control::ReplanPart& part) {
  static_assert(control::kReplanReasonCount == kReplanReasons);
  part.plans = counters.plans;
  part.kept = counters.kept;
  part.extended = counters.extended;
  Copy(counters.replaced, part.replaced);
  part.stopped = counters.stopped;
  part.failed = counters.failed;
  part.reanchored = counters.reanchored;
  part.late = counters.late;
  part.refused = counters.refused;
}

void Fill(const InsSample& sample, control::InsPart& part) {
  part.mode = static_cast<uint8_t>(sample.status.mode);
  part.gnss_fix = sample.status.gnss_fix;
  part.time_error = sample.status.time_error;
  part.imu_error = sample.status.imu_error;
  part.magnetometer_or_pressure_error = sample.status.magnetometer_or_pressure_error;
  part.gnss_error = sample.status.gnss_error;
  part.has_position = sample.has_position;
  part.latitude_ndeg = sample.latitude_ndeg;
  part.longitude_ndeg = sample.longitude_ndeg;
  part.position_uncertainty_m = sample.position_uncertainty_m;
}

void Fill(const vectornav::StreamCounters& counters, control::InsStreamPart& part) {
  part.bytes = counters.bytes;
  part.skipped_bytes = counters.skipped_bytes;
  part.binary_messages = counters.binary_messages;
  part.ascii_messages = counters.ascii_messages;
  part.samples = counters.samples;
  part.unused = counters.unused;
  part.not_finite = counters.not_finite;
  part.out_of_range = counters.out_of_range;
  part.bad_checksum = counters.bad_checksum;
  part.unsupported = counters.unsupported;
}

void Fill(const sevcon::DriveReport& drive, uint64_t now_ns, const DriveParams& params,
          control::DrivePart& part) {
  constexpr uint64_t kNanosecondsPerMillisecond = 1'000'000;
  part.state = static_cast<uint8_t>(drive.state);
  part.fault = static_cast<uint8_t>(drive.fault);
  part.nmt_state = drive.nmt_state;
  part.statusword = drive.statusword;
  part.emergency_code = drive.emergency_code;
  part.emergency_register = drive.emergency_register;
  part.sevcon_fault_id = drive.sevcon_fault_id;
  part.sdo_abort_code = drive.sdo_abort_code;
  part.sdo_index = drive.sdo_index;
  part.sdo_abort_reason = drive.sdo_abort_reason;
  part.wheel_radps = drive.wheel_radps;
  part.wheel_age = control::AgeAt(
      now_ns, drive.wheel_time_ns,
      static_cast<uint64_t>(params.feedback_timeout_ms) * kNanosecondsPerMillisecond);
  part.torque_share = drive.torque_share;
  part.has_supply = drive.has_supply;
  part.battery_V = drive.battery_V;
  part.battery_A = drive.battery_A;
  part.capacitor_V = drive.capacitor_V;
  part.heatsink_degC = drive.heatsink_degC;
  part.emergencies = drive.emergencies;
  part.reboots = drive.reboots;
  part.sdo_timeouts = drive.sdo_timeouts;
  part.sdo_aborts = drive.sdo_aborts;
  part.heartbeats_missed = drive.heartbeats_missed;
  part.doubled_reports = drive.doubled_reports;
}

void Fill(const ouster::PacketCounters& counters, control::LidarPacketPart& part) {
  part.accepted = counters.accepted;
  part.wrong_size = counters.wrong_size;
  part.wrong_type = counters.wrong_type;
  part.bad_crc = counters.bad_crc;
  part.wrong_sensor = counters.wrong_sensor;
  part.not_resumed = counters.not_resumed;
  part.before_start = counters.before_start;
  part.duplicates = counters.duplicates;
  part.restarts = counters.restarts;
  part.out_of_order = counters.out_of_order;
  part.missing = counters.missing;
  part.jumps = counters.jumps;
  part.unplaced = counters.unplaced;
}

void Fill(const Timebase& clock, control::LidarClockPart& part) {
  part.started = clock.started();
  part.suspect = clock.suspect();
  if (clock.started()) part.offset_ns = clock.offset_ns();
  part.observations = clock.counters().observations;
  part.jumps = clock.counters().jumps;
  part.late = clock.counters().late;
  part.beyond_drift = clock.counters().beyond_drift;
  part.refused = clock.counters().refused;
}

void Fill(const MapperCounters& counters, control::MapperPart& part) {
  part.columns_without_pose = counters.columns_without_pose;
  part.columns_over_limit = counters.columns_over_limit;
  part.folded_with_labels = counters.folded_with_labels;
  part.folded_without_labels = counters.folded_without_labels;
  part.folded_early = counters.folded_early;
  part.late_unclassed_columns = counters.late_unclassed_columns;
  part.returns_off_map = counters.returns_off_map;
  part.overhead_returns = counters.overhead_returns;
  part.height_jumps = counters.height_jumps;
  part.position_jumps = counters.position_jumps;
  part.sensor_restarts = counters.sensor_restarts;
}

void Fill(const LoopCounters& counters, control::LoopPart& part) {
  static_assert(control::kInputSourceCount == kInputSources);
  part.ticks = counters.ticks;
  part.missed_ticks = counters.missed_ticks;
  part.refused_ticks = counters.refused_ticks;
  Copy(counters.datagrams, part.datagrams);
  Copy(counters.refused_datagrams, part.refused_datagrams);
  part.refused_columns = counters.refused_columns;
  part.suspect_columns = counters.suspect_columns;
  part.lidar_restarts = counters.lidar_restarts;
  part.clock_jumps = counters.clock_jumps;
  part.untimed_ins = counters.untimed_ins;
  part.odometry_gaps = counters.odometry_gaps;
  part.odometry_jumps = counters.odometry_jumps;
  part.refused_labels = counters.refused_labels;
  part.commands = counters.commands;
  part.refused_commands = counters.refused_commands;
  part.plans = counters.plans;
  part.refused_states = counters.refused_states;
}

void Fill(const VehicleLoop& loop, const CanBus& bus, control::CanPart& part) {
  const sevcon::PairCounters& counters = loop.drives().counters();
  part.state = static_cast<uint8_t>(bus.state());
  part.bus_load_percent = static_cast<uint32_t>(loop.drives().bus_load_percent());
  part.bus = bus.counters();
  part.frames_taken = counters.frames_taken;
  part.frames_ignored = counters.frames_ignored;
  part.frames_malformed = counters.frames_malformed;
  part.foreign_frames = counters.foreign_frames;
  part.frames_old = counters.frames_old;
}

}  // namespace

void RunLoop::Report(control::StatusReport& report) const {
  report = kNothing;
  report.program = program_;
  report.program.uptime_ns = loop_.now_ns() - first_ns_;
  report.program.tick_index = index_;
  report.program.decision_hash = loop_.decision_hash();
  if (options_.allocations != nullptr) report.program.heap_allocations = options_.allocations();
  Fill(loop_, report.vehicle);
  Fill(loop_.odometry(), report.odometry);
  Fill(loop_.map_from_odom(), report.odometry);
  Fill(loop_, report.inputs);
  Fill(loop_, report.goal);
  Fill(loop_, report.plan);
  Fill(loop_, report.safety);
  Fill(loop_, report.sight);
  Fill(loop_.replanner().counters(), report.replan);
  Fill(loop_.newest_ins(), report.ins);
  Fill(loop_.ins().counters(), report.ins_stream);
  const DriveParams& drive = loop_.config().onboard.drive;
  Fill(loop_.drives().report(sevcon::Side::kLeft), loop_.now_ns(), drive, report.left_drive);
  Fill(loop_.drives().report(sevcon::Side::kRight), loop_.now_ns(), drive, report.right_drive);
  Fill(loop_, *devices_.can, report.can);
  Fill(loop_.lidar().monitor().counters(), report.lidar_packets);
  Fill(loop_.lidar_time(), report.lidar_clock);
  Fill(loop_.mapper().counters(), report.mapper);
  Fill(loop_.counters(), report.loop);
  report.lidar_socket = devices_.lidar->counters();
  if (devices_.ins != nullptr) report.ins_socket = devices_.ins->counters();
  if (devices_.labels != nullptr) report.label_socket = devices_.labels->counters();
  if (devices_.recorder != nullptr) report.recorder = devices_.recorder->counters();
  if (devices_.control != nullptr) report.control = devices_.control->counters();
}

}  // namespace hardpack
