// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/vehicle_loop/device_reports.h"

#include "hal/sevcon/durations.h"

namespace hardpack {
namespace {

void Fill(const sevcon::DriveReport& drive, uint64_t now_ns, const DriveParams& params,
          control::DrivePart& part) {
  part.present = true;
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
  part.wheel_age =
      control::AgeAt(now_ns, drive.wheel_time_ns, sevcon::Milliseconds(params.feedback_timeout_ms));
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

}  // namespace

void sevcon::AddToReport(const DrivePair& drives, uint64_t now_ns, const OnboardParams& onboard,
                         control::StatusReport& report) {
  Fill(drives.report(Side::kLeft), now_ns, onboard.drive, report.left_drive);
  Fill(drives.report(Side::kRight), now_ns, onboard.drive, report.right_drive);
  const PairCounters& counters = drives.counters();
  control::CanPart& part = report.can;
  part.bus_load_percent = static_cast<uint32_t>(drives.bus_load_percent());
  part.frames_taken = counters.frames_taken;
  part.frames_ignored = counters.frames_ignored;
  part.frames_malformed = counters.frames_malformed;
  part.foreign_frames = counters.foreign_frames;
  part.frames_old = counters.frames_old;
}

void ouster::AddToReport(const Lidar& lidar, control::StatusReport& report) {
  const PacketCounters& counters = lidar.monitor().counters();
  control::LidarPacketPart& part = report.lidar_packets;
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

void velodyne::AddToReport(const Lidar& lidar, control::StatusReport& report) {
  const PacketCounters& counters = lidar.counters();
  control::LidarPacketPart& part = report.lidar_packets;
  part.accepted = counters.accepted;
  part.wrong_size = counters.wrong_size;
  part.wrong_type = counters.wrong_type;
  part.wrong_sensor = counters.wrong_sensor;
  part.wrong_mode = counters.wrong_mode;
  part.wrong_rate = counters.wrong_rate;
  part.bad_azimuth = counters.bad_azimuth;
  part.bad_time = counters.bad_time;
  part.not_resumed = counters.not_resumed;
  part.duplicates = counters.duplicates;
  part.restarts = counters.restarts;
  part.out_of_order = counters.out_of_order;
  part.missing = counters.missing;
  part.jumps = counters.jumps;
}

void vectornav::AddToReport(const StreamParser& ins, control::StatusReport& report) {
  const StreamCounters& counters = ins.counters();
  control::InsStreamPart& part = report.ins_stream;
  part.present = true;
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

void pose_datagram::AddToReport(const Receiver& ins, control::StatusReport& report) {
  const Counters& counters = ins.counters();
  control::PoseDatagramPart& part = report.pose_datagrams;
  part.present = true;
  part.bytes = counters.bytes;
  part.skipped_bytes = counters.skipped_bytes;
  part.samples = counters.samples;
  part.refused = counters.refused;
  part.repeated = counters.repeated;
  part.missed = counters.missed;
  part.restarts = counters.restarts;
  part.bad_crc = counters.bad_crc;
}

void twist_drive::AddToReport(const TwistDrive& drive, uint64_t now_ns,
                              const OnboardParams& onboard, control::StatusReport& report) {
  const Report& said = drive.report();
  const Counters& counters = drive.counters();
  control::MotionControllerPart& part = report.motion_controller;
  part.present = true;
  part.state = static_cast<uint8_t>(said.state);
  part.fault = static_cast<uint8_t>(said.fault);
  part.speed_mps = said.speed_mps;
  part.yaw_rate_radps = said.yaw_rate_radps;
  constexpr uint64_t kNanosecondsPerMillisecond = 1'000'000;
  part.feedback_age = control::AgeAt(
      now_ns, said.feedback_ns,
      static_cast<uint64_t>(onboard.twist_drive.feedback_timeout_ms) * kNanosecondsPerMillisecond);
  part.controller_faults = said.controller_faults;
  part.battery_V = said.battery_V;
  part.temperature_degC = said.temperature_degC;
  part.frames_repeated = counters.frames_repeated;
  part.frames_missed = counters.frames_missed;
  report.can.frames_taken = counters.frames_taken;
  report.can.frames_ignored = counters.frames_ignored;
  report.can.frames_malformed = counters.frames_malformed;
  report.can.foreign_frames = counters.foreign_frames;
}

void AddToReport(const Timebase& clock, control::LidarClockPart& part) {
  part.started = clock.started();
  part.suspect = clock.suspect();
  if (clock.started()) part.offset_ns = clock.offset_ns();
  part.observations = clock.counters().observations;
  part.jumps = clock.counters().jumps;
  part.late = clock.counters().late;
  part.beyond_drift = clock.counters().beyond_drift;
  part.refused = clock.counters().refused;
}

}  // namespace hardpack
