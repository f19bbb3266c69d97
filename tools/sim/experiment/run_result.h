// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "port_linux/files/read_outcome.h"
#include "tools/sim/experiment/histogram.h"

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

// What the worlds are to show of the way (tools/sim/mission/way_watch.h).
struct WayResult {
  double off_base_m = 0.0;     // largest, of a plan from the base path that it was bent from
  double cross_track_m = 0.0;  // largest
  int64_t overshoots = 0;      // times that it was more than 0.2 m beside the committed path
  double recovery_s = 0.0;     // longest, from there to less than 0.1 m
  bool recovered = true;       // the last one, too
  // Of what the way leads around (world::Scenario::around): plans that changed the side before it
  // was passed, and replans while the vehicle was beside it or looked past it along its flank, so
  // that what is behind came into view.
  int64_t side_switches = 0;
  int64_t replans_beside = 0;
  // Largest distance from the middle of a corridor, or of what a pillar leaves of it.
  std::optional<double> off_middle_m;
};

struct RunResult {
  // What was run.
  std::string world;
  std::string planner;          // "optimizer" or "astar"
  std::string tracker;          // "full" or "pursuit"
  std::string vehicle;          // name of its parameters' file
  std::string labels = "none";  // or their delay, "100 ms"
  double max_speed_set_mps = 0.0;
  uint64_t settings = 0;  // a digest of all else that the runs of a row have in common
  uint64_t seed = 0;
  // What came of it.
  Outcome outcome = Outcome::kTimeOut;
  bool success = false;  // what the world's mission is to end in, with no contact
  std::string reason;    // stop reason that the vehicle gave last, "none" without one
  // How often each stop reason began since the goal's acceptance, by its name. A reason that never
  // did is not in it.
  std::map<std::string, int64_t> reasons;
  double time_s = 0.0;  // from the goal's acceptance to the end
  double driven_m = 0.0;
  double max_speed_mps = 0.0;
  double clearance_m = 0.0;         // smallest, to anything hard; 0: touched
  double person_clearance_m = 0.0;  // smallest, to a person while moving faster than 0.3 m/s
  double jerk_rms_mps3 = 0.0;
  int64_t replans = 0;  // plans that took the place of another
  int64_t stops = 0;    // came to rest before its end
  // Every tick while driving: how far the vehicle took itself to be beside the committed path. What
  // its odometry is off by is not in it.
  Histogram cross_track_m;
  double odometry_off_m = 0.0;  // largest drift of the odometry since the goal's acceptance
  // As core/safety/reaction_meter.h counts them: each lidar column's time to the first command
  // that it was considered for, and that time times the speed.
  Histogram reaction_s{0.005, 200};
  // The same of the columns that were considered at 4 m/s and more: what is asked for at 5 m/s.
  Histogram reaction_fast_s{0.005, 200};
  Histogram reaction_m{0.02, 250};
  WayResult way;
  uint64_t decision_hash = 0;
  bool replayed = false;  // its log was replayed, and every tick was decided the same

  double mean_speed_mps() const { return time_s > 0.0 ? driven_m / time_s : 0.0; }
};

nlohmann::ordered_json ToJson(const RunResult& result);

// kInvalidArgument with what is wrong with it: a field that is missing or of another kind. Only
// `reasons` may be missing: files from before it was written are still merged.
ReadOutcome FromJson(const nlohmann::json& object, RunResult& result);

// Lines of JSON; the file's name and the line's number are in the message of a failure. A run that
// is there twice (merged twice) is kept once; twice with another result, or runs of one row with
// different settings, are kInvalidArgument. A last line without its end was being written when the
// experiment was stopped: it is left out.
ReadOutcome ReadRuns(const std::string& path, std::vector<RunResult>& results);

// Whether both were run in the same way, but for the seed: then they are of one row of the table.
bool IsSameRow(const RunResult& one, const RunResult& other);

// In the order of their rows and seeds.
ReadOutcome WriteRuns(const std::string& path, std::vector<RunResult> results);

}  // namespace hardpack::experiment
