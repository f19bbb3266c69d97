// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/segmentation/label_table.h"
#include "nlohmann/json.hpp"

// The parameters on the command line: by name, checked against the one table of ranges.

namespace hardpack::command {

struct Parameters {
  PlannerParams planner;
  PerceptionParams perception;
  LabelTable labels = RellisLabelTable();
};

// "group.name=value" for each, or "labels.CODE=CLASS" (ignored, ground, soft, hard, person); a
// CommandFailure (bad input) for an unknown name (with the nearest known one), a value that is not
// a number, or one out of the table's range.
void SetParameters(const std::vector<std::string>& assignments, Parameters& parameters);

// {"costmap": {"halo_m": 2.0, ...}, ..., "labels": {"ignored": [0, 7], ...}}; codes that are not
// listed are hard.
nlohmann::json ParametersToJson(const Parameters& parameters);

}  // namespace hardpack::command
