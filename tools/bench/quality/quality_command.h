// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack bench quality: how good the paths are, and how fast they are found, of our optimizers
// and others on the same problems.
void AddQualityCommand(CLI::App& bench);

}  // namespace hardpack::command
