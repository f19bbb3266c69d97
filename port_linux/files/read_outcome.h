// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/status.h"

namespace hardpack {

// The result of reading a file: the status, and on failure one line for the operator that names the
// file and the field ("scan.json: beam_altitude_angles: 63 numbers, expected 64").
struct [[nodiscard]] ReadOutcome {
  Status status = Status::kOk;
  std::string message;

  bool ok() const { return IsUsable(status); }
};

}  // namespace hardpack
