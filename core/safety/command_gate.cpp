// SPDX-License-Identifier: Apache-2.0
#include "core/safety/command_gate.h"

#include "core/base/math.h"

namespace hardpack {

Status CommandGate::Configure(const GateLimits& limits) {
  *this = CommandGate{};
  const bool fits = IsFinite(limits.max_speed_radps) && limits.max_speed_radps > 0.0f &&
                    IsFinite(limits.max_acceleration_radps2) &&
                    limits.max_acceleration_radps2 > 0.0f;
  if (!fits) return Status::kParameterOutOfRange;
  limits_ = limits;
  configured_ = true;
  return Status::kOk;
}

float CommandGate::Limit(float wanted_radps, float last_radps, float change_radps, bool& is_fast,
                         bool& is_sudden) const {
  const float largest = limits_.max_speed_radps;
  const float slow = Clamp(wanted_radps, -largest, largest);
  is_fast = is_fast || slow != wanted_radps;
  const float gentle = Clamp(slow, last_radps - change_radps, last_radps + change_radps);
  is_sudden = is_sudden || gentle != slow;
  return gentle;
}

WheelCommand CommandGate::Pass(const WheelCommand& wanted, bool may_move, float dt_s) {
  const WheelCommand before = last_;
  last_ = WheelCommand{};
  if (!IsFinite(wanted.left_radps) || !IsFinite(wanted.right_radps)) {
    ++counters_.not_finite;
    has_fault_ = true;
    return last_;
  }
  if (wanted.left_radps == 0.0f && wanted.right_radps == 0.0f) return last_;
  if (!may_move) ++counters_.not_permitted;
  if (!configured_ || has_fault_ || !may_move || !IsFinite(dt_s) || dt_s <= 0.0f) return last_;
  const float change_radps = limits_.max_acceleration_radps2 * dt_s;
  bool is_fast = false;
  bool is_sudden = false;
  last_.left_radps = Limit(wanted.left_radps, before.left_radps, change_radps, is_fast, is_sudden);
  last_.right_radps =
      Limit(wanted.right_radps, before.right_radps, change_radps, is_fast, is_sudden);
  if (is_fast) ++counters_.above_speed;
  if (is_sudden) ++counters_.above_change;
  return last_;
}

}  // namespace hardpack
