// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/pilot/ways_out.h"

#include "core/autonomy/planner.h"
#include "core/base/units.h"

namespace hardpack {

void WaysOut::Reset() {
  preferred_ = 0;
  held_since_ns_ = 0;
}

bool WaysOut::Held(uint64_t now_ns) {
  if (held_since_ns_ == 0) held_since_ns_ = now_ns;
  if (!(SecondsBetween(held_since_ns_, now_ns) > kHeld_s)) return false;
  held_since_ns_ = 0;
  PreferNext();
  return true;
}

// Without a preference the planner has tried everything.
void WaysOut::FoundNoPlan() {
  if (preferred_ != 0) PreferNext();
}

// None is preferred after the last.
void WaysOut::PreferNext() {
  preferred_ = (preferred_ + 1) % (kLeadOuts + 1);
}

}  // namespace hardpack
