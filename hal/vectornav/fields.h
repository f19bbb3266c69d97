// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// From wire units to an InsSample: shared by the binary and the ASCII messages. Each function fills
// one group of the sample, or refuses the values and leaves it unchanged: kNotFinite;
// kInvalidArgument: out of the range stated in hal/vectornav/vectornav.h.

namespace hardpack::vectornav {

inline constexpr uint64_t kNanosecondsPerSecond = 1'000'000'000u;
inline constexpr int32_t kSecondsPerWeek = 604'800;
inline constexpr uint64_t kNanosecondsPerWeek = uint64_t{kSecondsPerWeek} * kNanosecondsPerSecond;

// The bits of the status word that InsStatus names.
inline constexpr uint32_t kStatusModeMask = 0x0003u;
inline constexpr uint32_t kStatusGnssFix = 0x0004u;
inline constexpr uint32_t kStatusTimeError = 0x0008u;
inline constexpr uint32_t kStatusImuError = 0x0010u;
inline constexpr uint32_t kStatusMagnetometerOrPressureError = 0x0020u;
inline constexpr uint32_t kStatusGnssError = 0x0040u;
inline constexpr uint32_t kStatusGnssHeading = 0x0100u;
inline constexpr uint32_t kStatusGnssCompass = 0x0200u;

// Less than a week is not GPS time: the sample then has none.
void SetGpsTime(uint64_t gps_time_ns, InsSample& sample);
Status SetAttitude(float yaw_deg, float pitch_deg, float roll_deg, InsSample& sample);
Status SetPosition(int64_t latitude_ndeg, int64_t longitude_ndeg, float altitude_m,
                   InsSample& sample);
Status SetVelocity(const VelocityNed& velocity_ned, InsSample& sample);
Status SetAngularRate(const AngularRate& angular_rate, InsSample& sample);
Status SetAcceleration(const Acceleration& acceleration, InsSample& sample);
void SetStatus(uint16_t word, InsSample& sample);
Status SetAttitudeUncertainty(float uncertainty_deg, InsSample& sample);
Status SetPositionUncertainty(float uncertainty_m, InsSample& sample);
Status SetVelocityUncertainty(float uncertainty_mps, InsSample& sample);

}  // namespace hardpack::vectornav
