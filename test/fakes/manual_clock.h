// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "hal/clock.h"

namespace hardpack::fakes {

// Time passes when it is told to, and by sleeping.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(uint64_t now_ns = 1'000'000'000) : now_ns_(now_ns) {}

  uint64_t Now_ns() override { return now_ns_; }
  void SleepUntil(uint64_t time_ns) override { now_ns_ = std::max(now_ns_, time_ns); }

  void Pass(uint64_t time_ns) { now_ns_ += time_ns; }

 private:
  uint64_t now_ns_;
};

}  // namespace hardpack::fakes
