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

// The result of one simulated mission. Each is a line of JSON in runs.jsonl, so the runs of several
// machines are merged by concatenating their lines.

namespace hardpack::experiment {

enum class Outcome : uint8_t {
  kReached,  // at rest at the goal
  kSaid,   // at rest, and the status gives the reason: no way, unseen ground, a goal in an obstacle
  kStuck,  // at rest for a long time, and no reason given
  kTimeOut,  // still driving when the mission's time was over
  kContact,  // touched something hard, stood in a ditch, rolled over or went aground
  kPerson,   // touched a person while moving faster than 0.1 m/s
  kFault,    // a mode that the operator has to clear
};
inline constexpr int kOutcomes = 7;

const char* Name(Outcome outcome);

// Measures of the driven path (tools/sim/mission/way_watch.h).
struct WayResult {
  double off_base_m = 0.0;     // largest distance of a plan from its base path
  double cross_track_m = 0.0;  // largest
  int64_t overshoots = 0;      // times that it was more than 0.2 m from the committed path
  double recovery_s = 0.0;     // longest, from there to less than 0.1 m
  bool recovered = true;       // from the last overshoot, too
  // For the obstacle that the path leads around (world::Scenario::around): plans that changed sides
  // before it was passed, and replans while the vehicle was beside it or looked past its flank, so
  // that the area behind it came into view.
  int64_t side_switches = 0;
  int64_t replans_beside = 0;
  // Largest distance from the middle of a corridor, or of the passage beside a pillar.
  std::optional<double> off_middle_m;
};

struct RunResult {
  // The run's settings.
  std::string world;
  std::string planner;          // "optimizer" or "astar"
  std::string tracker;          // "full" or "pursuit"
  std::string vehicle;          // name of its parameters' file
  std::string labels = "none";  // or their delay, "100 ms"
  double max_speed_set_mps = 0.0;
  uint64_t settings = 0;  // a digest of all other settings that the runs of a row share
  uint64_t seed = 0;
  // The results.
  Outcome outcome = Outcome::kTimeOut;
  bool success = false;  // ended as the world's mission should end, with no contact
  std::string reason;    // last stop reason that the vehicle gave, "none" without one
  // How often each stop reason began since the goal's acceptance, by name. Reasons that never began
  // are not included.
  std::map<std::string, int64_t> reasons;
  double time_s = 0.0;  // from the goal's acceptance to the end
  double driven_m = 0.0;
  double max_speed_mps = 0.0;
  double clearance_m = 0.0;         // smallest, to anything hard; 0: touched
  double person_clearance_m = 0.0;  // smallest, to a person while moving faster than 0.3 m/s
  double jerk_rms_mps3 = 0.0;
  int64_t replans = 0;  // plans that replaced another
  int64_t stops = 0;    // times it came to rest before the end
  // Every tick while driving: the vehicle's own estimate of its distance from the committed path.
  // The error of its odometry is not included.
  Histogram cross_track_m;
  double odometry_off_m = 0.0;  // largest drift of the odometry since the goal's acceptance
  // Every tick while moving, in a world with friction: how much the body's vertical speed changes,
  // on its suspension (tools/sim/script/suspension.h).
  Histogram vertical_mps2{0.1, 400};
  // As counted by core/safety/reaction_meter.h: time from each lidar column to the first command
  // for which it was considered, and that time times the speed.
  Histogram reaction_s{0.005, 200};
  // The same for columns considered at 4 m/s or more: the requirement is for 5 m/s.
  Histogram reaction_fast_s{0.005, 200};
  Histogram reaction_m{0.02, 250};
  WayResult way;
  uint64_t decision_hash = 0;
  bool replayed = false;  // its log was replayed, and every tick was decided the same

  double mean_speed_mps() const { return time_s > 0.0 ? driven_m / time_s : 0.0; }
};

nlohmann::ordered_json ToJson(const RunResult& result);

// kInvalidArgument, with a message: a field is missing or has the wrong type. Only `reasons` and
// `vertical_mps2` may be missing: files written before they existed can still be merged.
ReadOutcome FromJson(const nlohmann::json& object, RunResult& result);

// Reads lines of JSON; the message of a failure contains the file name and the line number. A run
// that appears twice (merged twice) is kept once; a run that appears twice with different results,
// or runs of one row with different settings, are kInvalidArgument. A last line without a line end
// was being written when the experiment was stopped: it is ignored.
ReadOutcome ReadRuns(const std::string& path, std::vector<RunResult>& results);

// Whether both were run in the same way except for the seed: then they belong to one table row.
bool IsSameRow(const RunResult& one, const RunResult& other);

// In the order of their rows and seeds.
ReadOutcome WriteRuns(const std::string& path, std::vector<RunResult> results);

}  // namespace hardpack::experiment
