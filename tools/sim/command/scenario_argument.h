// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tools/sim/world/named_worlds.h"

// A world as it is named on the command line: one of world::WorldNames(), or a map of ROS
// map_server (FILE.yaml) with --start and --goal.

namespace hardpack::command {

struct ScenarioOptions {
  std::string start = "0,0";  // X,Y[,THETA] on a map
  std::string goal;           // X,Y on a map; empty: the start
};

// An unknown name and errors in a map or a place are a CommandFailure (bad input).
world::Scenario ScenarioOf(const std::string& name, uint64_t seed, const ScenarioOptions& options);

}  // namespace hardpack::command
