// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>

#include "tools/allocation_counter/allocation_counter.h"

namespace hardpack::command {
namespace {

struct Column {
  const char* key;   // in JSON
  const char* text;  // above the column
  int decimals;
  bool more_is_worse;
  double (*value)(const QualityRun& run);
};

constexpr std::array<Column, 10> kColumns = {{
    {"cost", "F", 1, true, [](const QualityRun& run) { return double{run.measures.cost.total()}; }},
    {"map_cost", "F map", 1, true,
     [](const QualityRun& run) { return double{run.measures.cost.map}; }},
    {"path_cost", "F path", 1, true,
     [](const QualityRun& run) { return double{run.measures.cost.path}; }},
    {"largest_curvature_per_m", "|k| 1/m", 3, true,
     [](const QualityRun& run) { return double{run.measures.largest_curvature_per_m}; }},
    {"largest_curvature_rate_per_m2", "|k'| 1/m2", 3, true,
     [](const QualityRun& run) { return double{run.measures.largest_curvature_rate_per_m2}; }},
    {"length_m", "length m", 2, true,
     [](const QualityRun& run) { return double{run.measures.length_m}; }},
    {"clearance_m", "clear m", 2, false,
     [](const QualityRun& run) { return double{run.measures.clearance_m}; }},
    {"angle_per_m", "rad/m", 3, true,
     [](const QualityRun& run) { return double{run.measures.angle_per_m}; }},
    {"median_us", "time us", 0, true, [](const QualityRun& run) { return run.median_us; }},
    {"allocations", "allocs", 0, true,
     [](const QualityRun& run) { return static_cast<double>(run.allocations); }},
}};

struct Spread {
  double mean = 0.0;
  double median = 0.0;
  double worst = 0.0;
};

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Spread SpreadOf(const std::vector<QualityResult>& results, SolverId id, const Column& column) {
  std::vector<double> values;
  for (const QualityResult& result : results) values.push_back(column.value(result.of(id)));
  if (values.empty()) return {};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()),
          MedianOf(values), column.more_is_worse ? *most : *least};
}

template <typename Holds>
int CountOf(const std::vector<QualityResult>& results, SolverId id, Holds&& holds) {
  return static_cast<int>(
      std::count_if(results.begin(), results.end(),
                    [&](const QualityResult& result) { return holds(result.of(id)); }));
}

int LimitsKept(const std::vector<QualityResult>& results, SolverId id) {
  return CountOf(results, id, [](const QualityRun& run) { return run.measures.keeps_limits; });
}

int Collisions(const std::vector<QualityResult>& results, SolverId id) {
  return CountOf(results, id, [](const QualityRun& run) { return run.measures.collides; });
}

// F of ours over F of the other. If both are almost 0 they are equal.
double CostShare(const QualityResult& result, SolverId other) {
  constexpr double kNothing = 1.0e-6;
  return (double{result.of(SolverId::kOurs).measures.cost.total()} + kNothing) /
         (double{result.of(other).measures.cost.total()} + kNothing);
}

void PrintTable(const std::vector<QualityResult>& results) {
  std::printf("%-21s %-7s", "solver", "");
  for (const Column& column : kColumns) std::printf(" %9s", column.text);
  std::printf(" %7s %9s\n", "limits", "collision");
  for (const SolverName& solver : Solvers()) {
    const auto line = [&](const char* what, double Spread::*member) {
      const bool first = member == &Spread::mean;
      std::printf("%-21s %-7s", first ? solver.text.c_str() : "", what);
      for (const Column& column : kColumns) {
        std::printf(" %9.*f", column.decimals, SpreadOf(results, solver.id, column).*member);
      }
      if (first) {
        std::printf(" %7d %9d", LimitsKept(results, solver.id), Collisions(results, solver.id));
      }
      std::printf("\n");
    };
    line("mean", &Spread::mean);
    line("median", &Spread::median);
    line("worst", &Spread::worst);
  }
}

void PrintComparison(const HeadToHead& head, const std::string& text) {
  std::printf(
      "hardpack beside %s: F equal or lower on %d of %d (median %.3f of it, worst %.3f on "
      "problem %d)\n",
      text.c_str(), head.no_worse, head.problems, head.median_cost_share, head.worst_cost_share,
      head.worst_cost_problem);
  std::printf("  time: %.1f times faster in the median, %.1f at least (problem %d)\n",
              head.median_speed_up, head.least_speed_up, head.least_speed_up_problem);
  std::printf("  limits kept wherever %s keeps them, but for problems:", text.c_str());
  for (const int number : head.limits_lost) std::printf(" %d", number);
  std::printf("%s\n", head.limits_lost.empty() ? " none" : "");
}

nlohmann::json RunToJson(const QualityRun& run) {
  nlohmann::json object = {{"usable", run.usable},
                           {"points", run.measures.points},
                           {"keeps_limits", run.measures.keeps_limits},
                           {"collides", run.measures.collides}};
  for (const Column& column : kColumns) object[column.key] = column.value(run);
  return object;
}

nlohmann::json ComparisonToJson(const HeadToHead& head) {
  return {{"no_worse", head.no_worse},
          {"problems", head.problems},
          {"median_cost_share", head.median_cost_share},
          {"worst_cost_share", head.worst_cost_share},
          {"worst_cost_problem", head.worst_cost_problem},
          {"median_speed_up", head.median_speed_up},
          {"least_speed_up", head.least_speed_up},
          {"least_speed_up_problem", head.least_speed_up_problem},
          {"limits_lost", head.limits_lost}};
}

nlohmann::json SummaryToJson(const std::vector<QualityResult>& results, SolverId id) {
  nlohmann::json object = {{"limits_kept", LimitsKept(results, id)},
                           {"collisions", Collisions(results, id)}};
  for (const Column& column : kColumns) {
    const Spread spread = SpreadOf(results, id, column);
    object[column.key] = {
        {"mean", spread.mean}, {"median", spread.median}, {"worst", spread.worst}};
  }
  return object;
}

}  // namespace

const QualityRun& QualityResult::of(SolverId id) const {
  const auto& solvers = Solvers();
  const auto found = std::find_if(solvers.begin(), solvers.end(),
                                  [id](const SolverName& solver) { return solver.id == id; });
  return runs.at(static_cast<size_t>(found - solvers.begin()));
}

HeadToHead Compare(const std::vector<QualityResult>& results, SolverId other) {
  HeadToHead head;
  head.problems = static_cast<int>(results.size());
  std::vector<double> shares;
  std::vector<double> speed_ups;
  for (const QualityResult& result : results) {
    const QualityRun& ours = result.of(SolverId::kOurs);
    const QualityRun& theirs = result.of(other);
    if (ours.measures.cost.total() <= theirs.measures.cost.total()) ++head.no_worse;
    if (theirs.measures.keeps_limits && !ours.measures.keeps_limits) {
      head.limits_lost.push_back(result.number);
    }
    shares.push_back(CostShare(result, other));
    speed_ups.push_back(theirs.median_us / ours.median_us);
  }
  if (results.empty()) return head;
  const auto worst = std::max_element(shares.begin(), shares.end()) - shares.begin();
  const auto least = std::min_element(speed_ups.begin(), speed_ups.end()) - speed_ups.begin();
  head.median_cost_share = MedianOf(shares);
  head.worst_cost_share = shares[static_cast<size_t>(worst)];
  head.worst_cost_problem = results[static_cast<size_t>(worst)].number;
  head.median_speed_up = MedianOf(speed_ups);
  head.least_speed_up = speed_ups[static_cast<size_t>(least)];
  head.least_speed_up_problem = results[static_cast<size_t>(least)].number;
  return head;
}

std::vector<size_t> MostTelling(const std::vector<QualityResult>& results, SolverId other,
                                size_t wanted) {
  const std::vector<int> lost = Compare(results, SolverId::kPaper).limits_lost;
  std::vector<size_t> chosen;
  std::vector<size_t> order;
  for (size_t i = 0; i < results.size(); ++i) {
    const bool is_lost = std::find(lost.begin(), lost.end(), results[i].number) != lost.end();
    (is_lost && chosen.size() < wanted / 4 ? chosen : order).push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return CostShare(results[a], other) < CostShare(results[b], other);
  });
  const size_t rest = std::min(wanted - chosen.size(), order.size());
  const size_t third = rest / 3;
  const size_t typical = rest - 2 * third;
  const size_t typical_first = (order.size() - typical) / 2;
  for (size_t rank = 0; rank < order.size(); ++rank) {
    const bool wins = rank < third;
    const bool loses = rank >= order.size() - third;
    const bool is_typical = rank >= typical_first && rank < typical_first + typical;
    if (wins || loses || is_typical) chosen.push_back(order[rank]);
  }
  return chosen;
}

void PrintQuality(const std::vector<QualityResult>& results) {
  std::printf("%zu problems\n", results.size());
  PrintTable(results);
  for (const SolverName& solver : Solvers()) {
    if (solver.id == SolverId::kAstar || solver.id == SolverId::kOurs) continue;
    PrintComparison(Compare(results, solver.id), solver.text);
  }
}

nlohmann::json QualityToJson(const std::vector<QualityResult>& results, uint32_t seed) {
  nlohmann::json problems = nlohmann::json::array();
  for (const QualityResult& result : results) {
    nlohmann::json object = {{"number", result.number}, {"kind", result.kind}};
    for (size_t i = 0; i < result.runs.size(); ++i) {
      object["solvers"][Solvers()[i].key] = RunToJson(result.runs[i]);
    }
    problems.push_back(object);
  }
  nlohmann::json summary;
  nlohmann::json head_to_head;
  for (const SolverName& solver : Solvers()) {
    summary[solver.key] = SummaryToJson(results, solver.id);
    if (solver.id == SolverId::kAstar || solver.id == SolverId::kOurs) continue;
    head_to_head[solver.key] = ComparisonToJson(Compare(results, solver.id));
  }
  return {{"version", HARDPACK_VERSION},
          {"compiler", __VERSION__},
          {"seed", seed},
          {"allocations_counted", AllocationsAreCounted()},
          {"summary", summary},
          {"head_to_head", head_to_head},
          {"problems", problems}};
}

}  // namespace hardpack::command
