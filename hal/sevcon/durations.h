// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/saturate.h"

// Converts parameter times to nanoseconds.

namespace hardpack::sevcon {

// Precondition: not negative.
constexpr uint64_t Milliseconds(int32_t time_ms) {
  return static_cast<uint64_t>(static_cast<uint32_t>(time_ms)) * 1'000'000u;
}
// To the nearest millisecond. Precondition: 0 .. 1000 s.
constexpr uint64_t Seconds(float time_s) {
  return Milliseconds(RoundToInt(time_s * 1000.0f));
}

}  // namespace hardpack::sevcon
