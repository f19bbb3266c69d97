// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The last stage that a wheel command passes, and the only way to the drives: whatever was computed
// before, its output is finite, within the wheels' limits, and zero where the vehicle may not move
// (docs/safety.md). It computes no command and does not decide whether to move. Ours.

namespace hardpack {

struct GateLimits {
  float max_speed_radps = 0.0f;          // of a wheel, either way
  float max_acceleration_radps2 = 0.0f;  // change of a wheel's command over time
};

struct GateCounters {
  uint32_t not_finite = 0;     // commands that were not numbers: zero was sent
  uint32_t above_speed = 0;    // commands clamped for a wheel's speed ...
  uint32_t above_change = 0;   // ... and for the change since the previous one
  uint32_t not_permitted = 0;  // commands to move that came without permission
};

class CommandGate {
 public:
  // The previous command is zero and there is no fault. kParameterOutOfRange: a limit that is not
  // finite or not positive: then only zero passes.
  Status Configure(const GateLimits& limits);

  // The command to send instead of `wanted`, dt_s after the last one. Zero for both wheels passes
  // at once, however fast they turn: that is a stop. Anything else changes each wheel's command by
  // at most max_acceleration_radps2 dt_s. A wheel that is not finite makes both zero, and raises a
  // fault that stays until ClearFault. Also zero if may_move is false, if dt_s is not finite or not
  // positive, and while there is a fault. Constant cost.
  WheelCommand Pass(const WheelCommand& wanted, bool may_move, float dt_s);

  // A command was not a number.
  bool has_fault() const { return has_fault_; }
  void ClearFault() { has_fault_ = false; }

  const WheelCommand& last() const { return last_; }
  const GateCounters& counters() const { return counters_; }

 private:
  float Limit(float wanted_radps, float last_radps, float change_radps, bool& is_fast,
              bool& is_sudden) const;

  GateLimits limits_;
  bool configured_ = false;
  bool has_fault_ = false;
  WheelCommand last_;
  GateCounters counters_;
};
static_assert(std::is_trivially_copyable_v<CommandGate>);

}  // namespace hardpack
