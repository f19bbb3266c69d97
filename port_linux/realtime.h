// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace hardpack {

struct RealtimeOptions {
  int priority = 50;        // of SCHED_FIFO, 1 .. 99; 0: not asked for
  bool lock_memory = true;  // what is mapped now and later is never paged out
  int cpu = -1;             // the one processor to run on; -1: any
};

struct RealtimeOutcome {
  bool scheduled = false;  // runs under SCHED_FIFO
  bool locked = false;
  bool pinned = false;
  // One line for each thing that was asked for and not granted: what, why and what permits it.
  std::vector<std::string> refused;
};

// Makes the calling thread as punctual as it is permitted to be. Once, at the end of start-up:
// after the threads that are to stay ordinary have been started (later ones do not inherit the
// scheduling class either) and after what is large has been allocated. Each thing is tried,
// whatever became of the others. Touches kPrefaultedStack_bytes of stack, so that the first deep
// call does not fault.
RealtimeOutcome BecomeRealtime(const RealtimeOptions& options);

inline constexpr int kPrefaultedStack_bytes = 256 * 1024;

}  // namespace hardpack
