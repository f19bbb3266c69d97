// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// Our one clock. test/hal/conformance holds every implementation to this page.
class Clock {
 public:
  // Monotonic nanoseconds from some fixed moment; never runs backwards, never jumps forward by a
  // time server's step.
  virtual uint64_t Now_ns() = 0;

  // Returns once Now_ns() >= time_ns, at once if it already is; interruptions by signals do not end
  // it early. The one call in this layer that waits.
  virtual void SleepUntil(uint64_t time_ns) = 0;

 protected:
  ~Clock() = default;
};

}  // namespace hardpack
