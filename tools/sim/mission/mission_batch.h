// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "tools/sim/mission/mission.h"

// Many missions, several at a time. They are independent, so a result does not depend on how many
// run in parallel; only the order in which they end does.

namespace hardpack::mission {

struct MissionBatch {
  size_t missions = 0;
  int jobs = 1;  // threads
  // A folder for flight logs: the log of each mission is written there, replayed, and removed.
  // Empty: no logs, and RunResult::replayed stays false.
  std::string log_folder;
  bool with_traces = false;

  // Sets up the mission of an index. Called from any thread, several at a time.
  std::function<ReadOutcome(size_t index, MissionSettings& settings)> prepare;
  // Called for each mission that has ended; one at a time.
  std::function<ReadOutcome(size_t index, const MissionSettings& settings,
                            const experiment::RunResult& result, const MissionTrace& trace)>
      finished;
};

// The first failure of anything that is called ends the batch, including the missions running then.
// A log that does not replay to the same decisions is not a failure: it stays in the folder as
// WORLD_SEED.pcap, and RunResult::replayed is false.
ReadOutcome RunBatch(const MissionBatch& batch);

}  // namespace hardpack::mission
