// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.h"

namespace hardpack {

// How opening a bus or a socket at start-up ended. Each text is one line for the operator.
struct [[nodiscard]] OpenOutcome {
  Status status = Status::kOk;
  std::string message;                // failed: why; opened: what, as the kernel tells it
  std::vector<std::string> warnings;  // opened, but not all that was asked for

  bool ok() const { return IsUsable(status); }
};

}  // namespace hardpack
