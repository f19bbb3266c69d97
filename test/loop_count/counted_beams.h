// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/loop_bound.h"
#include "core/measurements/measurements.h"

namespace hardpack {

// While it lives the counting build holds the loops over a lidar's beams to so many; other builds
// do not count.
class CountedBeams {
 public:
  explicit CountedBeams(int beams) { Set(beams); }
  ~CountedBeams() { Set(kMaxBeams); }
  CountedBeams(const CountedBeams&) = delete;
  CountedBeams& operator=(const CountedBeams&) = delete;

  static void Set([[maybe_unused]] int beams) {
#if defined(HP_COUNT_LOOPS)
    LoopCounter::SetBeams(beams);
#endif
  }
};

}  // namespace hardpack
