// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_command.h"

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/bench/quality/quality_problems.h"
#include "tools/bench/quality/quality_report.h"
#include "tools/bench/quality/quality_solvers.h"
#include "tools/picture/quality_picture.h"

namespace hardpack::command {
namespace {

constexpr int kRounds = 5;
constexpr size_t kPictures = 12;

struct QualityOptions {
  std::string out;
  bool json = false;
  int problems = 100;
  std::vector<int> only;
  uint32_t seed = 1;
};

QualityProblem MakeProblem(uint32_t seed, int number, SeedMaker& maker) {
  std::optional<QualityProblem> problem = MakeQualityProblem(seed, number, maker);
  if (!problem) {
    throw CommandFailure(kWorkFailed, "no problem " + std::to_string(number) + " of seed " +
                                          std::to_string(seed) + " can be planned");
  }
  return *std::move(problem);
}

std::string Text(const char* format, double value) {
  std::array<char, 32> text = {};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

picture::QualityCurve CurveOf(const SolverName& solver, const QualityRun& run) {
  const QualityMeasures& measures = run.measures;
  return {.name = solver.text,
          .path = run.path,
          .figures = {
              Text("%.1f", double{measures.cost.total()}), Text("%.1f", double{measures.cost.map}),
              Text("%.1f", double{measures.cost.path}),
              Text("%.2f", double{measures.largest_curvature_per_m}),
              Text("%.2f", double{measures.largest_curvature_rate_per_m2}),
              measures.keeps_limits ? "kept" : "broken", Text("%.1f", double{measures.length_m}),
              measures.collides ? "collides" : Text("%.2f", double{measures.clearance_m}),
              Text("%.3f", double{measures.angle_per_m}), Text("%.2f", run.median_us / 1000.0)}};
}

std::string TitleOf(const QualityProblem& problem, int points) {
  std::string title = "Problem " + std::to_string(problem.number) + ": " + problem.kind + ", " +
                      std::to_string(points) + " points";
  if (problem.start.curvature_per_m != 0.0f) {
    title += Text(", start curvature %.2f 1/m", double{problem.start.curvature_per_m});
  }
  return title;
}

// The problem once more, with the paths that the solvers found on it.
void WritePicture(const QualityOptions& options, const PlannerParams& params,
                  const QualityResult& result, SeedMaker& maker) {
  const QualityProblem problem = MakeProblem(options.seed, result.number, maker);
  picture::QualityPicture picture;
  picture.map = &maker.map();
  picture.params = &params;
  picture.start = problem.start;
  picture.goal_odom = problem.goal_odom;
  picture.title = TitleOf(problem, maker.result().seed.size());
  if (problem.has_goal_heading) picture.goal_heading_rad = problem.goal_heading_rad;
  for (size_t i = 0; i < result.runs.size(); ++i) {
    picture.curves.push_back(CurveOf(Solvers()[i], result.runs[i]));
  }
  const std::string number = std::to_string(1000 + result.number).substr(1);
  Require(picture::DrawQuality(picture).WritePng(options.out + "/quality_" + number + ".png"));
}

// Ceres is another library and may do both.
void RequireNoFailureOfOurOwn(const std::vector<QualityResult>& results) {
  for (const QualityResult& result : results) {
    for (const SolverId id : {SolverId::kPaper, SolverId::kPaperConverged, SolverId::kOurs}) {
      const QualityRun& run = result.of(id);
      if (run.usable && run.allocations == 0) continue;
      throw CommandFailure(
          kWorkFailed, "an optimizer " + std::string(run.usable ? "allocated memory" : "failed") +
                           " on problem " + std::to_string(result.number));
    }
  }
}

void RunQuality(const QualityOptions& options) {
  if (!options.out.empty()) MakeOutputFolder(options.out);
  const PlannerParams params;
  SeedMaker maker(params);
  QualityBench bench(params, kRounds);
  std::vector<QualityResult> results;
  std::vector<int> numbers = options.only;
  for (int number = 1; options.only.empty() && number <= options.problems; ++number) {
    numbers.push_back(number);
  }
  for (const int number : numbers) {
    const QualityProblem problem = MakeProblem(options.seed, number, maker);
    results.push_back({number, problem.kind, bench.Solve(problem, maker)});
  }
  if (!options.out.empty()) {
    const SolverId other = Solvers().back().id == SolverId::kOurs ? SolverId::kPaperConverged
                                                                  : SolverId::kCeresSquares;
    for (const size_t index : MostTelling(results, other, kPictures)) {
      WritePicture(options, params, results[index], maker);
    }
  }
  if (options.json) {
    std::cout << QualityToJson(results, options.seed).dump() << "\n";
  } else {
    PrintQuality(results);
  }
  RequireNoFailureOfOurOwn(results);
}

}  // namespace

void AddQualityCommand(CLI::App& bench) {
  CLI::App* quality = bench.add_subcommand(
      "quality",
      "Measure path quality and run time: A* alone, the paper's optimizer, ours, and Ceres if it\n"
      "is installed, all from the same seeds on a hundred synthetic problems.");
  const auto options = std::make_shared<QualityOptions>();
  quality->add_option("--out", options->out, "Folder for pictures of a dozen problems");
  quality->add_flag("--json", options->json, "Print one JSON object on stdout");
  quality->add_option("--problems", options->problems, "Number of problems (default 100)")
      ->check(CLI::Range(1, 999));
  quality->add_option("--problem", options->only, "Only this problem; may be repeated")
      ->check(CLI::Range(1, 999));
  quality->add_option("--seed", options->seed, "Seed of the problems (default 1)");
  quality->callback([options] { RunQuality(*options); });
}

}  // namespace hardpack::command
