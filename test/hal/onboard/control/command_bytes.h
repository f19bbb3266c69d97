// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/status.h"
#include "hal/onboard/control/messages.h"

namespace hardpack::control {

// An operator's command as its bytes, with one waypoint where it is a goal. Empty where there is no
// such message.
inline std::vector<uint8_t> CommandBytes(Kind kind, uint32_t sequence, Vec2 goal_odom = {}) {
  OperatorCommand command;
  command.kind = kind;
  command.sequence = sequence;
  if (kind == Kind::kGoal) {
    command.waypoints = 1;
    command.waypoint[0].frame = GoalFrame::kOdom;
    command.waypoint[0].position_m = goal_odom;
  }
  std::vector<uint8_t> bytes(kMaxMessageBytes);
  int size_bytes = 0;
  if (!IsUsable(Encode(command, bytes, size_bytes))) return {};
  bytes.resize(static_cast<size_t>(size_bytes));
  return bytes;
}

}  // namespace hardpack::control
