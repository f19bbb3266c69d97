// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/loop_bound.h"
#include "hal/velodyne/velodyne.h"

// Directions of the lasers of a VLP-16 and a VLP-32C, in packet order, as given in the
// manufacturer's manuals (REFERENCES.md).
//
// The head turns while the lasers fire one after the other: 0.12 degree at 600 rpm. A beam's
// azimuth is therefore the sum of its own and that of its slot, both clockwise, relative to the
// middle of the slots, for the configured rate. If the rate is off by a fraction s, the outermost
// slots are off by 17.28 us of that: 0.06 s degree at 600 rpm and 0.12 s at 1200. With an error of
// 1 % these are 1 mm and 2 mm at 50 m.

namespace hardpack::velodyne {

inline constexpr std::array<float, 16> kVlp16Altitude_deg = {
    -15.0f, 1.0f, -13.0f, 3.0f,  -11.0f, 5.0f,  -9.0f, 7.0f,
    -7.0f,  9.0f, -5.0f,  11.0f, -3.0f,  13.0f, -1.0f, 15.0f};

inline constexpr std::array<float, 32> kVlp32cAltitude_deg = {
    -25.0f,  -1.0f,  -1.667f, -15.639f, -11.31f, 0.0f,   -0.667f, -8.843f,
    -7.254f, 0.333f, -0.333f, -6.148f,  -5.333f, 1.333f, 0.667f,  -4.0f,
    -4.667f, 1.667f, 1.0f,    -3.667f,  -3.333f, 3.333f, 2.333f,  -2.667f,
    -3.0f,   7.0f,   4.667f,  -2.333f,  -2.0f,   15.0f,  10.333f, -1.333f};

// Clockwise.
inline constexpr std::array<float, 32> kVlp32cAzimuth_deg = {
    1.4f,  -4.2f, 1.4f,  -1.4f, 1.4f,  -1.4f, 4.2f,  -1.4f, 1.4f,  -4.2f, 1.4f,
    -1.4f, 4.2f,  -1.4f, 4.2f,  -1.4f, 1.4f,  -4.2f, 1.4f,  -4.2f, 4.2f,  -1.4f,
    1.4f,  -1.4f, 1.4f,  -1.4f, 1.4f,  -4.2f, 4.2f,  -1.4f, 1.4f,  -1.4f};

// All beams of a VLP-16 cross 42.7 mm in front of the axis: this reproduces, to 0.2 mm, the height
// correction in its manual of 0.7 mm (1 degree) to 11.2 mm (15 degrees). The manual of the VLP-32C
// gives none.
inline constexpr float kVlp16Origin_m = 0.0427f;

inline constexpr int32_t kRates = (kMostRpm - kLeastRpm) / kRpmStep + 1;
template <size_t kBeams>
using AzimuthsOfRates = std::array<std::array<float, kBeams>, kRates>;

// For each rate that a sensor can be configured for, from kLeastRpm on.
template <size_t kBeams>
consteval AzimuthsOfRates<kBeams> MakeAzimuths(const std::array<float, kBeams>& own_deg) {
  constexpr float kDegPerRpmNs = 360.0f / 60.0f * 1.0e-9f;
  constexpr size_t kLasersInSlot = kBeams / 16;
  AzimuthsOfRates<kBeams> azimuths{};
  HP_LOOP_BOUND(kRates)
  for (size_t rate = 0; rate < kRates; ++rate) {
    const auto rpm = static_cast<float>(kLeastRpm + kRpmStep * static_cast<int32_t>(rate));
    HP_LOOP_BOUND(kMostBeams)
    for (size_t row = 0; row < kBeams; ++row) {
      const auto slot = static_cast<int32_t>(row / kLasersInSlot);
      const auto late_ns = static_cast<float>(slot * kSlot_ns - kMiddle_ns);
      azimuths[rate][row] = own_deg[row] + rpm * kDegPerRpmNs * late_ns;
    }
  }
  return azimuths;
}

inline constexpr AzimuthsOfRates<16> kVlp16Azimuths_deg = MakeAzimuths(std::array<float, 16>{});
inline constexpr AzimuthsOfRates<32> kVlp32cAzimuths_deg = MakeAzimuths(kVlp32cAzimuth_deg);

}  // namespace hardpack::velodyne
