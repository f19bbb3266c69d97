// SPDX-License-Identifier: Apache-2.0
#include "port_linux/realtime.h"

#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string>

namespace hardpack {
namespace {

std::string Refusal(const std::string& what, const char* remedy) {
  const int code = errno;
  return what + ": " + std::strerror(code) + " (" + remedy + ")";
}

// Not inlined: its frame must lie below the caller's, where the frames of later calls will be.
[[gnu::noinline]] void PrefaultStack() {
  std::array<volatile char, kPrefaultedStack_bytes> stack;
  constexpr size_t kSmallestPage_bytes = 4096;
  for (size_t i = 0; i < stack.size(); i += kSmallestPage_bytes) stack[i] = 0;
}

bool Schedule(int priority, RealtimeOutcome& outcome) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0) return true;
  outcome.refused.push_back(Refusal("real-time scheduling, priority " + std::to_string(priority),
                                    "needs CAP_SYS_NICE or LimitRTPRIO"));
  return false;
}

bool LockMemory(RealtimeOutcome& outcome) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return true;
  outcome.refused.push_back(Refusal("memory lock", "needs CAP_IPC_LOCK or LimitMEMLOCK=infinity"));
  return false;
}

bool Pin(int cpu, RealtimeOutcome& outcome) {
  cpu_set_t set;
  CPU_ZERO(&set);
  errno = EINVAL;
  if (cpu < CPU_SETSIZE) {
    CPU_SET(static_cast<size_t>(cpu), &set);
    if (sched_setaffinity(0, sizeof(set), &set) == 0) return true;
  }
  outcome.refused.push_back(
      Refusal("processor " + std::to_string(cpu), "does it exist, and may it be used?"));
  return false;
}

}  // namespace

RealtimeOutcome BecomeRealtime(const RealtimeOptions& options) {
  RealtimeOutcome outcome;
  if (options.cpu >= 0) outcome.pinned = Pin(options.cpu, outcome);
  if (options.lock_memory) outcome.locked = LockMemory(outcome);
  if (options.priority != 0) outcome.scheduled = Schedule(options.priority, outcome);
  PrefaultStack();
  return outcome;
}

}  // namespace hardpack
