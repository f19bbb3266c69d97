// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack scene: a recording of the project's own, for where there is no other.
void AddSceneCommand(CLI::App& app);

}  // namespace hardpack::command
