// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/bench_command.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>

#include "nlohmann/json.hpp"
#include "tools/hardpack/allocation_counter.h"
#include "tools/hardpack/arguments.h"
#include "tools/hardpack/bench_stages.h"
#include "tools/hardpack/command.h"
#include "tools/hardpack/quality_command.h"
#include "tools/movingai/movingai.h"

namespace hardpack::command {
namespace {

struct BenchOptions {
  std::vector<std::string> stages;
  std::string map;
  std::string scenarios;
  bool json = false;
};

void CheckStageNames(const std::vector<std::string>& stages) {
  const auto& names = BenchStageNames();
  for (const std::string& stage : stages) {
    if (std::find(names.begin(), names.end(), stage) != names.end()) continue;
    const std::string nearest = NearestName(stage, names);
    throw CommandFailure(kBadInput,
                         "STAGE: there is no stage '" + stage + "'" +
                             (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
  }
}

nlohmann::json RowsToJson(const std::vector<BenchRow>& rows) {
  nlohmann::json list = nlohmann::json::array();
  for (const BenchRow& row : rows) {
    list.push_back({{"stage", row.stage},
                    {"scene", row.scene},
                    {"status", StatusName(row.status)},
                    {"median_us", row.median_us},
                    {"p99_us", row.p99_us},
                    {"worst_us", row.worst_us},
                    {"repetitions", row.repetitions},
                    {"object_bytes", row.object_bytes},
                    {"allocations", row.allocations}});
  }
  return {{"version", HARDPACK_VERSION},
          {"compiler", __VERSION__},
          {"allocations_counted", AllocationsAreCounted()},
          {"rows", list}};
}

void PrintRows(const std::vector<BenchRow>& rows) {
  std::printf("%-10s %-11s %12s %12s %12s %6s %9s %6s  %s\n", "stage", "scene", "median [us]",
              "p99 [us]", "worst [us]", "runs", "sizeof", "allocs", "ended");
  for (const BenchRow& row : rows) {
    std::printf("%-10s %-11s %12.1f %12.1f %12.1f %6d %9zu %6lld  %s\n", row.stage.c_str(),
                row.scene.c_str(), row.median_us, row.p99_us, row.worst_us, row.repetitions,
                row.object_bytes, static_cast<long long>(row.allocations), StatusName(row.status));
  }
}

void RunBench(const BenchOptions& options) {
  CheckStageNames(options.stages);
  const auto rows = MeasureStages(options.stages.empty() ? BenchStageNames() : options.stages);
  if (options.json) {
    std::cout << RowsToJson(rows).dump() << "\n";
  } else {
    PrintRows(rows);
  }
  for (const BenchRow& row : rows) {
    if (row.allocations == 0) continue;
    throw CommandFailure(kWorkFailed, row.stage + " on " + row.scene + " allocated memory");
  }
}

nlohmann::json MovingaiToJson(const MovingaiReport& report) {
  return {{"problems", report.problems},
          {"solved", report.solved},
          {"mismatches", report.mismatches},
          {"largest_relative_error", report.largest_relative_error},
          {"first_mismatch", report.first_mismatch},
          {"expansions", report.expansions},
          {"total_us", static_cast<double>(report.total_ns) / 1000.0},
          {"median_us", static_cast<double>(report.median_ns) / 1000.0},
          {"worst_us", static_cast<double>(report.worst_ns) / 1000.0}};
}

void RunMovingaiBench(const BenchOptions& options) {
  const auto outcome = RunMovingai(options.map, options.scenarios);
  if (const auto* reason = std::get_if<std::string>(&outcome)) {
    throw CommandFailure(kBadInput, *reason);
  }
  const auto& report = std::get<MovingaiReport>(outcome);
  if (options.json) {
    std::cout << MovingaiToJson(report).dump() << "\n";
  } else {
    std::printf("%s: %d of %d solved, largest error %.4f %%, median %.0f us, worst %.0f us\n",
                options.scenarios.c_str(), report.solved, report.problems,
                100.0 * report.largest_relative_error,
                static_cast<double>(report.median_ns) / 1000.0,
                static_cast<double>(report.worst_ns) / 1000.0);
  }
  if (report.mismatches > 0) {
    throw CommandFailure(kWorkFailed, std::to_string(report.mismatches) +
                                          " mismatches, the first: " + report.first_mismatch);
  }
}

}  // namespace

void AddBenchCommand(CLI::App& app) {
  CLI::App* bench = app.add_subcommand(
      "bench",
      "Measure the stages on built-in maps: median, p99 and worst time, size of each stage's\n"
      "object, heap allocations during the measured calls (exit code 1 when there is one).\n"
      "Scenes: random_10, random_25, random_40, forest, maze, open; a lidar revolution for "
      "decode, column and costmap.");
  const auto options = std::make_shared<BenchOptions>();
  bench->add_option("STAGE", options->stages,
                    "decode, column, costmap, astar, sample, optimizer, speed, check, plan; all of "
                    "them when none is named");
  bench->add_flag("--json", options->json, "Print one JSON object on stdout");
  CLI::App* movingai = bench->add_subcommand(
      "movingai",
      "Solve all problems of a movingai.com scenario file; exit code 1 unless every length is\n"
      "within 0.1 % of the listed one.");
  movingai->add_option("MAP", options->map, "The map (.map)")->required();
  movingai->add_option("SCEN", options->scenarios, "The scenarios (.scen)")->required();
  movingai->add_flag("--json", options->json, "Print one JSON object on stdout");
  movingai->callback([options] { RunMovingaiBench(*options); });
  AddQualityCommand(*bench);
  bench->callback([options, bench] {
    if (bench->get_subcommands().empty()) RunBench(*options);
  });
}

}  // namespace hardpack::command
