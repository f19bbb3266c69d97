// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// Ends (or stops) us when we no longer say that we are alive: a service manager, a timer circuit.
// test/hal/conformance holds every implementation to this page.
class Watchdog {
 public:
  // Once: the program is set up and its first tick follows.
  virtual void Ready() = 0;
  // Every tick; passed on often enough and not more often than needed. Does not block.
  virtual void Feed(uint64_t now_ns) = 0;
  // The program ends as it was asked to: not being fed from now on is no failure.
  virtual void Stopping() = 0;
  // What is passed on: 0 where nobody watches.
  virtual uint64_t fed() const = 0;

 protected:
  ~Watchdog() = default;
};

}  // namespace hardpack
