// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace hardpack::command {

// The commands of `hardpackctl` and `hardpack ctl`, which talk to hardpackd over its control socket
// (docs/control.md). Exit code 1: it refused; 2: bad usage, or it cannot be reached or does not
// answer. The app's footer says so.
void AddCtlCommands(CLI::App& app);

}  // namespace hardpack::command
