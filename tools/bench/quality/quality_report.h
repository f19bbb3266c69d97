// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "tools/bench/quality/quality_solvers.h"

// The results of the quality benchmark: a table of all solvers, and our optimizer compared with the
// others problem by problem.

namespace hardpack::command {

// A solved problem; the problem itself can be generated again.
struct QualityResult {
  int number = 0;
  std::string kind;
  std::vector<QualityRun> runs;  // one for each of Solvers()

  const QualityRun& of(SolverId id) const;
};

// Our optimizer beside another solver.
struct HeadToHead {
  int no_worse = 0;                // problems with F equal or lower
  int problems = 0;                // compared
  double median_cost_share = 0.0;  // F of ours over F of the other
  double worst_cost_share = 0.0;
  int worst_cost_problem = 0;
  double median_speed_up = 0.0;  // time of the other over time of ours, problem by problem
  double least_speed_up = 0.0;
  int least_speed_up_problem = 0;
  std::vector<int> limits_lost;  // the other keeps the limits and ours does not
};

HeadToHead Compare(const std::vector<QualityResult>& results, SolverId other);

// Problems worth drawing: up to a quarter of them those in which the paper's optimizer keeps the
// limits and ours does not; of the rest, by F relative to `other`, a third our largest wins, a
// third around the median, a third our largest losses. Indices into `results`, none twice.
std::vector<size_t> MostTelling(const std::vector<QualityResult>& results, SolverId other,
                                size_t wanted);

void PrintQuality(const std::vector<QualityResult>& results);
nlohmann::json QualityToJson(const std::vector<QualityResult>& results, uint32_t seed);

}  // namespace hardpack::command
