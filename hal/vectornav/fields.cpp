// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/fields.h"

#include "core/base/math.h"

namespace hardpack::vectornav {
namespace {

constexpr float kFullTurn_deg = 360.0f;
constexpr float kQuarterTurn_deg = 90.0f;
static_assert(kQuarterTurn_deg * kRadPerDeg <= kHalfPi);
constexpr int64_t kMaxLatitude_ndeg = 90'000'000'000;
constexpr int64_t kMaxLongitude_ndeg = 180'000'000'000;

// Of an uncertainty: finite, and none is negative.
Status CheckUncertainty(float value) {
  if (!IsFinite(value)) return Status::kNotFinite;
  return value >= 0.0f ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace

void SetGpsTime(uint64_t gps_time_ns, InsSample& sample) {
  if (gps_time_ns < kNanosecondsPerWeek) return;
  sample.has_gps_time = true;
  sample.gps_time_ns = gps_time_ns;
}

Status SetAttitude(float yaw_deg, float pitch_deg, float roll_deg, InsSample& sample) {
  if (!IsFinite(yaw_deg) || !IsFinite(pitch_deg) || !IsFinite(roll_deg)) return Status::kNotFinite;
  if (Abs(yaw_deg) > kFullTurn_deg || Abs(pitch_deg) > kQuarterTurn_deg ||
      Abs(roll_deg) > kFullTurn_deg) {
    return Status::kInvalidArgument;
  }
  sample.has_attitude = true;
  sample.yaw_rad = WrapAngle(yaw_deg * kRadPerDeg);
  sample.pitch_rad = pitch_deg * kRadPerDeg;
  sample.roll_rad = WrapAngle(roll_deg * kRadPerDeg);
  return Status::kOk;
}

Status SetPosition(int64_t latitude_ndeg, int64_t longitude_ndeg, float altitude_m,
                   InsSample& sample) {
  if (!IsFinite(altitude_m)) return Status::kNotFinite;
  if (latitude_ndeg < -kMaxLatitude_ndeg || latitude_ndeg > kMaxLatitude_ndeg ||
      longitude_ndeg < -kMaxLongitude_ndeg || longitude_ndeg > kMaxLongitude_ndeg) {
    return Status::kInvalidArgument;
  }
  sample.has_position = true;
  sample.latitude_ndeg = latitude_ndeg;
  sample.longitude_ndeg = longitude_ndeg;
  sample.altitude_m = altitude_m;
  return Status::kOk;
}

Status SetVelocity(const VelocityNed& velocity_ned, InsSample& sample) {
  if (!IsFinite(velocity_ned)) return Status::kNotFinite;
  sample.has_velocity = true;
  sample.velocity_ned = velocity_ned;
  return Status::kOk;
}

Status SetAngularRate(const AngularRate& angular_rate, InsSample& sample) {
  if (!IsFinite(angular_rate)) return Status::kNotFinite;
  sample.has_angular_rate = true;
  sample.angular_rate = angular_rate;
  return Status::kOk;
}

Status SetAcceleration(const Acceleration& acceleration, InsSample& sample) {
  if (!IsFinite(acceleration)) return Status::kNotFinite;
  sample.has_acceleration = true;
  sample.acceleration = acceleration;
  return Status::kOk;
}

void SetStatus(uint16_t word, InsSample& sample) {
  sample.has_status = true;
  InsStatus& status = sample.status;
  status.mode = static_cast<InsMode>(word & kStatusModeMask);
  status.gnss_fix = (word & kStatusGnssFix) != 0;
  status.time_error = (word & kStatusTimeError) != 0;
  status.imu_error = (word & kStatusImuError) != 0;
  status.magnetometer_or_pressure_error = (word & kStatusMagnetometerOrPressureError) != 0;
  status.gnss_error = (word & kStatusGnssError) != 0;
  status.gnss_heading = (word & kStatusGnssHeading) != 0;
  status.gnss_compass = (word & kStatusGnssCompass) != 0;
  status.word = word;
}

Status SetAttitudeUncertainty(float uncertainty_deg, InsSample& sample) {
  const Status checked = CheckUncertainty(uncertainty_deg);
  if (!IsUsable(checked)) return checked;
  sample.has_attitude_uncertainty = true;
  sample.attitude_uncertainty_rad = uncertainty_deg * kRadPerDeg;
  return Status::kOk;
}

Status SetPositionUncertainty(float uncertainty_m, InsSample& sample) {
  const Status checked = CheckUncertainty(uncertainty_m);
  if (!IsUsable(checked)) return checked;
  sample.has_position_uncertainty = true;
  sample.position_uncertainty_m = uncertainty_m;
  return Status::kOk;
}

Status SetVelocityUncertainty(float uncertainty_mps, InsSample& sample) {
  const Status checked = CheckUncertainty(uncertainty_mps);
  if (!IsUsable(checked)) return checked;
  sample.has_velocity_uncertainty = true;
  sample.velocity_uncertainty_mps = uncertainty_mps;
  return Status::kOk;
}

}  // namespace hardpack::vectornav
