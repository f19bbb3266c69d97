// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

// `hardpack world`: a simulated world as a picture (docs/simulation.md).

namespace hardpack::command {

void AddWorldCommand(CLI::App& app);

}  // namespace hardpack::command
