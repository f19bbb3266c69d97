// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/bench_row.h"

// The stages' promises, compared with the measurements of a run. For information only: times on a
// shared machine are not a test (the counts of test/instructions are).

namespace hardpack::command {

struct Acceptance {
  std::string promise;
  std::string measured;     // figures, or what is missing
  std::optional<bool> met;  // none: the run lacks the data
};

// Each promise, in the order of the stages. allocations_counted: false if they are unknown.
std::vector<Acceptance> JudgeRows(const std::vector<BenchRow>& rows, bool allocations_counted);

}  // namespace hardpack::command
