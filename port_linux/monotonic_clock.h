// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hal/clock.h"

namespace hardpack {

// CLOCK_MONOTONIC: nanoseconds since the computer's start, excluding suspended time.
class MonotonicClock final : public Clock {
 public:
  uint64_t Now_ns() override;
  void SleepUntil(uint64_t time_ns) override;
};

}  // namespace hardpack
