// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "tools/sim/mission/mission.h"

// Many missions, several at a time. Each is on its own, so what comes of it does not depend on how
// many run beside it; only the order in which they end does.

namespace hardpack::mission {

struct MissionBatch {
  size_t missions = 0;
  int jobs = 1;  // threads
  // A folder for flight logs: the log of each mission is written there, replayed, and removed.
  // Empty: no logs, and RunResult::replayed stays false.
  std::string log_folder;
  bool with_traces = false;

  // Says what the mission of an index is. Called from any thread, several at a time.
  std::function<ReadOutcome(size_t index, MissionSettings& settings)> prepare;
  // Told of each that has ended; one at a time.
  std::function<ReadOutcome(size_t index, const MissionSettings& settings,
                            const experiment::RunResult& result, const MissionTrace& trace)>
      finished;
};

// The first failure of anything that is called ends it, with what runs at the moment. A log that
// does not replay to what was decided is no failure: it stays in the folder, as
// WORLD_SEED.pcap, and RunResult::replayed is false.
ReadOutcome RunBatch(const MissionBatch& batch);

}  // namespace hardpack::mission
