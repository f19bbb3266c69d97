// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"

// Measures the stages of planning one by one, as they follow one another on a scene.

namespace hardpack::command {

struct BenchRow {
  std::string stage;
  std::string scene;
  Status status = Status::kOk;  // how the stage ended
  double median_us = 0.0;
  double p99_us = 0.0;
  double worst_us = 0.0;
  int repetitions = 0;
  size_t object_bytes = 0;  // sizeof of the stage's object
  int64_t allocations = 0;  // on the heap, during all measured calls together
};

// The names that MeasureStages knows, in the order of the data's walk.
const std::vector<std::string>& BenchStageNames();

// Every scene for each of the stages named (decode and scan: one recorded revolution). A stage that
// has no input on a scene, because one before it found no path, is left out.
std::vector<BenchRow> MeasureStages(const std::vector<std::string>& stages);

}  // namespace hardpack::command
