// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nlohmann/json.hpp"
#include "tools/sim/experiment/run_result.h"

// The table of an experiment: one row per combination of settings.

namespace hardpack::experiment {

// Of WayResult, over all runs of a row.
struct WayRow {
  double least_off_base_m = 0.0;  // of the runs' largest
  double mean_off_base_m = 0.0;
  double cross_track_m = 0.0;  // largest
  int64_t overshoots = 0;
  double recovery_s = 0.0;             // longest
  int64_t not_recovered = 0;           // runs that ended beside their path
  int64_t switched_side = 0;           // runs
  int64_t replanned_beside = 0;        // runs
  std::optional<double> off_middle_m;  // largest
};

struct Row {
  std::string world;
  std::string planner;
  std::string tracker;
  std::string vehicle;
  std::string labels;
  double max_speed_set_mps = 0.0;
  int64_t runs = 0;
  int64_t successes = 0;
  int64_t outcomes[kOutcomes] = {};
  int64_t replayed = 0;
  std::vector<uint64_t> failed_seeds;  // ascending
  double mean_time_s = 0.0;            // of the successes, like the three below
  double mean_speed_mps = 0.0;         // total distance over total time
  double mean_replans = 0.0;
  double mean_jerk_mps3 = 0.0;  // root mean square of a run, averaged
  double max_speed_mps = 0.0;   // of all runs, like all below
  double clearance_m = 0.0;
  double person_clearance_m = 0.0;
  Histogram cross_track_m;
  double odometry_off_m = 0.0;
  Histogram vertical_mps2{0.1, 400};
  int64_t fault_alarms = 0;  // times that a reason of IsFaultAlarm began
  double hours = 0.0;        // simulated, from the goal's acceptance
  Histogram reaction_s{0.005, 200};
  Histogram reaction_fast_s{0.005, 200};
  Histogram reaction_m{0.02, 250};
  WayRow way;

  double success_share() const {
    return runs > 0 ? static_cast<double>(successes) / static_cast<double>(runs) : 0.0;
  }
  // The distance for reaction_fast_s at a speed.
  double ReactionAt_m(double speed_mps, double share) const {
    return speed_mps * reaction_fast_s.Quantile(share);
  }
};

// Whether a stop reason, by its name, indicates a faulty sensor, drive, wheel, bus or clock. If
// nothing is faulty, such a stop is a false alarm; stops due to the world, the operator or a
// missing plan may be correct.
bool IsFaultAlarm(std::string_view reason);

// The interval that contains the true share of successes with 95 % confidence (Wilson 1927,
// REFERENCES.md). 0 .. 1 if there were no runs.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};
Interval Confidence95(int64_t successes, int64_t runs);

// Rows in the order of their names.
std::vector<Row> Summarise(const std::vector<RunResult>& results);

nlohmann::ordered_json ToJson(const Row& row);

// Two tables: the results of the runs, and the measures of their paths.
std::string ToMarkdown(const std::vector<Row>& rows);

}  // namespace hardpack::experiment
