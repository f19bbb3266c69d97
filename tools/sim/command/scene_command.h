// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack scene: the project's own synthetic recording, for use when there is no other.
void AddSceneCommand(CLI::App& app);

}  // namespace hardpack::command
