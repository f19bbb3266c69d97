// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "tools/bench/bench_acceptance.h"
#include "tools/bench/bench_row.h"

// A run of `hardpack bench` as text, as JSON and as tables for the README.

namespace hardpack::command {

struct BenchReport {
  std::string data;                // the folder of recordings; empty: none
  std::vector<std::string> peers;  // that this build has
  std::vector<BenchRow> rows;      // in the order of the stages
  std::vector<Acceptance> acceptance;
};

// Every row, then the promises with their measurements.
void PrintReport(const BenchReport& report);

// A line for each stage (over its scenes), then the promises.
void PrintMarkdown(const BenchReport& report);

nlohmann::json ReportToJson(const BenchReport& report);

}  // namespace hardpack::command
