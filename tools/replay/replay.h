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

// Runs a recorded drive through its vehicle's loop again (docs/flight_log.md). Of a flight log the
// ticks are known, and so is what they decided: it has to be decided again, bit for bit. Of a plain
// capture
// (`tcpdump -i any`) the ticks are made from the packets' times, and there is nothing to compare.

namespace hardpack::replay {

struct Request {
  std::vector<std::string> files;  // of a flight log: all of one run, in any order
  std::string configuration_path;  // TOML; empty: the log's own. A capture has none
  std::string metadata_path;       // JSON; empty: the log's own, or the one the configuration names
  bool from_image = false;         // every file that has an image of the state begins from that
};

struct ModeChange {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  Mode mode = Mode::kStandby;
  StopReason reason = StopReason::kNone;
};

// A round of planning that was judged.
struct PlanEvent {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  ReplanOutcome outcome;
  uint32_t number = 0;  // of the committed path
  Pose2 pose_odom;
};

// The first thing that was decided otherwise.
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
  bool ended = false;          // the log says that the run ended as it should
  bool cut = false;            // the log ends within a tick or a packet
  std::string not_comparable;  // why the log could not be followed to its end; else empty
  Difference difference;
  int64_t different_ticks = 0;
  uint64_t decision_hash = 0;  // after the last tick
  int64_t frames_out = 0;      // decided now
  int64_t frames_in = 0;
  int64_t own_frames = 0;  // of a capture: with identifiers that only we send, not fed
  std::array<int64_t, kInputSources> datagrams = {};
  int64_t foreign_datagrams = 0;  // of a capture: of no configured source
  int64_t duplicates = 0;         // of a capture: seen on several interfaces
  int64_t incomplete = 0;         // of a capture: datagrams of which fragments are missing
  std::vector<ModeChange> modes;
  std::vector<PlanEvent> plans;
  std::vector<Pose2> driven;  // every 0.1 m or so
  Durations logged;
  Durations replayed;

  bool same() const { return !difference.found && not_comparable.empty(); }
};

// Whether the files are flight logs or plain captures: they are all the same, or kInvalidArgument.
ReadOutcome AreFlightLogs(const std::vector<std::string>& files, bool& are_logs);

// Replays a flight log. A failure is input that cannot be used at all (a file or its configuration
// cannot be read, the files are not of one run, an image is of a program with another layout of the
// state); everything else is in the report. `vehicle` ends as it was after the last tick, and
// `configuration` is what was used.
ReadOutcome ReplayLog(const Request& request, ChosenVehicle& vehicle, Configuration& configuration,
                      Report& report);

// Replays a plain capture. A tick takes what the capture took in the period before it, as the
// onboard program would, which leaves to the next tick what is more than one takes. The bus is
// taken to be active.
ReadOutcome ReplayCapture(const Request& request, ChosenVehicle& vehicle,
                          Configuration& configuration, Report& report);

// Notes what a tick has changed; for both of them.
class Observer {
 public:
  explicit Observer(Report& report) : report_(report) {}
  // One tick of the vehicle, timed and noted.
  Status Tick(const TickInput& input, AnyVehicle& vehicle, TickOutput& output);

 private:
  Report& report_;
  bool any_ = false;
  Mode mode_ = Mode::kStandby;
  StopReason reason_ = StopReason::kNone;
  uint64_t plans_ = 0;
};

}  // namespace hardpack::replay
