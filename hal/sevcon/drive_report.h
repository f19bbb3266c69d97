// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// What hal/sevcon reports about one drive.

namespace hardpack::sevcon {

enum class Side : uint8_t { kLeft = 0, kRight = 1 };
inline constexpr int kSides = 2;

enum class DriveState : uint8_t {
  kSilent = 0,   // not heard: only requests are sent
  kIdentifying,  // 1018h
  kConfiguring,  // login, pre-operational, differences are written and read back
  kVerifying,    // type and mapping of the process data, started, 6061h
  kReady,        // operational on the bus, not enabled: no torque
  kEnabling,     // passing through the states of CiA 402
  kEnabled,      // operation enabled: follows commands
  kDisabling,    // zero until at rest, then disabled
  kFault,        // see DriveReport::fault; left only by a reset; the bring-up continues meanwhile
};

enum class DriveFault : uint8_t {
  kNone = 0,
  kSilent,          // heartbeat or process data missed
  kRebooted,        // boot-up, or an NMT state that we did not request
  kEmergency,       // EMCY
  kStatusFault,     // fault bit of the statusword
  kWrongIdentity,   // 1018h
  kSdoAbort,        // refused a request or a setting
  kSdoTimeout,      // no answer, including retries
  kReadBack,        // a setting does not read back as it was written
  kWrongMapping,    // process data of another type or mapping than ours
  kWrongMode,       // 6061h
  kOppositeMotion,  // the wheel turns against its command
  kForeignSender,   // another node sends with one of our identifiers
  kLostEnable,      // left operation enabled without our request
  kLoginRefused,    // 5000h: user and password do not give the access that settings need
  kStateRefused,    // did not reach the NMT state, or operation enabled, in time
  kDoubleReports,   // persistently more reports than SYNCs: two nodes send them
};
inline constexpr int kDriveFaults = 17;

// A drive's report.
struct DriveReport {
  DriveState state = DriveState::kSilent;
  DriveFault fault = DriveFault::kNone;  // the first since the last reset
  uint8_t nmt_state = 0xff;              // CiA 301; ff: not heard
  uint16_t statusword = 0;
  uint16_t emergency_code = 0;  // last EMCY, error code ...
  uint8_t emergency_register = 0;
  uint16_t sevcon_fault_id = 0;  // ... and the manufacturer's
  uint32_t sdo_abort_code = 0;   // last abort ...
  uint16_t sdo_index = 0;        // ... and the object of it, or of another failure
  uint8_t sdo_subindex = 0;
  uint16_t sdo_abort_reason = 0;  // 5310h, if it was read
  float wheel_radps = 0.0f;       // forward positive
  uint64_t wheel_time_ns = 0;     // our time of that report
  float torque_share = 0.0f;      // of the rating
  bool has_supply = false;        // 5100h has been read
  float battery_V = 0.0f;
  float battery_A = 0.0f;  // signed: negative while braking
  float capacitor_V = 0.0f;
  int32_t heatsink_degC = 0;
  uint32_t emergencies = 0;  // counted
  uint32_t reboots = 0;
  uint32_t sdo_timeouts = 0;  // answers that did not arrive in time
  uint32_t sdo_aborts = 0;
  uint32_t sdo_ignored = 0;  // answers late, duplicate or of the wrong size
  uint32_t settings_written = 0;
  uint32_t heartbeats_missed = 0;
  uint32_t doubled_reports = 0;  // SYNC periods with more than one
};

}  // namespace hardpack::sevcon
