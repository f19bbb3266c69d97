// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/power_states.h"

namespace hardpack::sim {

const char* Name(PowerState state) {
  switch (state) {
    case PowerState::kNotReady:
      return "not-ready";
    case PowerState::kSwitchOnDisabled:
      return "switch-on-disabled";
    case PowerState::kReady:
      return "ready";
    case PowerState::kSwitchedOn:
      return "switched-on";
    case PowerState::kEnabled:
      return "enabled";
    case PowerState::kQuickStop:
      return "quick-stop";
    case PowerState::kFaultReaction:
      return "fault-reaction";
    case PowerState::kFault:
      return "fault";
  }
  return "?";
}

void PowerStates::SetControlword(uint16_t controlword) {
  constexpr unsigned kFaultReset = 0x80;
  if ((controlword & kFaultReset) != 0 && (controlword_ & kFaultReset) == 0) reset_ = true;
  controlword_ = controlword;
}

bool PowerStates::driven() const {
  return state_ == PowerState::kEnabled || state_ == PowerState::kQuickStop ||
         state_ == PowerState::kFaultReaction;
}

void PowerStates::RaiseFault() {
  if (state_ == PowerState::kFault || state_ == PowerState::kFaultReaction) return;
  state_ = driven() ? PowerState::kFaultReaction : PowerState::kFault;
  reset_ = false;
}

void PowerStates::Disable() {
  if (state_ == PowerState::kFault || state_ == PowerState::kFaultReaction) return;
  state_ = PowerState::kSwitchOnDisabled;
}

void PowerStates::Restart() {
  state_ = PowerState::kNotReady;
  controlword_ = 0;
  reset_ = false;
}

// CiA 402: the commands are patterns of the controlword's bits 0 to 3.
PowerState PowerStates::Next() const {
  const bool switch_on = (controlword_ & 1u) != 0;
  const bool voltage = (controlword_ & 2u) != 0;
  const bool no_quick_stop = (controlword_ & 4u) != 0;
  const bool enable = (controlword_ & 8u) != 0;
  if (!voltage) return PowerState::kSwitchOnDisabled;
  if (state_ == PowerState::kQuickStop) return state_;
  if (!no_quick_stop) {
    return state_ == PowerState::kEnabled ? PowerState::kQuickStop : PowerState::kSwitchOnDisabled;
  }
  if (!switch_on) return PowerState::kReady;
  switch (state_) {
    case PowerState::kReady:
      return PowerState::kSwitchedOn;
    case PowerState::kSwitchedOn:
    case PowerState::kEnabled:
      return enable ? PowerState::kEnabled : PowerState::kSwitchedOn;
    default:
      return state_;
  }
}

void PowerStates::Step(uint64_t now_ns, bool permitted, bool at_rest) {
  if (now_ns - changed_ns_ < transition_ns_) return;
  const PowerState before = state_;
  switch (state_) {
    case PowerState::kNotReady:
      state_ = PowerState::kSwitchOnDisabled;
      break;
    case PowerState::kFaultReaction:
      if (at_rest) state_ = PowerState::kFault;
      break;
    case PowerState::kFault:
      if (reset_) state_ = PowerState::kSwitchOnDisabled;
      reset_ = false;
      break;
    case PowerState::kQuickStop:
      state_ = at_rest ? PowerState::kSwitchOnDisabled : Next();
      break;
    default:
      state_ = permitted ? Next() : PowerState::kSwitchOnDisabled;
  }
  if (state_ != PowerState::kFault) reset_ = false;
  if (state_ != before) changed_ns_ = now_ns;
}

uint16_t PowerStates::statusword(bool voltage, bool warning, bool remote,
                                 bool target_reached) const {
  unsigned word = 0;
  switch (state_) {
    case PowerState::kNotReady:
      word = 0x00;
      break;
    case PowerState::kSwitchOnDisabled:
      word = 0x40;
      break;
    case PowerState::kReady:
      word = 0x21;
      break;
    case PowerState::kSwitchedOn:
      word = 0x23;
      break;
    case PowerState::kEnabled:
      word = 0x27;
      break;
    case PowerState::kQuickStop:
      word = 0x07;
      break;
    case PowerState::kFaultReaction:
      word = 0x0f;
      break;
    case PowerState::kFault:
      word = 0x08;
      break;
  }
  word |= (voltage ? 0x10u : 0u) | (warning ? 0x80u : 0u) | (remote ? 0x200u : 0u) |
          (target_reached ? 0x400u : 0u);
  return static_cast<uint16_t>(word);
}

}  // namespace hardpack::sim
