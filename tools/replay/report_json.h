// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nlohmann/json.hpp"
#include "tools/replay/replay.h"

// replay.json (docs/flight_log.md).

namespace hardpack::replay {

// As 16 digits, "0123456789abcdef".
std::string HashText(uint64_t hash);

nlohmann::json ReportToJson(const Report& report, const Pilot& pilot);

}  // namespace hardpack::replay
