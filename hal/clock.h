// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// Our only clock. test/hal/conformance tests every implementation against this page.
class Clock {
 public:
  // Monotonic nanoseconds from some fixed moment; never runs backwards, and never jumps forward
  // when a time server steps the clock.
  virtual uint64_t Now_ns() = 0;

  // Returns once Now_ns() >= time_ns, immediately if it already is; signals do not end it early.
  // The only call in this layer that waits.
  virtual void SleepUntil(uint64_t time_ns) = 0;

 protected:
  ~Clock() = default;
};

}  // namespace hardpack
