// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// hardpack plan: one lidar scan, or one occupancy map, to one plan with its pictures.
void AddPlanCommand(CLI::App& app);

}  // namespace hardpack::command
