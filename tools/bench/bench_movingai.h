// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack bench movingai: every problem of a scenario file against its listed length.
void AddMovingaiCommand(CLI::App& bench);

}  // namespace hardpack::command
