// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/autonomy/planner.h"
#include "core/costmap/height_grid.h"
#include "test/decision/report.h"

namespace hardpack::decision {

// The lines that one planning prints.
struct PlanNames {
  const char* costmap;
  const char* plan;
};

// Plans on heights with the default parameters; adds the costmap's cells and the plan.
void PlanOnHeights(const HeightGrid& heights, const PlanRequest& request, const PlanNames& names,
                   Report& report);

}  // namespace hardpack::decision
