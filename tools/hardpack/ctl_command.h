// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// `hardpack ctl ...`: talks to hardpackd over its control socket (docs/control.md). Exit code 1: it
// refused; 2: bad usage, or it cannot be reached or does not answer.
void AddCtlCommand(CLI::App& app);

}  // namespace hardpack::command
