// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/autonomy/mapper.h"
#include "core/autonomy/planner.h"
#include "test/decision/report.h"

namespace hardpack::decision {

// The lines that one planning prints.
struct PlanNames {
  const char* costmap;
  const char* plan;
};

// Plans on a mapper's map with the default parameters; adds the costmap's cells and the plan.
void PlanOnMap(const Mapper& mapper, const PlanRequest& request, const PlanNames& names,
               Report& report);

}  // namespace hardpack::decision
