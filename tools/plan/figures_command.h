// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack figures: the paper's figures that need no simulator.
void AddFiguresCommand(CLI::App& app);

}  // namespace hardpack::command
