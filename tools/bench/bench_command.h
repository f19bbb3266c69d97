// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack bench: how long each stage takes; and the movingai benchmark.
void AddBenchCommand(CLI::App& app);

}  // namespace hardpack::command
