// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The state machine of the power drive system (CiA 402), as a device follows it: one transition at
// a time, each of which takes a while (contactors, brake).
//
//                        shutdown          switch on            enable operation
//   switch on disabled ------------> ready ----------> switched on ------------> enabled
//         ^   ^               disable voltage, from any of them |                   | quick stop
//         |   +-----------------------------------------------------------------  quick stop active
//         +-- fault reset -- fault <-- fault reaction <-- from anywhere

namespace hardpack::sim {

enum class PowerState : uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReady,
  kSwitchedOn,
  kEnabled,
  kQuickStop,
  kFaultReaction,
  kFault,
};

const char* Name(PowerState state);

class PowerStates {
 public:
  explicit PowerStates(uint64_t transition_ns) : transition_ns_(transition_ns) {}

  // As received; a rising edge of bit 7 resets a fault.
  void SetControlword(uint16_t controlword);

  // `permitted`: the device is operational and has its supply. `at_rest`: the motor stands still.
  void Step(uint64_t now_ns, bool permitted, bool at_rest);

  void RaiseFault();
  // Leaves any enabled state, without a fault.
  void Disable();
  void Restart();

  PowerState state() const { return state_; }
  bool driven() const;  // the motor is powered: it follows a speed, even zero
  uint16_t controlword() const { return controlword_; }
  uint16_t statusword(bool voltage, bool warning, bool remote, bool target_reached) const;

 private:
  PowerState Next() const;

  uint64_t transition_ns_;
  uint64_t changed_ns_ = 0;
  PowerState state_ = PowerState::kNotReady;
  uint16_t controlword_ = 0;
  bool reset_ = false;  // requested, not yet executed
};

}  // namespace hardpack::sim
