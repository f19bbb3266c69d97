// SPDX-License-Identifier: Apache-2.0
#include "port_linux/monotonic_clock.h"

#include <time.h>

namespace hardpack {
namespace {

constexpr uint64_t kSecond_ns = 1'000'000'000;

}  // namespace

uint64_t MonotonicClock::Now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<uint64_t>(now.tv_sec) * kSecond_ns + static_cast<uint64_t>(now.tv_nsec);
}

void MonotonicClock::SleepUntil(uint64_t time_ns) {
  timespec until{};
  until.tv_sec = static_cast<time_t>(time_ns / kSecond_ns);
  until.tv_nsec = static_cast<long>(time_ns % kSecond_ns);
  // An absolute time, so that interruptions by signals add no error.
  while (Now_ns() < time_ns) clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

}  // namespace hardpack
