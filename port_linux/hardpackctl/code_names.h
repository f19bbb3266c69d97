// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "hal/onboard/control/status_table.h"

// The codes of the operator's messages in words.

namespace hardpack::ctl {

struct CodeName {
  const char* name = "unknown";  // snake_case, as in JSON
  const char* words = "";        // for a person; empty if the name is enough
  bool is_problem = false;
};

// The name for a field of that kind; "unknown" for a code outside its enum, or a kind that has no
// codes.
CodeName NameOf(control::FieldKind kind, uint8_t code);

// The text for a refused command: "lidar_old: no lidar column lately", or by its status if there is
// no reason.
const char* WordsOf(Status status);

}  // namespace hardpack::ctl
