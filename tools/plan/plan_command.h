// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack plan: plans on one lidar scan or one occupancy map, and draws pictures of it.
void AddPlanCommand(CLI::App& app);

}  // namespace hardpack::command
