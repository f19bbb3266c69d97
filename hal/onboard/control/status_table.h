// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/onboard/control/status_field.h"
#include "hal/onboard/control/status_report.h"

// The one table of a StatusReport's fields: encoding, decoding, the operator's text and JSON all
// use it. VisitStatus calls visit.BeginGroup(name) for each part and visit(name, kind, concern,
// value) for each of its fields, in wire order; the value's type determines its encoding. Names are
// those of the members, with their units.

namespace hardpack::control {

// Members of `part` by their names; the enclosing function has `part` and `visit`.
#define HP_STATUS_ENTRY(member, kind, concern) \
  visit(#member, FieldKind::kind, Concern::concern, part.member)
#define HP_STATUS_FIELD(member) HP_STATUS_ENTRY(member, kValue, kNone)
#define HP_STATUS_LOSS(member) HP_STATUS_ENTRY(member, kValue, kLoss)
#define HP_STATUS_SHOWN(member, kind) HP_STATUS_ENTRY(member, kind, kNone)
#define HP_STATUS_FLAG(member, concern) HP_STATUS_ENTRY(member, kValue, concern)
// Sixteen members of an array, in four lines: "returns_permille_00" to "_15".
#define HP_STATUS_PART(member, text, index) \
  visit(#member "_" text, FieldKind::kValue, Concern::kNone, part.member[index])
#define HP_STATUS_FOUR(member, a, b, c, d, first)                             \
  HP_STATUS_PART(member, a, (first)), HP_STATUS_PART(member, b, (first) + 1), \
      HP_STATUS_PART(member, c, (first) + 2), HP_STATUS_PART(member, d, (first) + 3)
#define HP_STATUS_PARTS(member)                          \
  HP_STATUS_FOUR(member, "00", "01", "02", "03", 0),     \
      HP_STATUS_FOUR(member, "04", "05", "06", "07", 4), \
      HP_STATUS_FOUR(member, "08", "09", "10", "11", 8), \
      HP_STATUS_FOUR(member, "12", "13", "14", "15", 12)

template <typename Part, typename Visit>
constexpr void VisitProgram(Part& part, Visit& visit) {
  HP_STATUS_FIELD(version);
  HP_STATUS_FIELD(vehicle);
  HP_STATUS_SHOWN(uptime_ns, kDuration);
  HP_STATUS_FIELD(tick_index);
  HP_STATUS_LOSS(missed_ticks);
  HP_STATUS_LOSS(dropped_datagrams);
  HP_STATUS_FIELD(last_missed_tick);
  HP_STATUS_SHOWN(last_miss_late_ns, kDuration);
  HP_STATUS_SHOWN(worst_late_ns, kDuration);
  HP_STATUS_SHOWN(worst_tick_ns, kDuration);
  HP_STATUS_FIELD(worst_tick_index);
  HP_STATUS_FLAG(heap_allocations, kProblem);
  HP_STATUS_FLAG(realtime_scheduled, kExpected);
  HP_STATUS_FLAG(memory_locked, kExpected);
  HP_STATUS_FIELD(watchdog_fed);
  HP_STATUS_SHOWN(decision_hash, kHex);
}

template <typename Part, typename Visit>
constexpr void VisitVehicle(Part& part, Visit& visit) {
  HP_STATUS_ENTRY(mode, kMode, kProblem);
  HP_STATUS_ENTRY(stop_reason, kStopReason, kProblem);
  HP_STATUS_SHOWN(last_stop, kStopReason);
  HP_STATUS_SHOWN(motion, kMotion);
  HP_STATUS_SHOWN(stop_reason_age, kAge);
  HP_STATUS_FIELD(x_m);
  HP_STATUS_FIELD(y_m);
  HP_STATUS_FIELD(yaw_rad);
  HP_STATUS_FIELD(speed_mps);
  HP_STATUS_FIELD(yaw_rate_radps);
  HP_STATUS_FIELD(uses_ins_rate);
  HP_STATUS_LOSS(odometry_gaps);
  HP_STATUS_FIELD(commanded_speed_mps);
  HP_STATUS_FIELD(commanded_yaw_rate_radps);
  HP_STATUS_FIELD(drives_ready);
  HP_STATUS_FIELD(drives_enabled);
  HP_STATUS_FLAG(drives_faulty, kProblem);
  HP_STATUS_FIELD(drives_off);
}

template <typename Part, typename Visit>
constexpr void VisitOdometry(Part& part, Visit& visit) {
  HP_STATUS_FIELD(position_sigma_m);
  HP_STATUS_FIELD(yaw_sigma_rad);
  HP_STATUS_FIELD(driven_m);
  HP_STATUS_FIELD(at_rest);
  HP_STATUS_FIELD(gyro_bias_radps);
  HP_STATUS_FIELD(gyro_bias_sigma_radps);
  HP_STATUS_FIELD(wheel_scale);
  HP_STATUS_FIELD(wheel_scale_sigma);
  HP_STATUS_FIELD(skid_baseline_m);
  HP_STATUS_FIELD(skid_baseline_sigma_m);
  HP_STATUS_LOSS(gyro_rejected);
  HP_STATUS_LOSS(wheel_speed_rejected);
  HP_STATUS_LOSS(wheel_turn_rejected);
  HP_STATUS_LOSS(ground_speed_rejected);
  HP_STATUS_LOSS(reopened);
  HP_STATUS_FIELD(late);
  HP_STATUS_LOSS(too_late);
  HP_STATUS_LOSS(repeated);
  HP_STATUS_LOSS(refused);
  HP_STATUS_LOSS(gyro_frozen);
  HP_STATUS_LOSS(wheels_frozen);
  HP_STATUS_LOSS(restarts);
  HP_STATUS_SHOWN(map_status, kMapStatus);
  HP_STATUS_FIELD(map_x_m);
  HP_STATUS_FIELD(map_y_m);
  HP_STATUS_FIELD(map_yaw_rad);
  HP_STATUS_FIELD(map_position_sigma_m);
  HP_STATUS_FIELD(map_yaw_sigma_rad);
  HP_STATUS_FIELD(map_taken);
  HP_STATUS_LOSS(map_rejected);
  HP_STATUS_LOSS(map_relocations);
}

template <typename Part, typename Visit>
constexpr void VisitInputs(Part& part, Visit& visit) {
  HP_STATUS_SHOWN(lidar_age, kAge);
  HP_STATUS_SHOWN(ins_age, kAge);
  HP_STATUS_SHOWN(odometry_age, kAge);
  HP_STATUS_SHOWN(operator_age, kAge);
}

template <typename Part, typename Visit>
constexpr void VisitGoal(Part& part, Visit& visit) {
  HP_STATUS_FIELD(goals);
  HP_STATUS_FIELD(goal_index);
  HP_STATUS_FIELD(goal_x_m);
  HP_STATUS_FIELD(goal_y_m);
  HP_STATUS_FIELD(distance_to_goal_m);
  HP_STATUS_FIELD(paused);
  HP_STATUS_FIELD(at_waypoint);
  HP_STATUS_FIELD(may_resume);
}

template <typename Part, typename Visit>
constexpr void VisitPlan(Part& part, Visit& visit) {
  HP_STATUS_SHOWN(decision, kReplanDecision);
  HP_STATUS_SHOWN(reason, kReplanReason);
  HP_STATUS_ENTRY(status, kStatus, kProblem);
  HP_STATUS_SHOWN(plan_status, kStatus);
  HP_STATUS_FIELD(number);
  HP_STATUS_SHOWN(check_age, kAge);
  HP_STATUS_FIELD(distance_to_end_m);
  HP_STATUS_FIELD(reaches_goal);
  HP_STATUS_FIELD(is_stop);
  HP_STATUS_FIELD(narrow);
}

template <typename Part, typename Visit>
constexpr void VisitSafety(Part& part, Visit& visit) {
  HP_STATUS_FLAG(obstacle_ahead, kProblem);
  HP_STATUS_FLAG(person_ahead, kProblem);
  HP_STATUS_FIELD(obstacle_distance_m);
  HP_STATUS_FIELD(reaction_median_s);
  HP_STATUS_FIELD(reaction_p99_s);
  HP_STATUS_FIELD(reaction_median_m);
  HP_STATUS_FIELD(reaction_p99_m);
  HP_STATUS_FIELD(reaction_columns);
  HP_STATUS_LOSS(reaction_lost);
  HP_STATUS_LOSS(commands_not_finite);
  HP_STATUS_LOSS(commands_not_permitted);
  HP_STATUS_LOSS(commands_above_speed);
  HP_STATUS_LOSS(commands_above_change);
}

template <typename Part, typename Visit>
constexpr void VisitAreas(Part& part, Visit& visit) {
  HP_STATUS_FIELD(areas);
  HP_STATUS_FIELD(configured);
  HP_STATUS_FIELD(expected);
  HP_STATUS_FLAG(unknown, kProblem);
  HP_STATUS_FLAG(breached, kProblem);
  HP_STATUS_FIELD(breached_area);
}

template <typename Part, typename Visit>
constexpr void VisitSight(Part& part, Visit& visit) {
  HP_STATUS_SHOWN(look_age, kAge);
  HP_STATUS_FIELD(sectors);
  HP_STATUS_FIELD(old_sectors);
  HP_STATUS_FLAG(covered_sectors, kProblem);
  HP_STATUS_FLAG(frozen_sectors, kProblem);
  HP_STATUS_FLAG(lidar_turned, kProblem);
  HP_STATUS_FIELD(ground_tilt_rad);
  HP_STATUS_SHOWN(revolution_ns, kDuration);
  HP_STATUS_PARTS(columns_permille);
  HP_STATUS_PARTS(returns_permille);
}

template <typename Part, typename Visit>
constexpr void VisitIns(Part& part, Visit& visit) {
  HP_STATUS_ENTRY(mode, kInsMode, kProblem);
  HP_STATUS_FLAG(gnss_fix, kExpected);
  HP_STATUS_FLAG(time_error, kProblem);
  HP_STATUS_FLAG(imu_error, kProblem);
  HP_STATUS_FLAG(magnetometer_or_pressure_error, kProblem);
  HP_STATUS_FLAG(gnss_error, kProblem);
  HP_STATUS_FIELD(has_position);
  HP_STATUS_SHOWN(latitude_ndeg, kNanodegree);
  HP_STATUS_SHOWN(longitude_ndeg, kNanodegree);
  HP_STATUS_FIELD(position_uncertainty_m);
}

template <typename Part, typename Visit>
constexpr void VisitDrive(Part& part, Visit& visit) {
  HP_STATUS_ENTRY(state, kDriveState, kProblem);
  HP_STATUS_ENTRY(fault, kDriveFault, kProblem);
  HP_STATUS_SHOWN(nmt_state, kNmtState);
  HP_STATUS_SHOWN(statusword, kHex);
  HP_STATUS_SHOWN(emergency_code, kHex);
  HP_STATUS_SHOWN(emergency_register, kHex);
  HP_STATUS_SHOWN(sevcon_fault_id, kHex);
  HP_STATUS_SHOWN(sdo_abort_code, kHex);
  HP_STATUS_SHOWN(sdo_index, kHex);
  HP_STATUS_SHOWN(sdo_abort_reason, kHex);
  HP_STATUS_FIELD(wheel_radps);
  HP_STATUS_SHOWN(wheel_age, kAge);
  HP_STATUS_FIELD(torque_share);
  HP_STATUS_FIELD(has_supply);
  HP_STATUS_FIELD(battery_V);
  HP_STATUS_FIELD(battery_A);
  HP_STATUS_FIELD(capacitor_V);
  HP_STATUS_FIELD(heatsink_degC);
  HP_STATUS_LOSS(emergencies);
  HP_STATUS_LOSS(reboots);
  HP_STATUS_LOSS(sdo_timeouts);
  HP_STATUS_LOSS(sdo_aborts);
  HP_STATUS_LOSS(heartbeats_missed);
  HP_STATUS_LOSS(doubled_reports);
  HP_STATUS_FIELD(present);
}

template <typename Part, typename Visit>
constexpr void VisitMotionController(Part& part, Visit& visit) {
  HP_STATUS_ENTRY(state, kControllerState, kProblem);
  HP_STATUS_ENTRY(fault, kControllerFault, kProblem);
  HP_STATUS_FIELD(speed_mps);
  HP_STATUS_FIELD(yaw_rate_radps);
  HP_STATUS_SHOWN(feedback_age, kAge);
  HP_STATUS_SHOWN(controller_faults, kHex);
  HP_STATUS_FIELD(battery_V);
  HP_STATUS_FIELD(temperature_degC);
  HP_STATUS_LOSS(frames_repeated);
  HP_STATUS_LOSS(frames_missed);
  HP_STATUS_FIELD(present);
}

template <typename Part, typename Visit>
constexpr void VisitBusCounters(Part& part, Visit& visit) {
  HP_STATUS_FIELD(accepted);
  HP_STATUS_FIELD(confirmed);
  HP_STATUS_LOSS(expired);
  HP_STATUS_LOSS(refused);
  HP_STATUS_FIELD(received);
  HP_STATUS_LOSS(malformed);
  HP_STATUS_LOSS(lost);
  HP_STATUS_LOSS(error_frames);
  HP_STATUS_LOSS(bus_offs);
  HP_STATUS_LOSS(restarts);
  HP_STATUS_LOSS(went_down);
  HP_STATUS_LOSS(system_errors);
}

template <typename Part, typename Visit>
constexpr void VisitCan(Part& part, Visit& visit) {
  HP_STATUS_ENTRY(state, kCanBusState, kProblem);
  HP_STATUS_FIELD(bus_load_percent);
  VisitBusCounters(part.bus, visit);
  HP_STATUS_FIELD(frames_taken);
  HP_STATUS_FIELD(frames_ignored);
  HP_STATUS_LOSS(frames_malformed);
  HP_STATUS_LOSS(foreign_frames);
  HP_STATUS_LOSS(frames_old);
}

template <typename Part, typename Visit>
constexpr void VisitLidarPackets(Part& part, Visit& visit) {
  HP_STATUS_FIELD(accepted);
  HP_STATUS_LOSS(wrong_size);
  HP_STATUS_LOSS(wrong_type);
  HP_STATUS_LOSS(bad_crc);
  HP_STATUS_LOSS(wrong_sensor);
  HP_STATUS_LOSS(not_resumed);
  HP_STATUS_LOSS(before_start);
  HP_STATUS_LOSS(duplicates);
  HP_STATUS_LOSS(restarts);
  HP_STATUS_FIELD(out_of_order);
  HP_STATUS_LOSS(missing);
  HP_STATUS_LOSS(jumps);
  HP_STATUS_LOSS(unplaced);
  HP_STATUS_LOSS(wrong_mode);
  HP_STATUS_LOSS(wrong_rate);
  HP_STATUS_LOSS(bad_azimuth);
  HP_STATUS_LOSS(bad_time);
}

template <typename Part, typename Visit>
constexpr void VisitLidarClock(Part& part, Visit& visit) {
  HP_STATUS_FIELD(started);
  HP_STATUS_FLAG(suspect, kProblem);
  HP_STATUS_FIELD(offset_ns);
  HP_STATUS_FIELD(observations);
  HP_STATUS_LOSS(jumps);
  HP_STATUS_LOSS(late);
  HP_STATUS_LOSS(beyond_drift);
  HP_STATUS_LOSS(refused);
}

template <typename Part, typename Visit>
constexpr void VisitMapper(Part& part, Visit& visit) {
  HP_STATUS_LOSS(columns_without_pose);
  HP_STATUS_LOSS(columns_over_limit);
  HP_STATUS_FIELD(folded_with_labels);
  HP_STATUS_FIELD(folded_without_labels);
  HP_STATUS_LOSS(folded_early);
  HP_STATUS_LOSS(late_unclassed_columns);
  HP_STATUS_FIELD(returns_off_map);
  HP_STATUS_FIELD(overhead_returns);
  HP_STATUS_LOSS(height_jumps);
  HP_STATUS_LOSS(position_jumps);
  HP_STATUS_LOSS(sensor_restarts);
}

template <typename Part, typename Visit>
constexpr void VisitInsStream(Part& part, Visit& visit) {
  HP_STATUS_FIELD(bytes);
  HP_STATUS_FIELD(skipped_bytes);
  HP_STATUS_FIELD(binary_messages);
  HP_STATUS_FIELD(ascii_messages);
  HP_STATUS_FIELD(samples);
  HP_STATUS_FIELD(unused);
  HP_STATUS_LOSS(not_finite);
  HP_STATUS_LOSS(out_of_range);
  HP_STATUS_LOSS(bad_checksum);
  HP_STATUS_LOSS(unsupported);
  HP_STATUS_FIELD(present);
}

template <typename Part, typename Visit>
constexpr void VisitPoseDatagrams(Part& part, Visit& visit) {
  HP_STATUS_FIELD(bytes);
  HP_STATUS_FIELD(skipped_bytes);
  HP_STATUS_FIELD(samples);
  HP_STATUS_LOSS(refused);
  HP_STATUS_LOSS(repeated);
  HP_STATUS_LOSS(missed);
  HP_STATUS_LOSS(restarts);
  HP_STATUS_LOSS(bad_crc);
  HP_STATUS_FIELD(present);
}

template <typename Part, typename Visit>
constexpr void VisitSocket(Part& part, Visit& visit) {
  HP_STATUS_FIELD(received);
  HP_STATUS_FIELD(received_bytes);
  HP_STATUS_LOSS(foreign);
  HP_STATUS_LOSS(oversized);
  HP_STATUS_LOSS(lost_in_kernel);
  HP_STATUS_LOSS(system_errors);
  HP_STATUS_FIELD(receive_buffer_bytes);
}

template <typename Part, typename Visit>
constexpr void VisitLoop(Part& part, Visit& visit) {
  HP_STATUS_FIELD(ticks);
  HP_STATUS_LOSS(missed_ticks);
  HP_STATUS_LOSS(refused_ticks);
  visit("ins_datagrams", FieldKind::kValue, Concern::kNone, part.datagrams[0]);
  visit("label_datagrams", FieldKind::kValue, Concern::kNone, part.datagrams[1]);
  visit("lidar_datagrams", FieldKind::kValue, Concern::kNone, part.datagrams[2]);
  visit("refused_ins_datagrams", FieldKind::kValue, Concern::kLoss, part.refused_datagrams[0]);
  visit("refused_label_datagrams", FieldKind::kValue, Concern::kLoss, part.refused_datagrams[1]);
  visit("refused_lidar_datagrams", FieldKind::kValue, Concern::kLoss, part.refused_datagrams[2]);
  HP_STATUS_LOSS(refused_columns);
  HP_STATUS_LOSS(suspect_columns);
  HP_STATUS_LOSS(lidar_restarts);
  HP_STATUS_LOSS(clock_jumps);
  HP_STATUS_LOSS(untimed_ins);
  HP_STATUS_LOSS(odometry_gaps);
  HP_STATUS_LOSS(odometry_jumps);
  HP_STATUS_LOSS(refused_labels);
  HP_STATUS_FIELD(commands);
  HP_STATUS_LOSS(refused_commands);
  HP_STATUS_FIELD(plans);
  HP_STATUS_LOSS(refused_states);
}

template <typename Part, typename Visit>
constexpr void VisitReplan(Part& part, Visit& visit) {
  HP_STATUS_FIELD(plans);
  HP_STATUS_FIELD(kept);
  HP_STATUS_FIELD(extended);
  visit("replaced_none", FieldKind::kValue, Concern::kNone, part.replaced[0]);
  visit("replaced_first", FieldKind::kValue, Concern::kNone, part.replaced[1]);
  visit("replaced_off_path", FieldKind::kValue, Concern::kNone, part.replaced[2]);
  visit("replaced_goal_changed", FieldKind::kValue, Concern::kNone, part.replaced[3]);
  visit("replaced_after_stop", FieldKind::kValue, Concern::kNone, part.replaced[4]);
  visit("replaced_blocked", FieldKind::kValue, Concern::kNone, part.replaced[5]);
  visit("replaced_ends", FieldKind::kValue, Concern::kNone, part.replaced[6]);
  visit("replaced_cheaper", FieldKind::kValue, Concern::kNone, part.replaced[7]);
  HP_STATUS_FIELD(stopped);
  HP_STATUS_FIELD(failed);
  HP_STATUS_LOSS(reanchored);
  HP_STATUS_LOSS(late);
  HP_STATUS_LOSS(refused);
}

template <typename Part, typename Visit>
constexpr void VisitRecorder(Part& part, Visit& visit) {
  HP_STATUS_FIELD(records);
  HP_STATUS_FIELD(bytes);
  HP_STATUS_LOSS(dropped);
  HP_STATUS_FIELD(written_bytes);
  HP_STATUS_FIELD(files);
  HP_STATUS_LOSS(write_errors);
}

template <typename Part, typename Visit>
constexpr void VisitControl(Part& part, Visit& visit) {
  HP_STATUS_FIELD(clients);
  HP_STATUS_FIELD(connected);
  HP_STATUS_LOSS(turned_away);
  HP_STATUS_LOSS(displaced);
  HP_STATUS_FIELD(messages);
  HP_STATUS_LOSS(not_permitted);
  HP_STATUS_LOSS(malformed);
  HP_STATUS_LOSS(dropped_slow);
  HP_STATUS_LOSS(system_errors);
}

#undef HP_STATUS_PARTS
#undef HP_STATUS_FOUR
#undef HP_STATUS_PART
#undef HP_STATUS_FLAG
#undef HP_STATUS_SHOWN
#undef HP_STATUS_LOSS
#undef HP_STATUS_FIELD
#undef HP_STATUS_ENTRY

// Report: StatusReport, const or not.
template <typename Report, typename Visit>
constexpr void VisitStatus(Report& report, Visit& visit) {
  visit.BeginGroup("program");
  VisitProgram(report.program, visit);
  visit.BeginGroup("vehicle");
  VisitVehicle(report.vehicle, visit);
  visit.BeginGroup("odometry");
  VisitOdometry(report.odometry, visit);
  visit.BeginGroup("inputs");
  VisitInputs(report.inputs, visit);
  visit.BeginGroup("goal");
  VisitGoal(report.goal, visit);
  visit.BeginGroup("plan");
  VisitPlan(report.plan, visit);
  visit.BeginGroup("safety");
  VisitSafety(report.safety, visit);
  visit.BeginGroup("areas");
  VisitAreas(report.areas, visit);
  visit.BeginGroup("sight");
  VisitSight(report.sight, visit);
  visit.BeginGroup("ins");
  VisitIns(report.ins, visit);
  visit.BeginGroup("left_drive");
  VisitDrive(report.left_drive, visit);
  visit.BeginGroup("right_drive");
  VisitDrive(report.right_drive, visit);
  visit.BeginGroup("motion_controller");
  VisitMotionController(report.motion_controller, visit);
  visit.BeginGroup("can");
  VisitCan(report.can, visit);
  visit.BeginGroup("lidar_packets");
  VisitLidarPackets(report.lidar_packets, visit);
  visit.BeginGroup("lidar_clock");
  VisitLidarClock(report.lidar_clock, visit);
  visit.BeginGroup("mapper");
  VisitMapper(report.mapper, visit);
  visit.BeginGroup("ins_stream");
  VisitInsStream(report.ins_stream, visit);
  visit.BeginGroup("pose_datagrams");
  VisitPoseDatagrams(report.pose_datagrams, visit);
  visit.BeginGroup("lidar_socket");
  VisitSocket(report.lidar_socket, visit);
  visit.BeginGroup("ins_socket");
  VisitSocket(report.ins_socket, visit);
  visit.BeginGroup("label_socket");
  VisitSocket(report.label_socket, visit);
  visit.BeginGroup("loop");
  VisitLoop(report.loop, visit);
  visit.BeginGroup("replan");
  VisitReplan(report.replan, visit);
  visit.BeginGroup("recorder");
  VisitRecorder(report.recorder, visit);
  visit.BeginGroup("control");
  VisitControl(report.control, visit);
}

}  // namespace hardpack::control
