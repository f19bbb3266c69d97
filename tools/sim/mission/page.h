// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nlohmann/json.hpp"
#include "tools/sim/experiment/run_result.h"
#include "tools/sim/mission/mission.h"

// A mission as one HTML page that loads nothing: map, plans and plots over time
// (docs/simulation.md). The page itself is in tools/sim/mission/page; this is its data.

namespace hardpack::mission {

// All data of the page: `run` is run.json, the rest is named as in MissionTrace. Lengths are
// rounded to centimetres, other numbers to thousandths.
nlohmann::ordered_json PageData(const MissionSettings& settings,
                                const experiment::RunResult& result, const MissionTrace& trace);

// The page around that data. No text in the data can end the element that contains it.
std::string PageOf(const nlohmann::ordered_json& data);

}  // namespace hardpack::mission
