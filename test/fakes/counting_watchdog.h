// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hal/watchdog.h"

namespace hardpack::fakes {

// Counts what it is told, and says whether it would have ended the program. 0: watches nothing.
class CountingWatchdog final : public Watchdog {
 public:
  explicit CountingWatchdog(uint64_t period_ns = 0) : period_ns_(period_ns) {}

  void Ready() override { ++ready_; }
  void Feed(uint64_t now_ns) override {
    if (period_ns_ == 0) return;
    if (fed_ > 0 && !stopping_ && now_ns > last_ns_ + period_ns_) expired_ = true;
    if (fed_ > 0 && now_ns < last_ns_ + period_ns_ / 2) return;
    ++fed_;
    last_ns_ = now_ns;
  }
  void Stopping() override { stopping_ = true; }
  uint64_t fed() const override { return fed_; }

  int ready() const { return ready_; }
  bool stopping() const { return stopping_; }
  // A Feed came later than the period after the one before.
  bool expired() const { return expired_; }

 private:
  uint64_t period_ns_;
  uint64_t last_ns_ = 0;
  uint64_t fed_ = 0;
  int ready_ = 0;
  bool stopping_ = false;
  bool expired_ = false;
};

}  // namespace hardpack::fakes
