// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "hal/onboard/control/status_table.h"

// The codes of the operator's messages in words.

namespace hardpack::ctl {

struct CodeName {
  const char* name = "unknown";  // snake_case, as in JSON
  const char* words = "";        // for a person; empty where the name says it
  bool is_problem = false;
};

// Of a field of that kind; "unknown" for a code that is none of its enum's, or a kind that has no
// codes.
CodeName NameOf(control::FieldKind kind, uint8_t code);

// What a refused command is told: "lidar_old: no lidar column lately", or by its status where there
// is no reason.
const char* WordsOf(Status status);

}  // namespace hardpack::ctl
