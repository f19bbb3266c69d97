// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// Where a datagram came from, in the order in which a tick has to be given them.
enum class InputSource : uint8_t { kIns = 0, kLabels = 1, kLidar = 2 };
inline constexpr int kInputSources = 3;

// Since the loop was configured.
struct LoopCounters {
  uint64_t ticks = 0;
  uint64_t missed_ticks = 0;   // gaps of the index
  uint64_t refused_ticks = 0;  // input that no tick can have: time or index ran backwards
  uint64_t datagrams[kInputSources] = {};
  uint64_t refused_datagrams[kInputSources] = {};
  uint64_t refused_columns = 0;  // those beyond a tick's directions among them
  uint64_t suspect_columns = 0;  // dropped while the lidar's clock was not to be relied upon
  uint64_t lidar_restarts = 0;
  uint64_t clock_jumps = 0;     // of the lidar
  uint64_t untimed_ins = 0;     // INS messages dropped while its clock was not to be relied upon
  uint64_t odometry_gaps = 0;   // pauses that odometry does not bridge: the map began anew
  uint64_t odometry_jumps = 0;  // steps that no vehicle makes: the same
  uint64_t refused_labels = 0;  // columns of labels that the map has no use for any more
  uint64_t commands = 0;
  uint64_t refused_commands = 0;
  uint64_t plans = 0;           // rounds of planning that were judged
  uint64_t refused_states = 0;  // that the planner would not take
};

}  // namespace hardpack
