// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// Ends (or stops) the program when it no longer reports that it is alive: a service manager, a
// timer circuit. test/hal/conformance tests every implementation against this page.
class Watchdog {
 public:
  // Once: the program is set up and its first tick follows.
  virtual void Ready() = 0;
  // Every tick; passed on as often as needed and no more. Does not block.
  virtual void Feed(uint64_t now_ns) = 0;
  // The program is ending on request: a missing Feed from now on is not a failure.
  virtual void Stopping() = 0;
  // Number of signals passed on: 0 if there is no watchdog.
  virtual uint64_t fed() const = 0;

 protected:
  ~Watchdog() = default;
};

}  // namespace hardpack
