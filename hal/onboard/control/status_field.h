// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Properties of a StatusReport field beyond its type (status_table.h).

namespace hardpack::control {

// How to show a value, beyond what its type says.
enum class FieldKind : uint8_t {
  kValue = 0,  // a number in the unit of its name, a flag, a text
  kDuration,   // ns
  kHex,
  kNanodegree,
  kAge,
  // Codes of the enums with these names.
  kMode,
  kStopReason,
  kMotion,
  kStatus,
  kReplanDecision,
  kReplanReason,
  kInsMode,
  kDriveState,
  kDriveFault,
  kNmtState,
  kCanBusState,
  kMapStatus,
  kControllerState,
  kControllerFault,
};

// When a value needs attention. (Ages indicate this themselves.)
enum class Concern : uint8_t {
  kNone = 0,
  kLoss,      // a counter; not 0: something was lost or refused since the start
  kProblem,   // not 0, or a code that indicates trouble: something is wrong now
  kExpected,  // 0: something is missing now
};

}  // namespace hardpack::control
