// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack experiment: missions over many seeds, and a table of their results.
void AddExperimentCommand(CLI::App& app);

}  // namespace hardpack::command
