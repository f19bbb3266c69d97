// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack fit: fits the simulator's vehicle to a recorded drive.
void AddFitCommand(CLI::App& app);

}  // namespace hardpack::command
