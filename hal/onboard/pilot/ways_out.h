// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// What a vehicle at rest tries where the way that it is about to set out on would touch something:
// plans that lead out by one LeadOut after another, until one is clear.

namespace hardpack {

class WaysOut {
 public:
  // So long it stands before another plan is made from where it is.
  static constexpr float kHeld_s = 0.5f;

  // What plans shall begin with: PlanRequest::lead_out, 0 to kLeadOuts.
  int32_t preferred() const { return preferred_; }

  // The vehicle moves, or nothing is planned for it: none is preferred.
  void Reset();

  // The way that it would set out on is clear, or it may not set out for another reason.
  void NotHeld() { held_since_ns_ = 0; }

  // The way that it would set out on would touch something. now_ns: since the epoch of the
  // timebase, not 0. True: it has for kHeld_s; the next is preferred, and the plan is to be
  // forgotten.
  bool Held(uint64_t now_ns);

  // A plan was made with that preference, and there is none: there may be one with another, or
  // without.
  void FoundNoPlan();

 private:
  void PreferNext();

  int32_t preferred_ = 0;
  uint64_t held_since_ns_ = 0;  // 0: not held
};

}  // namespace hardpack
