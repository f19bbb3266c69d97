// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

namespace hardpack::experiment {
namespace {

// Sums until Finish divides them.
void Add(const RunResult& result, Row& row) {
  ++row.runs;
  ++row.outcomes[static_cast<size_t>(result.outcome)];
  row.replayed += result.replayed ? 1 : 0;
  row.max_speed_mps = std::max(row.max_speed_mps, result.max_speed_mps);
  row.clearance_m =
      row.runs == 1 ? result.clearance_m : std::min(row.clearance_m, result.clearance_m);
  row.person_clearance_m = row.runs == 1
                               ? result.person_clearance_m
                               : std::min(row.person_clearance_m, result.person_clearance_m);
  row.cross_track_m.Add(result.cross_track_m);
  row.reaction_s.Add(result.reaction_s);
  row.reaction_m.Add(result.reaction_m);
  if (!result.success) {
    row.failed_seeds.push_back(result.seed);
    return;
  }
  ++row.successes;
  row.mean_time_s += result.time_s;
  row.mean_speed_mps += result.driven_m;
  row.mean_replans += static_cast<double>(result.replans);
  row.mean_jerk_mps3 += result.jerk_rms_mps3;
}

void Finish(Row& row) {
  std::sort(row.failed_seeds.begin(), row.failed_seeds.end());
  if (row.successes == 0) return;
  const auto successes = static_cast<double>(row.successes);
  row.mean_speed_mps = row.mean_time_s > 0.0 ? row.mean_speed_mps / row.mean_time_s : 0.0;
  row.mean_time_s /= successes;
  row.mean_replans /= successes;
  row.mean_jerk_mps3 /= successes;
}

std::string Number(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "inf";
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

// JSON has no infinity.
nlohmann::json Finite(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

std::string Seeds(const std::vector<uint64_t>& seeds) {
  constexpr size_t kShown = 12;
  std::string text;
  for (size_t i = 0; i < std::min(seeds.size(), kShown); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(seeds[i]);
  }
  return seeds.size() > kShown ? text + ", ..." : text;
}

}  // namespace

Interval Confidence95(int64_t successes, int64_t runs) {
  if (runs <= 0) return {};
  constexpr double kZ = 1.959963984540054;
  const auto n = static_cast<double>(runs);
  const double p = static_cast<double>(successes) / n;
  const double spread = kZ * std::sqrt(p * (1.0 - p) / n + kZ * kZ / (4.0 * n * n));
  const double center = p + kZ * kZ / (2.0 * n);
  const double scale = 1.0 + kZ * kZ / n;
  return {std::max(0.0, (center - spread) / scale), std::min(1.0, (center + spread) / scale)};
}

std::vector<Row> Summarise(const std::vector<RunResult>& results) {
  std::map<std::tuple<std::string, std::string, std::string, std::string>, Row> rows;
  for (const RunResult& result : results) {
    Row& row = rows[{result.world, result.planner, result.tracker, result.vehicle}];
    row.world = result.world;
    row.planner = result.planner;
    row.tracker = result.tracker;
    row.vehicle = result.vehicle;
    Add(result, row);
  }
  std::vector<Row> table;
  for (auto& [key, row] : rows) {
    Finish(row);
    table.push_back(std::move(row));
  }
  return table;
}

nlohmann::ordered_json ToJson(const Row& row) {
  const Interval interval = Confidence95(row.successes, row.runs);
  nlohmann::ordered_json outcomes;
  for (int i = 0; i < kOutcomes; ++i) outcomes[Name(static_cast<Outcome>(i))] = row.outcomes[i];
  return {{"world", row.world},
          {"planner", row.planner},
          {"tracker", row.tracker},
          {"vehicle", row.vehicle},
          {"runs", row.runs},
          {"successes", row.successes},
          {"success_share_95", {interval.low, interval.high}},
          {"outcomes", outcomes},
          {"failed_seeds", row.failed_seeds},
          {"replayed", row.replayed},
          {"mean_time_s", row.mean_time_s},
          {"mean_speed_mps", row.mean_speed_mps},
          {"max_speed_mps", row.max_speed_mps},
          {"clearance_m", Finite(row.clearance_m)},
          {"person_clearance_m", Finite(row.person_clearance_m)},
          {"cross_track_p95_m", Finite(row.cross_track_m.Quantile(0.95))},
          {"cross_track_p99_m", Finite(row.cross_track_m.Quantile(0.99))},
          {"jerk_rms_mps3", row.mean_jerk_mps3},
          {"replans", row.mean_replans},
          {"reaction_median_m", Finite(row.reaction_m.Quantile(0.5))},
          {"reaction_p99_m", Finite(row.reaction_m.Quantile(0.99))},
          {"reaction_median_s", Finite(row.reaction_s.Quantile(0.5))},
          {"reaction_p99_s", Finite(row.reaction_s.Quantile(0.99))},
          {"reaction_columns", row.reaction_s.count()}};
}

std::string ToMarkdown(const std::vector<Row>& rows) {
  std::string text =
      "| world | planner, tracker, vehicle | success (95 %) | stuck | contact | time s | mean m/s "
      "| "
      "largest m/s | clearance m | cross-track p95 / p99 m | jerk m/s^3 | replans | reaction "
      "median "
      "/ p99 m | replayed | failed seeds |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const Interval interval = Confidence95(row.successes, row.runs);
    const auto of = [&](Outcome outcome) { return row.outcomes[static_cast<size_t>(outcome)]; };
    text += "| " + row.world + " | " + row.planner + ", " + row.tracker + ", " + row.vehicle +
            " | " + std::to_string(row.successes) + "/" + std::to_string(row.runs) + " (" +
            Number(100.0 * interval.low, 0) + "-" + Number(100.0 * interval.high, 0) + " %) | " +
            std::to_string(of(Outcome::kStuck) + of(Outcome::kTimeOut)) + " | " +
            std::to_string(of(Outcome::kContact) + of(Outcome::kPerson)) + " | " +
            Number(row.mean_time_s, 1) + " | " + Number(row.mean_speed_mps, 2) + " | " +
            Number(row.max_speed_mps, 2) + " | " + Number(row.clearance_m, 2) + " | " +
            Number(row.cross_track_m.Quantile(0.95), 3) + " / " +
            Number(row.cross_track_m.Quantile(0.99), 3) + " | " + Number(row.mean_jerk_mps3, 1) +
            " | " + Number(row.mean_replans, 1) + " | " + Number(row.reaction_m.Quantile(0.5), 3) +
            " / " + Number(row.reaction_m.Quantile(0.99), 3) + " | " +
            std::to_string(row.replayed) + "/" + std::to_string(row.runs) + " | " +
            Seeds(row.failed_seeds) + " |\n";
  }
  return text;
}

}  // namespace hardpack::experiment
