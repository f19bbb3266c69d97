// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/autonomy/replanner.h"
#include "core/base/pose.h"
#include "core/safety/supervisor.h"
#include "hal/onboard/flight_log/records.h"
#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "port_linux/chosen_vehicle.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/read_outcome.h"

// Runs a recorded drive through its vehicle's loop again (docs/flight_log.md). A flight log
// contains the ticks and their decisions: these must be reproduced bit for bit. For a plain capture
// (`tcpdump -i any`) the ticks are made from the packets' times, and there is nothing to compare.

namespace hardpack::replay {

struct Request {
  std::vector<std::string> files;  // of a flight log: all of one run, in any order
  std::string configuration_path;  // TOML; empty: the log's own. A capture has none
  std::string metadata_path;       // JSON; empty: the log's own, or the one the configuration names
  bool from_image = false;         // every file that has an image of the state starts from it
};

struct ModeChange {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  Mode mode = Mode::kStandby;
  StopReason reason = StopReason::kNone;
};

// A planning round that was judged.
struct PlanEvent {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  ReplanOutcome outcome;
  uint32_t number = 0;  // of the committed path
  Pose2 pose_odom;
};

// The first decision that differs.
struct Difference {
  bool found = false;
  uint64_t index = 0;  // of the tick
  std::string what;
};

// How long ticks took when the log was written, and now.
struct Durations {
  int64_t ticks = 0;
  uint64_t sum_ns = 0;
  uint64_t largest_ns = 0;
  uint64_t largest_index = 0;

  void Add(uint64_t index, uint64_t duration_ns);
};

struct Report {
  bool is_flight_log = false;
  std::vector<std::string> files;     // in the order of the run
  flight_log::VersionRecord version;  // of the first file; empty of a capture
  int64_t ticks = 0;                  // replayed
  uint64_t first_index = 0;
  uint64_t last_index = 0;
  bool from_image = false;     // the first tick was replayed from an image
  bool ended = false;          // the log says that the run ended normally
  bool cut = false;            // the log ends within a tick or a packet
  std::string not_comparable;  // why the log could not be followed to its end; otherwise empty
  Difference difference;
  int64_t different_ticks = 0;
  uint64_t decision_hash = 0;  // after the last tick
  int64_t frames_out = 0;      // decided in the replay
  int64_t frames_in = 0;
  int64_t own_frames = 0;  // in a capture: with identifiers that only we send, not fed
  std::array<int64_t, kInputSources> datagrams = {};
  int64_t foreign_datagrams = 0;  // in a capture: from no configured source
  int64_t duplicates = 0;         // in a capture: seen on several interfaces
  int64_t incomplete = 0;         // in a capture: datagrams with missing fragments
  std::vector<ModeChange> modes;
  std::vector<PlanEvent> plans;
  std::vector<Pose2> driven;  // every 0.1 m or so
  Durations logged;
  Durations replayed;

  bool same() const { return !difference.found && not_comparable.empty(); }
};

// Whether the files are flight logs or plain captures; kInvalidArgument if they are mixed.
ReadOutcome AreFlightLogs(const std::vector<std::string>& files, bool& are_logs);

// Replays a flight log. A failure is input that cannot be used at all (a file or its configuration
// cannot be read, the files are not from one run, an image is from a program with another state
// layout); everything else is in the report. `vehicle` is left in its state after the last tick,
// and `configuration` is the one used.
ReadOutcome ReplayLog(const Request& request, ChosenVehicle& vehicle, Configuration& configuration,
                      Report& report);

// Replays a plain capture. A tick takes what the capture received in the preceding period, as the
// onboard program would, and leaves anything beyond a tick's limits to the next tick. The bus is
// assumed to be active.
ReadOutcome ReplayCapture(const Request& request, ChosenVehicle& vehicle,
                          Configuration& configuration, Report& report);

// Records what a tick has changed, for both kinds of replay.
class Observer {
 public:
  explicit Observer(Report& report) : report_(report) {}
  // One tick of the vehicle, timed and recorded.
  Status Tick(const TickInput& input, AnyVehicle& vehicle, TickOutput& output);

 private:
  Report& report_;
  bool any_ = false;
  Mode mode_ = Mode::kStandby;
  StopReason reason_ = StopReason::kNone;
  uint64_t plans_ = 0;
};

}  // namespace hardpack::replay
