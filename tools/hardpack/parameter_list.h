// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "config/parameters.h"
#include "nlohmann/json.hpp"

// The parameters as the command line sees them: by name, checked against the one table of ranges.

namespace hardpack::command {

struct Parameters {
  PlannerParams planner;
  LidarMountParams mount;
};

// "group.name=value" for each; a CommandFailure (bad input) for an unknown name (with the nearest
// known one), a value that is no number or a value out of the table's range.
void SetParameters(const std::vector<std::string>& assignments, Parameters& parameters);

// {"costmap": {"halo_m": 2.0, ...}, ...}
nlohmann::json ParametersToJson(const Parameters& parameters);

}  // namespace hardpack::command
