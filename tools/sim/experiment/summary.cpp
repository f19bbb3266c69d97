// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <tuple>

namespace hardpack::experiment {
namespace {

// The speed for which the reaction radius is reported.
constexpr double kReactionSpeed_mps = 5.0;
constexpr double kHour_s = 3600.0;

constexpr std::string_view kFaultAlarms[] = {
    "lidar_old",     "odometry_old", "ins_old",        "blind_ahead",
    "lidar_covered", "lidar_frozen", "lidar_turned",   "wheel_spin",
    "drives",        "runaway",      "wrong_turn",     "stuck",
    "bad_command",   "bus",          "foreign_sender", "stop_too_long"};

void Add(const WayResult& result, bool is_first, WayRow& row) {
  row.least_off_base_m =
      is_first ? result.off_base_m : std::min(row.least_off_base_m, result.off_base_m);
  row.mean_off_base_m += result.off_base_m;
  row.cross_track_m = std::max(row.cross_track_m, result.cross_track_m);
  row.overshoots += result.overshoots;
  row.recovery_s = std::max(row.recovery_s, result.recovery_s);
  row.not_recovered += result.recovered ? 0 : 1;
  row.switched_side += result.side_switches > 0 ? 1 : 0;
  row.replanned_beside += result.replans_beside > 0 ? 1 : 0;
  if (result.off_middle_m) {
    row.off_middle_m = std::max(row.off_middle_m.value_or(0.0), *result.off_middle_m);
  }
}

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
  row.odometry_off_m = std::max(row.odometry_off_m, result.odometry_off_m);
  row.vertical_mps2.Add(result.vertical_mps2);
  for (const auto& [reason, times] : result.reasons) {
    if (IsFaultAlarm(reason)) row.fault_alarms += times;
  }
  row.hours += result.time_s / kHour_s;
  row.reaction_s.Add(result.reaction_s);
  row.reaction_fast_s.Add(result.reaction_fast_s);
  row.reaction_m.Add(result.reaction_m);
  Add(result.way, row.runs == 1, row.way);
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
  row.way.mean_off_base_m /= static_cast<double>(row.runs);
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

bool IsFaultAlarm(std::string_view reason) {
  return std::find(std::begin(kFaultAlarms), std::end(kFaultAlarms), reason) !=
         std::end(kFaultAlarms);
}

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
  std::map<std::tuple<std::string, std::string, std::string, std::string, std::string, double>, Row>
      rows;
  for (const RunResult& result : results) {
    Row& row = rows[{result.world, result.planner, result.tracker, result.vehicle, result.labels,
                     result.max_speed_set_mps}];
    row.world = result.world;
    row.planner = result.planner;
    row.tracker = result.tracker;
    row.vehicle = result.vehicle;
    row.labels = result.labels;
    row.max_speed_set_mps = result.max_speed_set_mps;
    Add(result, row);
  }
  std::vector<Row> table;
  for (auto& [key, row] : rows) {
    Finish(row);
    table.push_back(std::move(row));
  }
  return table;
}

namespace {

nlohmann::ordered_json ToJson(const WayRow& way) {
  return {{"least_off_base_m", way.least_off_base_m},
          {"mean_off_base_m", way.mean_off_base_m},
          {"cross_track_m", way.cross_track_m},
          {"overshoots", way.overshoots},
          {"recovery_s", way.recovery_s},
          {"not_recovered", way.not_recovered},
          {"switched_side", way.switched_side},
          {"replanned_beside", way.replanned_beside},
          {"off_middle_m", way.off_middle_m ? nlohmann::json(*way.off_middle_m) : nullptr}};
}

// A line of a Markdown table.
std::string Line(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line.append(" ").append(cell).append(" |");
  return line.append("\n");
}

std::string Heading(const std::vector<std::string>& cells) {
  return Line(cells) + Line(std::vector<std::string>(cells.size(), "---"));
}

std::string HowRun(const Row& row) {
  return row.planner + ", " + row.tracker + ", " + row.vehicle + ", " +
         Number(row.max_speed_set_mps, 1) + " m/s, labels " + row.labels;
}

std::string Both(double one, double other, int decimals) {
  return Number(one, decimals) + " / " + Number(other, decimals);
}

std::string OfAll(int64_t runs, const Row& row) {
  return std::to_string(runs) + "/" + std::to_string(row.runs);
}

std::string ResultLine(const Row& row) {
  const Interval interval = Confidence95(row.successes, row.runs);
  const auto of = [&](Outcome outcome) {
    return std::to_string(row.outcomes[static_cast<size_t>(outcome)]);
  };
  return Line({row.world,
               HowRun(row),
               OfAll(row.successes, row) + " (" + Number(100.0 * interval.low, 0) + "-" +
                   Number(100.0 * interval.high, 0) + " %)",
               of(Outcome::kReached),
               of(Outcome::kSaid),
               of(Outcome::kStuck),
               of(Outcome::kTimeOut),
               of(Outcome::kContact),
               of(Outcome::kPerson),
               of(Outcome::kFault),
               Number(row.mean_time_s, 1),
               Both(row.mean_speed_mps, row.max_speed_mps, 2),
               Number(row.clearance_m, 2),
               Both(row.cross_track_m.Quantile(0.95), row.cross_track_m.Quantile(0.99), 3),
               Number(row.mean_jerk_mps3, 1),
               Number(row.mean_replans, 1),
               Both(row.reaction_m.Quantile(0.5), row.reaction_m.Quantile(0.99), 2),
               Both(row.ReactionAt_m(kReactionSpeed_mps, 0.5),
                    row.ReactionAt_m(kReactionSpeed_mps, 0.99), 3),
               OfAll(row.replayed, row),
               std::to_string(row.fault_alarms),
               Number(row.hours, 2),
               Seeds(row.failed_seeds)});
}

std::string WayLine(const Row& row) {
  const WayRow& way = row.way;
  return Line({row.world, HowRun(row), Both(way.least_off_base_m, way.mean_off_base_m, 2),
               Number(way.cross_track_m, 2), std::to_string(way.overshoots),
               Number(way.recovery_s, 1), OfAll(way.not_recovered, row),
               OfAll(way.switched_side, row), OfAll(way.replanned_beside, row),
               way.off_middle_m ? Number(*way.off_middle_m, 2) : "-",
               Number(row.person_clearance_m, 2), Number(row.odometry_off_m, 2),
               Number(row.vertical_mps2.Quantile(0.95), 1)});
}

}  // namespace

nlohmann::ordered_json ToJson(const Row& row) {
  const Interval interval = Confidence95(row.successes, row.runs);
  nlohmann::ordered_json outcomes;
  for (int i = 0; i < kOutcomes; ++i) outcomes[Name(static_cast<Outcome>(i))] = row.outcomes[i];
  return {{"world", row.world},
          {"planner", row.planner},
          {"tracker", row.tracker},
          {"vehicle", row.vehicle},
          {"labels", row.labels},
          {"max_speed_set_mps", row.max_speed_set_mps},
          {"runs", row.runs},
          {"successes", row.successes},
          {"success_share_95", {interval.low, interval.high}},
          {"outcomes", outcomes},
          {"failed_seeds", row.failed_seeds},
          {"replayed", row.replayed},
          {"fault_alarms", row.fault_alarms},
          {"hours", row.hours},
          {"mean_time_s", row.mean_time_s},
          {"mean_speed_mps", row.mean_speed_mps},
          {"max_speed_mps", row.max_speed_mps},
          {"clearance_m", Finite(row.clearance_m)},
          {"person_clearance_m", Finite(row.person_clearance_m)},
          {"cross_track_p95_m", Finite(row.cross_track_m.Quantile(0.95))},
          {"cross_track_p99_m", Finite(row.cross_track_m.Quantile(0.99))},
          {"odometry_off_m", row.odometry_off_m},
          {"vertical_p95_mps2", Finite(row.vertical_mps2.Quantile(0.95))},
          {"jerk_rms_mps3", row.mean_jerk_mps3},
          {"replans", row.mean_replans},
          {"reaction_median_m", Finite(row.reaction_m.Quantile(0.5))},
          {"reaction_p99_m", Finite(row.reaction_m.Quantile(0.99))},
          {"reaction_median_s", Finite(row.reaction_s.Quantile(0.5))},
          {"reaction_p99_s", Finite(row.reaction_s.Quantile(0.99))},
          {"reaction_at_5_mps_median_m", Finite(row.ReactionAt_m(kReactionSpeed_mps, 0.5))},
          {"reaction_at_5_mps_p99_m", Finite(row.ReactionAt_m(kReactionSpeed_mps, 0.99))},
          {"reaction_columns", row.reaction_s.count()},
          {"reaction_fast_columns", row.reaction_fast_s.count()},
          {"way", ToJson(row.way)}};
}

std::string ToMarkdown(const std::vector<Row>& rows) {
  std::string text = Heading({"world",
                              "how",
                              "success (95 %)",
                              "reached",
                              "said",
                              "stuck",
                              "time-out",
                              "contact",
                              "person",
                              "fault",
                              "time s",
                              "speed mean / largest m/s",
                              "clearance m",
                              "cross-track p95 / p99 m",
                              "jerk m/s^3",
                              "replans",
                              "reaction as driven median / p99 m",
                              "reaction at 5 m/s median / p99 m",
                              "replayed",
                              "fault alarms",
                              "hours",
                              "failed seeds"});
  for (const Row& row : rows) text += ResultLine(row);
  text.append("\n");
  text += Heading({"world", "how", "plan off its base path, least / mean m",
                   "cross-track largest m", "overshoots", "longest recovery s", "not recovered",
                   "side switched", "replanned beside", "off the middle m", "to a person m",
                   "odometry off m", "vertical p95 m/s^2"});
  for (const Row& row : rows) text += WayLine(row);
  return text;
}

}  // namespace hardpack::experiment
