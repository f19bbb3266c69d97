// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/base/status.h"

namespace hardpack {

// The result of opening a bus or a socket at start-up. Each text is one line for the operator.
struct [[nodiscard]] OpenOutcome {
  Status status = Status::kOk;
  std::string message;                // failed: why; opened: what, as the kernel reports it
  std::vector<std::string> warnings;  // opened, but not everything requested

  bool ok() const { return IsUsable(status); }
};

}  // namespace hardpack
