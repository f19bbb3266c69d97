// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/local_plane.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/wide_int.h"

namespace hardpack {
namespace {

constexpr float kDegreesPerNanodegree = 1.0e-9f;
constexpr int64_t kHalfTurn_ndeg = 180'000'000'000;
constexpr float kRadius_m = 6378137.0f;           // the ellipsoid's equator
constexpr float kEccentricity2 = 6.69437999e-3f;  // its first eccentricity, squared
// Each step makes the error smaller by four digits at least.
constexpr int kInverseSteps = 3;

float Radians(int64_t angle_ndeg) {
  const auto magnitude = static_cast<uint64_t>(angle_ndeg < 0 ? -angle_ndeg : angle_ndeg);
  const float radians = ToFloat(magnitude) * kDegreesPerNanodegree * kRadPerDeg;
  return angle_ndeg < 0 ? -radians : radians;
}

int64_t Nanodegrees(float radians) {
  return RoundToInt(radians / kRadPerDeg / kDegreesPerNanodegree);
}

int64_t WrapLongitude(int64_t longitude_ndeg) {
  if (longitude_ndeg > kHalfTurn_ndeg) return longitude_ndeg - 2 * kHalfTurn_ndeg;
  if (longitude_ndeg < -kHalfTurn_ndeg) return longitude_ndeg + 2 * kHalfTurn_ndeg;
  return longitude_ndeg;
}

// Radius of curvature across the meridian, N, and along it, M.
float AcrossMeridian(float sin_latitude) {
  return kRadius_m / Sqrt(1.0f - kEccentricity2 * sin_latitude * sin_latitude);
}
float AlongMeridian(float sin_latitude) {
  const float squared = 1.0f - kEccentricity2 * sin_latitude * sin_latitude;
  return AcrossMeridian(sin_latitude) * (1.0f - kEccentricity2) / squared;
}

bool IsPlace(int64_t latitude_ndeg, int64_t longitude_ndeg) {
  return latitude_ndeg >= -LocalPlane::kMaxLatitude_ndeg &&
         latitude_ndeg <= LocalPlane::kMaxLatitude_ndeg && longitude_ndeg >= -kHalfTurn_ndeg &&
         longitude_ndeg <= kHalfTurn_ndeg;
}

}  // namespace

Status LocalPlane::SetAnchor(int64_t latitude_ndeg, int64_t longitude_ndeg) {
  if (!IsPlace(latitude_ndeg, longitude_ndeg)) return Status::kInvalidArgument;
  latitude_ndeg_ = latitude_ndeg;
  longitude_ndeg_ = longitude_ndeg;
  has_anchor_ = true;
  return Status::kOk;
}

Status LocalPlane::ToPlane(int64_t latitude_ndeg, int64_t longitude_ndeg, Vec2& place) const {
  if (!has_anchor_) return Status::kNotStarted;
  if (!IsPlace(latitude_ndeg, longitude_ndeg)) return Status::kInvalidArgument;
  // The differences in whole numbers: a float has seven digits.
  const float north_rad = Radians(latitude_ndeg - latitude_ndeg_);
  const float east_rad = Radians(WrapLongitude(longitude_ndeg - longitude_ndeg_));
  const SinCosPair there = SinCos(Radians(latitude_ndeg));
  const SinCosPair half_east = SinCos(east_rad / 2.0f);
  const float parallel_m = AcrossMeridian(there.sin) * there.cos;
  const float middle_sin = Sin(Radians(latitude_ndeg_) + north_rad / 2.0f);
  // 1 - cos is 2 sin^2 of the half: no digits are lost; and so is sin 2 sin cos of it.
  const Vec2 found = {
      parallel_m * 2.0f * half_east.sin * half_east.cos,
      AlongMeridian(middle_sin) * (north_rad - north_rad * north_rad * north_rad / 6.0f) +
          parallel_m * Sin(Radians(latitude_ndeg_)) * 2.0f * half_east.sin * half_east.sin};
  if (Abs(found.x_m) > kMaxRange_m || Abs(found.y_m) > kMaxRange_m || Abs(east_rad) > kHalfPi) {
    return Status::kInvalidArgument;
  }
  place = found;
  return Status::kOk;
}

// By Newton's method, with the derivatives of a sphere of those radii.
Status LocalPlane::ToGeodetic(Vec2 place, int64_t& latitude_ndeg, int64_t& longitude_ndeg) const {
  if (!has_anchor_) return Status::kNotStarted;
  if (!IsFinite(place)) return Status::kNotFinite;
  if (Abs(place.x_m) > kMaxRange_m || Abs(place.y_m) > kMaxRange_m) return Status::kInvalidArgument;
  int64_t latitude = latitude_ndeg_;
  int64_t longitude = longitude_ndeg_;
  HP_LOOP_BOUND(kInverseSteps)
  for (int step = 0; step < kInverseSteps; ++step) {
    Vec2 found;
    const Status status = ToPlane(latitude, longitude, found);
    if (!IsUsable(status)) return status;
    const SinCosPair there = SinCos(Radians(latitude));
    const float turn_rad = Convergence(latitude, longitude);
    const float dx_m = place.x_m - found.x_m;
    const float dy_m = place.y_m - found.y_m;
    const float north_m = dy_m - turn_rad * dx_m;
    const float east_m = dx_m + turn_rad * dy_m;
    latitude += Nanodegrees(north_m / AlongMeridian(there.sin));
    longitude =
        WrapLongitude(longitude + Nanodegrees(east_m / (AcrossMeridian(there.sin) * there.cos)));
  }
  if (!IsPlace(latitude, longitude)) return Status::kInvalidArgument;
  latitude_ndeg = latitude;
  longitude_ndeg = longitude;
  return Status::kOk;
}

float LocalPlane::Convergence(int64_t latitude_ndeg, int64_t longitude_ndeg) const {
  if (!has_anchor_) return 0.0f;
  return Radians(WrapLongitude(longitude_ndeg - longitude_ndeg_)) * Sin(Radians(latitude_ndeg));
}

}  // namespace hardpack
