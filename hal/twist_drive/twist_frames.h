// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "hal/can_frame.h"

// The frames between us and a motion controller that takes a speed and a turn: the format of
// docs/twist_drive.md, in both directions. Classic CAN, 11-bit identifiers, 8 bytes, little-endian.
// Ours.

namespace hardpack::twist_drive {

inline constexpr int32_t kFrame_bytes = 8;
inline constexpr float kPerMetre = 1000.0f;       // speeds: mm/s
inline constexpr float kPerYawRate = 1000.0f;     // yaw rates: mrad/s
inline constexpr float kPerSteering = 10'000.0f;  // steering angles: 0.1 mrad
inline constexpr int32_t kMostInteger = 32767;    // either way; -32768 is not a valid value

// The meaning of a frame's turn.
enum class TurnKind : uint8_t { kYawRate = 0, kSteering = 1 };

// State of the controller.
enum class ControllerState : uint8_t {
  kStarting = 0,   // does not accept commands yet
  kReady = 1,      // able to follow; applies no torque
  kFollowing = 2,  // follows commands
  kStopping = 3,   // brakes on its own: disabled, a fault, or a time-out
  kFault = 4,      // applies no torque until its faults are reset
};
inline constexpr int kControllerStates = 5;

// From us to the controller, once per tick.
struct Command {
  uint8_t counter = 0;  // of commands
  bool enable = false;  // to follow
  bool reset_faults = false;
  TurnKind turn_kind = TurnKind::kYawRate;
  int16_t speed = 0;  // forward positive
  int16_t turn = 0;   // to the left positive
};

// From the controller, at 50 Hz or more.
struct Feedback {
  uint8_t counter = 0;  // of these frames
  ControllerState state = ControllerState::kStarting;
  TurnKind turn_kind = TurnKind::kYawRate;
  bool timed_out = false;  // it has waited for a command for longer than its time-out
  int16_t speed = 0;       // measured
  int16_t turn = 0;
  uint8_t echo = 0;  // counter of the newest command accepted
};

// From the controller, at 1 Hz or more, and when a fault appears.
struct ControllerStatus {
  uint8_t counter = 0;
  uint16_t faults = 0;   // bits defined by the controller; 0: none
  uint8_t version = 0;   // of this protocol: kVersion
  uint16_t battery = 0;  // 0.01 V; 0: not measured
  int32_t temperature_degC = 0;
};
inline constexpr uint8_t kVersion = 1;

// CRC-8/SAE-J1850 (polynomial 1D hex, initial value FF hex, inverted at the end) over the
// identifier, low byte first, and the frame's first 7 bytes: a frame with another identifier does
// not pass.
uint8_t CrcOf(const CanFrame& frame);

CanFrame Encode(uint32_t id, const Command& command);
CanFrame Encode(uint32_t id, const Feedback& feedback);
CanFrame Encode(uint32_t id, const ControllerStatus& status);

// kWrongPacketType: an extended or remote frame, or a wrong size; kBadCrc; kInvalidArgument: an
// undefined state, a bit that must be 0, or a value of -32768. On failure nothing is written.
Status Decode(const CanFrame& frame, Command& command);
Status Decode(const CanFrame& frame, Feedback& feedback);
Status Decode(const CanFrame& frame, ControllerStatus& status);

// Rounds to nearest and limits to kMostInteger; 0 for NaN.
int16_t ToInteger(float value, float per_unit);

}  // namespace hardpack::twist_drive
