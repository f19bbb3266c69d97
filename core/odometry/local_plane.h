// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"
#include "core/base/status.h"

// Latitude and longitude of WGS 84 as metres east (x) and north (y) of an anchor, and back: the
// plane tangent to the ellipsoid there, ignoring heights (REFERENCES.md). With phi, lambda from the
// anchor's phi_0, lambda_0, radii of curvature M (meridian) and N:
//
//   east  = N(phi) cos(phi) sin(lambda - lambda_0)
//   north = M(middle) (d - d^3 / 6) + N(phi) cos(phi) sin(phi_0) (1 - cos(lambda - lambda_0)),
//           d = phi - phi_0
//
// In single precision. Within 20 km of an anchor up to 80 degrees from the equator the error
// against the exact plane is less than 2 cm, and there and back less than 1 cm (tested).

namespace hardpack {

class LocalPlane {
 public:
  static constexpr int64_t kMaxLatitude_ndeg = 85'000'000'000;
  static constexpr float kMaxRange_m = 100'000.0f;

  // kInvalidArgument: a latitude beyond kMaxLatitude_ndeg, where east is poorly defined, or a
  // longitude beyond 180 degrees: nothing changes.
  Status SetAnchor(int64_t latitude_ndeg, int64_t longitude_ndeg);
  void Reset() { has_anchor_ = false; }
  bool has_anchor() const { return has_anchor_; }

  // kNotStarted: no anchor; kInvalidArgument: farther from it than kMaxRange_m in either direction,
  // or no such place: `place` is unchanged.
  Status ToPlane(int64_t latitude_ndeg, int64_t longitude_ndeg, Vec2& place) const;

  // The statuses of ToPlane; kNotFinite.
  Status ToGeodetic(Vec2 place, int64_t& latitude_ndeg, int64_t& longitude_ndeg) const;

  // The direction of true north there, anticlockwise from the plane's y: add it to a heading from
  // true east to get the heading from the plane's x. 0 without an anchor.
  float Convergence(int64_t latitude_ndeg, int64_t longitude_ndeg) const;

 private:
  bool has_anchor_ = false;
  int64_t latitude_ndeg_ = 0;
  int64_t longitude_ndeg_ = 0;
};
static_assert(std::is_trivially_copyable_v<LocalPlane>);

}  // namespace hardpack
