// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "core/autonomy/mapper.h"
#include "core/autonomy/planner.h"

// Runs a Planner that has begun to its end, and measures the time of each stage.

namespace hardpack::command {

// Wall clock, microseconds, by PlanStage.
struct StageTimes {
  std::array<double, static_cast<size_t>(PlanStage::kDone) + 1> us = {};

  double of(PlanStage stage) const { return us[static_cast<size_t>(stage)]; }
  double total_us() const;
};

// The planner is stepped in slices, and a slice counts for the stage in which it began. A slice is
// short compared with a stage, so the error at each boundary is below one percent of either stage.
StageTimes RunToEnd(Planner& planner, const Mapper& mapper);
StageTimes RunCellsToEnd(Planner& planner);

}  // namespace hardpack::command
