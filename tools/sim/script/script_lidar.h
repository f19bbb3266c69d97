// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "tools/sim/script/script_words.h"

// The script commands for the lidar only: its clock, its faults and the weather.

namespace hardpack::sim::script {

void AddLidarCommands(std::map<std::string, Command>& commands);

}  // namespace hardpack::sim::script
