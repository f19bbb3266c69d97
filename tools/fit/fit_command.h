// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack fit: the simulator's vehicle out of a recorded drive.
void AddFitCommand(CLI::App& app);

}  // namespace hardpack::command
