// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/bench/bench_row.h"

// What the stages promise, held against what a run measured. It informs: times on a machine that
// others use are no test (the counts of test/instructions are).

namespace hardpack::command {

struct Acceptance {
  std::string promise;
  std::string measured;     // figures, or what is missing
  std::optional<bool> met;  // none: the run does not have what it needs
};

// Each promise, in the order of the stages. allocations_counted: else nothing is known of them.
std::vector<Acceptance> JudgeRows(const std::vector<BenchRow>& rows, bool allocations_counted);

}  // namespace hardpack::command
