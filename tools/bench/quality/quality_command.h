// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack bench quality: path quality and run time of our optimizers and others on the same
// problems.
void AddQualityCommand(CLI::App& bench);

}  // namespace hardpack::command
