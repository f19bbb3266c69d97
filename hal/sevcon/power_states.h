// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The power state machine of CiA 402 (8.2): the meaning of a statusword (6041h), and the
// controlwords (6040h) for the transitions.

namespace hardpack::sevcon {

enum class PowerState : uint8_t {
  kUnknown = 0,  // bits match no state
  kNotReadyToSwitchOn,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};

constexpr PowerState PowerStateOf(uint32_t statusword) {
  switch (statusword & 0x4fu) {
    case 0x00u:
      return PowerState::kNotReadyToSwitchOn;
    case 0x40u:
      return PowerState::kSwitchOnDisabled;
    case 0x0fu:
      return PowerState::kFaultReactionActive;
    case 0x08u:
      return PowerState::kFault;
    default:
      break;
  }
  switch (statusword & 0x6fu) {
    case 0x21u:
      return PowerState::kReadyToSwitchOn;
    case 0x23u:
      return PowerState::kSwitchedOn;
    case 0x27u:
      return PowerState::kOperationEnabled;
    case 0x07u:
      return PowerState::kQuickStopActive;
    default:
      return PowerState::kUnknown;
  }
}

constexpr bool IsFault(PowerState state) {
  return state == PowerState::kFault || state == PowerState::kFaultReactionActive;
}

// Controlwords.
inline constexpr uint16_t kDisableVoltage = 0x0000;
inline constexpr uint16_t kShutdown = 0x0006;
inline constexpr uint16_t kSwitchOn = 0x0007;
inline constexpr uint16_t kEnableOperation = 0x000f;
inline constexpr uint16_t kResetFault = 0x0080;  // on its rising edge

// The controlword for one step from a state towards operation enabled.
constexpr uint16_t StepToEnabled(PowerState state) {
  switch (state) {
    case PowerState::kSwitchOnDisabled:
      return kShutdown;
    case PowerState::kReadyToSwitchOn:
      return kSwitchOn;
    case PowerState::kSwitchedOn:
    case PowerState::kOperationEnabled:
      return kEnableOperation;
    default:
      return kDisableVoltage;  // out of a quick stop too
  }
}

}  // namespace hardpack::sevcon
