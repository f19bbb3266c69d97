// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack sim: one mission in a simulated world, faster than real time.
void AddSimCommand(CLI::App& app);

}  // namespace hardpack::command
