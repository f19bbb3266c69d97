// SPDX-License-Identifier: Apache-2.0
// Writes one kStatus message, as hardpackd would, for the tests of `hardpack ctl status`.

#include <array>
#include <cstdio>
#include <cstring>

#include "core/measurements/measurements.h"
#include "core/safety/supervisor.h"
#include "hal/can_bus.h"
#include "hal/onboard/control/status_report.h"
#include "hal/sevcon/sevcon.h"

int main() {
  using namespace hardpack;
  control::StatusReport report;
  std::strcpy(report.program.version, "9.8.7");
  report.program.uptime_ns = 3'723'000'000'000;
  report.program.tick_index = 18446744073709551615u;
  report.program.missed_ticks = 3;
  report.program.worst_tick_ns = 4'250'000;
  report.program.decision_hash = 0x0123456789abcdefu;
  report.program.realtime_scheduled = true;
  report.vehicle.mode = static_cast<uint8_t>(Mode::kSafeStop);
  report.vehicle.stop_reason = static_cast<uint8_t>(StopReason::kLidarOld);
  report.vehicle.x_m = 12.3f;
  report.vehicle.y_m = -0.5f;
  report.inputs.lidar_age = {412'000'000, 300'000'000};
  report.inputs.ins_age = {12'000'000, 200'000'000};
  report.plan.status = static_cast<uint8_t>(Status::kNoPath);
  report.ins.mode = static_cast<uint8_t>(InsMode::kTracking);
  report.ins.latitude_ndeg = 30'617'512'345;
  report.ins.longitude_ndeg = -96'038'912'345;
  report.left_drive.present = true;
  report.left_drive.state = static_cast<uint8_t>(sevcon::DriveState::kFault);
  report.left_drive.fault = static_cast<uint8_t>(sevcon::DriveFault::kEmergency);
  report.left_drive.statusword = 0x0218;
  report.left_drive.nmt_state = 5;
  report.left_drive.battery_V = 51.25f;
  report.left_drive.heatsink_degC = -7;
  report.right_drive.present = true;
  report.right_drive.state = 200;  // of a newer program
  report.can.state = static_cast<uint8_t>(CanBusState::kActive);
  report.lidar_packets.missing = 17;
  report.lidar_clock.offset_ns = -5;
  const uint32_t not_a_number = 0x7fc00000u;
  std::memcpy(&report.vehicle.speed_mps, &not_a_number, sizeof(not_a_number));

  std::array<uint8_t, control::kMaxMessageBytes> bytes{};
  int size_bytes = 0;
  if (!IsUsable(Encode(report, 0, bytes, size_bytes))) return 1;
  const auto size = static_cast<size_t>(size_bytes);
  return std::fwrite(bytes.data(), 1, size, stdout) == size ? 0 : 1;
}
