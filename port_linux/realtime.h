// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace hardpack {

struct RealtimeOptions {
  int priority = 50;        // of SCHED_FIFO, 1 .. 99; 0: not requested
  bool lock_memory = true;  // present and later mappings are never paged out
  int cpu = -1;             // the one processor to run on; -1: any
};

struct RealtimeOutcome {
  bool scheduled = false;  // runs under SCHED_FIFO
  bool locked = false;
  bool pinned = false;
  // One line for each request that was not granted: what, why and what permits it.
  std::vector<std::string> refused;
};

// Makes the calling thread real-time as far as permitted. Once, at the end of start-up: after
// starting the threads that should stay ordinary (later ones do not inherit the scheduling class
// either) and after large allocations. Each request is tried, even if others fail. Touches
// kPrefaultedStack_bytes of stack, so that the first deep call does not fault.
RealtimeOutcome BecomeRealtime(const RealtimeOptions& options);

inline constexpr int kPrefaultedStack_bytes = 256 * 1024;

}  // namespace hardpack
