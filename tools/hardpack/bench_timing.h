// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

#include "tools/hardpack/allocation_counter.h"
#include "tools/hardpack/bench_stages.h"

namespace hardpack::command {

inline constexpr double kBudget_s = 0.5;  // of measured time, a row
inline constexpr int kLeastRepetitions = 20;
inline constexpr int kMostRepetitions = 2000;

// Calls prepare() unmeasured and run() measured, again and again until the budget is spent, and
// fills in the figures of `row`. The first call warms the caches and is not counted.
template <typename Prepare, typename RunOnce>
void MeasureRow(Prepare&& prepare, RunOnce&& run, BenchRow& row) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times_us;
  times_us.reserve(kMostRepetitions);
  prepare();
  run();
  double spent_us = 0.0;
  while (row.repetitions < kMostRepetitions &&
         (row.repetitions < kLeastRepetitions || spent_us < kBudget_s * 1.0e6)) {
    prepare();
    const int64_t allocations_before = AllocationCount();
    const Clock::time_point before = Clock::now();
    run();
    const Clock::time_point after = Clock::now();
    row.allocations += AllocationCount() - allocations_before;
    times_us.push_back(std::chrono::duration<double, std::micro>(after - before).count());
    spent_us += times_us.back();
    ++row.repetitions;
  }
  std::sort(times_us.begin(), times_us.end());
  const auto at_share = [&times_us](double share) {
    return times_us[static_cast<size_t>(share * static_cast<double>(times_us.size() - 1) + 0.5)];
  };
  row.median_us = at_share(0.5);
  row.p99_us = at_share(0.99);
  row.worst_us = times_us.back();
}

}  // namespace hardpack::command
