// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "tools/sim/script/script_words.h"

// The script commands for a vehicle's motion controller (script.h).

namespace hardpack::sim::script {

void AddControllerCommands(std::map<std::string, Command>& commands);

}  // namespace hardpack::sim::script
