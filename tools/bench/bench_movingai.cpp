// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_movingai.h"

#include <cstdio>
#include <iostream>
#include <memory>

#include "nlohmann/json.hpp"
#include "port_linux/command_line/command.h"
#include "tools/bench/movingai/movingai.h"

namespace hardpack::command {
namespace {

struct MovingaiOptions {
  std::string map;
  std::string scenarios;
  bool json = false;
};

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

void RunMovingaiProblems(const MovingaiOptions& options) {
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

void AddMovingaiCommand(CLI::App& bench) {
  CLI::App* movingai = bench.add_subcommand(
      "movingai",
      "Solve all problems of a movingai.com scenario file; exit code 1 unless every length is\n"
      "within 0.1 % of the listed one.");
  const auto options = std::make_shared<MovingaiOptions>();
  movingai->add_option("MAP", options->map, "The map (.map)")->required();
  movingai->add_option("SCEN", options->scenarios, "The scenarios (.scen)")->required();
  movingai->add_flag("--json", options->json, "Print one JSON object on stdout");
  movingai->callback([options] { RunMovingaiProblems(*options); });
}

}  // namespace hardpack::command
