// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/saturate.h"
#include "core/base/wide_int.h"

// Converts between metres and seconds and the integer units of sensor ranges, map heights and
// clocks.

namespace hardpack {

inline constexpr float kCentimetersPerMeter = 100.0f;
inline constexpr float kMillimetersPerMeter = 1000.0f;
inline constexpr float kMillisecondsPerSecond = 1000.0f;
inline constexpr float kStandardGravity_mps2 = 9.80665f;

// To the nearest centimetre, halves away from zero; saturates, and NaN gives 0.
constexpr int32_t InCentimeters(float length_m) {
  return RoundToInt(length_m * kCentimetersPerMeter);
}

constexpr float FromCentimeters(int32_t length_cm) {
  return static_cast<float>(length_cm) / kCentimetersPerMeter;
}

constexpr float FromMillimeters(uint32_t length_mm) {
  return static_cast<float>(length_mm) / kMillimetersPerMeter;
}

// Precondition: earlier_ns <= later_ns.
constexpr float SecondsBetween(uint64_t earlier_ns, uint64_t later_ns) {
  constexpr float kSecondsPerNanosecond = 1.0e-9f;
  return ToFloat(later_ns - earlier_ns) * kSecondsPerNanosecond;
}

}  // namespace hardpack
