// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/planner_run.h"

#include <chrono>
#include <numeric>

namespace hardpack::command {
namespace {

constexpr int kSliceUnits = Planner::kPortion_units;

template <typename StepSlice>
StageTimes Run(const Planner& planner, StepSlice&& step_slice) {
  using Clock = std::chrono::steady_clock;
  StageTimes times;
  Progress progress = Progress::kBusy;
  Clock::time_point before = Clock::now();
  while (progress == Progress::kBusy) {
    const auto stage = static_cast<size_t>(planner.stage());
    progress = step_slice();
    const Clock::time_point after = Clock::now();
    times.us[stage] += std::chrono::duration<double, std::micro>(after - before).count();
    before = after;
  }
  return times;
}

}  // namespace

double StageTimes::total_us() const {
  return std::accumulate(us.begin(), us.end(), 0.0);
}

StageTimes RunToEnd(Planner& planner, const Mapper& mapper) {
  return Run(planner, [&] { return planner.Step(mapper, kSliceUnits); });
}

StageTimes RunCellsToEnd(Planner& planner) {
  return Run(planner, [&] { return planner.StepCells(kSliceUnits); });
}

}  // namespace hardpack::command
