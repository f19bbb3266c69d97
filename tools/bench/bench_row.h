// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/status.h"

// The results of `hardpack bench`: one row for each stage on each scene.

namespace hardpack::command {

// Another library on the same input, measured alternately with the stage.
struct PeerFigure {
  std::string name;
  double median_us = 0.0;
  int repetitions = 0;
  double path_cost = 0.0;  // F of its path; optimizers only
  double ratio = 0.0;      // its time over the stage's: sums of the inputs' medians
};

struct BenchRow {
  std::string stage;
  std::string scene;
  Status status = Status::kOk;  // of the stage; the most severe of several queries
  double median_us = 0.0;
  double p99_us = 0.0;
  double worst_us = 0.0;
  int repetitions = 0;
  size_t object_bytes = 0;  // sizeof of the stage's object
  int64_t allocations = 0;  // on the heap, during all measured calls together
  int queries = 0;          // start and goal pairs used in turn; 0: the stage has none
  bool dilated = true;      // by the vehicle's planning radius; see StageChain
  // 0 where they do not apply.
  double expansions = 0.0;        // the mean of the queries
  double ns_per_expansion = 0.0;  // over all queries
  int points = 0;                 // of the path
  double path_cost = 0.0;         // F of the path
  std::vector<PeerFigure> peers = {};
};

}  // namespace hardpack::command
