// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "port_linux/read_outcome.h"
#include "tools/experiment/histogram.h"

// What one simulated mission came to. A line of JSON each in runs.jsonl, so that the runs of
// several machines are put together by putting their lines together.

namespace hardpack::experiment {

enum class Outcome : uint8_t {
  kReached,  // at rest at the goal
  kSaid,   // at rest, and the status gives the reason: no way, unseen ground, a goal in an obstacle
  kStuck,  // at rest for long, and no reason given
  kTimeOut,  // on its way for longer than the mission may take
  kContact,  // touched something hard, or stood in a ditch
  kPerson,   // touched a person while it moved faster than 0.3 m/s
  kFault,    // a mode that the operator has to leave
};
inline constexpr int kOutcomes = 7;

const char* Name(Outcome outcome);

struct RunResult {
  // What was run.
  std::string world;
  std::string planner;  // "optimizer" or "astar"
  std::string tracker;  // "full" or "pursuit"
  std::string vehicle;  // name of its parameters' file
  uint64_t seed = 0;
  // What came of it.
  Outcome outcome = Outcome::kTimeOut;
  bool success = false;  // what the world's mission is to end in, with no contact
  std::string reason;    // stop reason that the vehicle gave last, "none" without one
  double time_s = 0.0;   // from the goal's acceptance to the end
  double driven_m = 0.0;
  double max_speed_mps = 0.0;
  double clearance_m = 0.0;         // smallest, to anything hard; 0: touched
  double person_clearance_m = 0.0;  // smallest, to a person while moving faster than 0.3 m/s
  double jerk_rms_mps3 = 0.0;
  int64_t replans = 0;      // plans that took the place of another
  int64_t stops = 0;        // came to rest before its end
  Histogram cross_track_m;  // every tick while driving, to the committed path
  // As core/autonomy/reaction_meter.h counts them: each lidar column's time to the first command
  // that it was considered for, and that time times the speed.
  Histogram reaction_s{0.005, 200};
  Histogram reaction_m{0.02, 250};
  uint64_t decision_hash = 0;
  bool replayed = false;  // its log was replayed, and every tick was decided the same

  double mean_speed_mps() const { return time_s > 0.0 ? driven_m / time_s : 0.0; }
};

nlohmann::ordered_json ToJson(const RunResult& result);

// kInvalidArgument with what is wrong with it: a field that is missing or of another kind.
ReadOutcome FromJson(const nlohmann::json& object, RunResult& result);

// Lines of JSON; the file's name and the line's number are in the message of a failure. A run that
// is there twice (merged twice) is kept once; twice with another result is kInvalidArgument.
ReadOutcome ReadRuns(const std::string& path, std::vector<RunResult>& results);

// In the order of their seeds.
ReadOutcome WriteRuns(const std::string& path, std::vector<RunResult> results);

}  // namespace hardpack::experiment
