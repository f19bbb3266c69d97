// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "config/drive_parameters.h"
#include "hal/sevcon/canopen.h"

// The objects of a drive that the bring-up reads (bring_up.h), and their required values. Indices
// and sizes are from the Gen4's published EDS.

namespace hardpack::sevcon {

enum class Wanted : uint8_t {
  kVendor,
  kProduct,
  kSync,            // 1005h: SYNC is 080h, and the drive does not produce it if we do
  kWatchUs,         // 1016h: our heartbeat is monitored
  kHeartbeat,       // 1017h
  kTimeoutScheme,   // 5902h: the drive's reaction to missing commands
  kCommandTimeout,  // 1400h:5, if a drive has it: the time without commands until then
  kMode,
  kAcceleration,
  kCommandId,       // 1400h:1, in use and 200h + node
  kCommandType,     // 1400h:2, immediate, not on SYNC
  kFeedbackId,      // 1800h:1, in use and 180h + node
  kFeedbackType,    // 1800h:2, often enough for feedback_timeout_ms
  kFeedbackPeriod,  // 1800h:5, the same, if the type uses it
  kCount,           // of mapped objects
  kControlword,     // mapped objects, in order
  kTargetSpeed,
  kMaxTorque,
  kStatusword,
  kActualSpeed,
  kTorque,
  kSpeedLimit,  // 6080h: any; commands are clamped to it
};

struct ObjectRow {
  uint16_t index;
  uint8_t subindex;
  uint8_t size;  // bytes
  Wanted wanted;
  bool optional;  // a drive without this object passes
};

inline constexpr std::array kIdentity = {
    ObjectRow{0x1018, 1, 4, Wanted::kVendor, false},
    ObjectRow{0x1018, 2, 4, Wanted::kProduct, false},
};

// Written if they differ. The subindex of 1016h is the first that is ours or free.
inline constexpr std::array kSettings = {
    ObjectRow{0x1005, 0, 4, Wanted::kSync, true},
    ObjectRow{0x1016, 1, 4, Wanted::kWatchUs, false},
    ObjectRow{0x1017, 0, 2, Wanted::kHeartbeat, false},
    ObjectRow{0x1400, 5, 2, Wanted::kCommandTimeout, true},
    ObjectRow{0x5902, 0, 1, Wanted::kTimeoutScheme, false},
    ObjectRow{0x6060, 0, 1, Wanted::kMode, false},
    ObjectRow{0x6083, 0, 4, Wanted::kAcceleration, false},
};
inline constexpr uint8_t kMaxConsumers = 7;  // entries of 1016h

// Verified, never written: whoever set up the vehicle mapped its process data.
inline constexpr std::array kMapping = {
    ObjectRow{0x1400, 1, 4, Wanted::kCommandId, false},
    ObjectRow{0x1400, 2, 1, Wanted::kCommandType, false},
    ObjectRow{0x1600, 0, 1, Wanted::kCount, false},
    ObjectRow{0x1600, 1, 4, Wanted::kControlword, false},
    ObjectRow{0x1600, 2, 4, Wanted::kTargetSpeed, false},
    ObjectRow{0x1600, 3, 4, Wanted::kMaxTorque, false},
    ObjectRow{0x1800, 1, 4, Wanted::kFeedbackId, false},
    ObjectRow{0x1800, 2, 1, Wanted::kFeedbackType, false},
    ObjectRow{0x1800, 5, 2, Wanted::kFeedbackPeriod, false},
    ObjectRow{0x1A00, 0, 1, Wanted::kCount, false},
    ObjectRow{0x1A00, 1, 4, Wanted::kStatusword, false},
    ObjectRow{0x1A00, 2, 4, Wanted::kActualSpeed, false},
    ObjectRow{0x1A00, 3, 4, Wanted::kTorque, false},
    ObjectRow{0x6080, 0, 4, Wanted::kSpeedLimit, true},
};

// Read or written one by one.
inline constexpr uint16_t kAccess = 0x5000;  // :1 level, :2 password, :3 user
inline constexpr uint16_t kForcePreOperational = 0x2800;
inline constexpr uint16_t kNmtStateIndex = 0x5110;
inline constexpr uint16_t kModeDisplay = 0x6061;
inline constexpr uint16_t kActualSpeedIndex = 0x606C;
inline constexpr uint16_t kSupply = 0x5100;
// The access that every setting above needs ("Engineering" in the EDS).
inline constexpr uint32_t kNeededAccess = 4;

// Whether the parameters leave a row out.
bool IsLeftOut(Wanted wanted, const DriveParams& params);
// Whether an object reads as it has to.
bool Matches(Wanted wanted, uint32_t value, const DriveParams& params, int32_t node);
// What is written where it does not; of kSettings only.
uint32_t ValueOf(Wanted wanted, const DriveParams& params);

}  // namespace hardpack::sevcon
