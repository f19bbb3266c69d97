// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_acceptance.h"

#include <algorithm>
#include <array>

#include "tools/bench/bench_recordings.h"
#include "tools/bench/bench_stages.h"
#include "tools/bench/bench_text.h"

namespace hardpack::command {
namespace {

constexpr double kCostmapRatio = 8.0;
constexpr double kCostmapWorst = 3.0;
constexpr double kAstarRatio = 5.0;
constexpr double kAstar_ns = 60.0;
constexpr double kOptimizerRatio = 40.0;
constexpr double kSpeed_us = 2.0;
constexpr double kReplan_us = 8000.0;
constexpr int kLeastPoints = 190;  // of "200 points"

// A figure and the scene that it is of.
struct Figure {
  std::string scene;
  double value = 0.0;
};

std::vector<BenchRow> RowsOf(const std::vector<BenchRow>& rows, const std::string& stage) {
  std::vector<BenchRow> found;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(found),
               [&stage](const BenchRow& row) { return row.stage == stage; });
  return found;
}

bool Less(const Figure& a, const Figure& b) {
  return a.value < b.value;
}

// For each row the peer that finds the best path, if they differ in that.
std::vector<Figure> RatiosOf(const std::vector<BenchRow>& rows) {
  std::vector<Figure> ratios;
  for (const BenchRow& row : rows) {
    const auto best = std::min_element(
        row.peers.begin(), row.peers.end(),
        [](const PeerFigure& a, const PeerFigure& b) { return a.path_cost < b.path_cost; });
    if (best != row.peers.end()) ratios.push_back({row.scene, best->ratio});
  }
  return ratios;
}

// Of at least one.
double Median(std::vector<Figure> figures) {
  std::sort(figures.begin(), figures.end(), Less);
  return figures[figures.size() / 2].value;
}

Acceptance NotMeasured(const std::string& promise, const std::string& missing) {
  return {promise, "not measured: needs " + missing, std::nullopt};
}

Acceptance JudgeCostmap(const std::vector<BenchRow>& costmaps) {
  const std::string promise =
      Format("costmap from heights: at least %g times as fast as OpenCV's precise transform twice",
             kCostmapRatio);
  const std::array<std::string, 5> scenes = {"random_10", "random_40", "cells_10", "cells_40",
                                             kRellisScene};
  const std::vector<Figure> ratios = RatiosOf(costmaps);
  Acceptance acceptance = {promise, "", true};
  for (const std::string& scene : scenes) {
    const auto found = std::find_if(ratios.begin(), ratios.end(),
                                    [&scene](const Figure& f) { return f.scene == scene; });
    if (found == ratios.end()) return NotMeasured(promise, "OpenCV and the scene " + scene);
    if (!acceptance.measured.empty()) acceptance.measured += ", ";
    acceptance.measured += Format("%s %.1f", scene.c_str(), found->value);
    acceptance.met = *acceptance.met && found->value >= kCostmapRatio;
  }
  return acceptance;
}

// The revolution's map is left out: it has a revolution of columns pending, which are marked too.
Acceptance JudgeCostmapWorst(const std::vector<BenchRow>& costmaps) {
  const std::string promise =
      Format("costmap: the worst time over all maps at most %g times the median", kCostmapWorst);
  std::vector<Figure> medians;
  Figure worst;
  for (const BenchRow& row : costmaps) {
    if (row.scene == kRevolutionScene) continue;
    medians.push_back({row.scene, row.median_us});
    worst = std::max(worst, Figure{row.scene, row.worst_us}, Less);
  }
  if (medians.empty()) return NotMeasured(promise, "the stage costmap");
  const double median_us = Median(medians);
  return {promise,
          Format("%.2f times (%.0f us on %s, median %.0f us; largest median %.0f us)",
                 worst.value / median_us, worst.value, worst.scene.c_str(), median_us,
                 std::max_element(medians.begin(), medians.end(), Less)->value),
          worst.value <= kCostmapWorst * median_us};
}

Acceptance JudgeAstarRatio(const std::vector<BenchRow>& searches) {
  const std::string promise =
      Format("astar: at least %g times as fast as Boost's on every map", kAstarRatio);
  const std::vector<Figure> ratios = RatiosOf(searches);
  if (ratios.empty()) return NotMeasured(promise, "Boost and the stage astar");
  const Figure least = *std::min_element(ratios.begin(), ratios.end(), Less);
  return {promise,
          Format("least %.1f on %s, median %.1f", least.value, least.scene.c_str(), Median(ratios)),
          least.value >= kAstarRatio};
}

Acceptance JudgeExpansion(const std::vector<BenchRow>& searches) {
  const std::string promise = Format("astar: at most %g ns an expansion in the median", kAstar_ns);
  std::vector<Figure> times_ns;
  for (const BenchRow& row : searches) times_ns.push_back({row.scene, row.ns_per_expansion});
  if (times_ns.empty()) return NotMeasured(promise, "the stage astar");
  const Figure most = *std::max_element(times_ns.begin(), times_ns.end(), Less);
  const double median_ns = Median(times_ns);
  return {promise,
          Format("median %.1f ns, most %.1f ns on %s", median_ns, most.value, most.scene.c_str()),
          median_ns <= kAstar_ns};
}

Acceptance JudgeOptimizer(std::vector<BenchRow> optimizers) {
  const std::string promise = Format(
      "optimizer: at least %g times as fast as Ceres on paths of 200 points", kOptimizerRatio);
  std::erase_if(optimizers, [](const BenchRow& row) { return row.points < kLeastPoints; });
  const std::vector<Figure> ratios = RatiosOf(optimizers);
  if (ratios.empty()) return NotMeasured(promise, "Ceres and the stage optimizer");
  const Figure least = *std::min_element(ratios.begin(), ratios.end(), Less);
  return {promise,
          Format("least %.1f on %s, median %.1f of %zu paths, by Ceres' method of the lower F",
                 least.value, least.scene.c_str(), Median(ratios), ratios.size()),
          least.value >= kOptimizerRatio};
}

Acceptance JudgeSpeed(std::vector<BenchRow> speeds) {
  const std::string promise = Format("speed: under %g us for 200 points", kSpeed_us);
  std::erase_if(speeds, [](const BenchRow& row) { return row.points < kLeastPoints; });
  std::vector<Figure> times_us;
  for (const BenchRow& row : speeds) times_us.push_back({row.scene, row.median_us});
  if (times_us.empty()) return NotMeasured(promise, "the stage speed");
  const Figure most = *std::max_element(times_us.begin(), times_us.end(), Less);
  return {promise,
          Format("median %.2f us, most %.2f us on %s", Median(times_us), most.value,
                 most.scene.c_str()),
          most.value < kSpeed_us};
}

Acceptance JudgeReplan(const std::vector<BenchRow>& replans) {
  const std::string promise =
      Format("replan on the RELLIS map to goals at 25 m: at most %g ms in the median",
             kReplan_us / 1000.0);
  for (const BenchRow& row : replans) {
    if (row.scene != kRellisScene) continue;
    return {promise,
            Format("median %.2f ms, worst %.2f ms, %d goals, %s", row.median_us / 1000.0,
                   row.worst_us / 1000.0, row.queries, StatusName(row.status)),
            row.median_us <= kReplan_us};
  }
  return NotMeasured(promise, std::string("the scene ") + kRellisScene);
}

Acceptance JudgeAllocations(const std::vector<BenchRow>& rows, bool allocations_counted) {
  const std::string promise = "no heap allocation in any stage";
  if (!allocations_counted) return NotMeasured(promise, "a build without a sanitizer");
  int64_t allocations = 0;
  for (const BenchRow& row : rows) allocations += row.allocations;
  return {promise, Format("%lld in %zu rows", static_cast<long long>(allocations), rows.size()),
          allocations == 0};
}

}  // namespace

std::vector<Acceptance> JudgeRows(const std::vector<BenchRow>& rows, bool allocations_counted) {
  const std::vector<BenchRow> costmaps = RowsOf(rows, "costmap");
  const std::vector<BenchRow> searches = RowsOf(rows, "astar");
  return {JudgeCostmap(costmaps),
          JudgeCostmapWorst(costmaps),
          JudgeAstarRatio(searches),
          JudgeExpansion(searches),
          JudgeOptimizer(RowsOf(rows, "optimizer")),
          JudgeSpeed(RowsOf(rows, "speed")),
          JudgeReplan(RowsOf(rows, "replan")),
          JudgeAllocations(rows, allocations_counted)};
}

}  // namespace hardpack::command
