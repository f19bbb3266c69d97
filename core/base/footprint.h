// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/pose.h"

// The vehicle's outline seen from above, and quantities derived from it. All code that needs the
// position of the vehicle's sides gets it here, derived from three numbers of VehicleParams.
//
//             y
//      +------|-----------+ half_width_m
//      |  o   |o   o   o  |      o  the discs' centres
//      |      +-----------|---> x
//      |     axle         |
//      +------------------+ -half_width_m
//    rear_m             front_m
//
// Body frame: the origin is the centre of the axle, the point about which the vehicle turns on the
// spot, not the middle of the outline. docs/vehicle.md explains how to measure it.

namespace hardpack {

struct Footprint {
  static constexpr int kMaxDiscs = 16;
  // At least two, and enough that they reach no more than this beyond the flank.
  static constexpr float kMaxDiscOverhang_m = 0.1f;

  float front_m = 0.0f;       // of the front edge along x
  float rear_m = 0.0f;        // of the rear edge along x; negative where it is behind the axle
  float half_width_m = 0.0f;  // of the flanks along y, to either side

  // Discs of one radius, evenly spaced along the x axis, that together cover the outline; used for
  // distance lookups in a map. disc_radius_m - half_width_m is their overhang beyond the flank. At
  // the front and rear they reach no farther than the overhang of one disc.
  int32_t discs = 0;
  float disc_radius_m = 0.0f;
  float disc_step_m = 0.0f;  // between centres

  // Radius of the circle about the origin that the outline sweeps in a full turn on the spot.
  float pivot_radius_m = 0.0f;

  // Position of a disc's centre along x. Precondition: 0 <= disc < discs.
  constexpr float DiscAhead(int disc) const {
    return rear_m + (static_cast<float>(disc) + 0.5f) * disc_step_m;
  }
  constexpr float middle_m() const { return 0.5f * (front_m + rear_m); }
  constexpr float half_length_m() const { return 0.5f * (front_m - rear_m); }
};
static_assert(std::is_trivially_copyable_v<Footprint>);

// Single values, for callers that need no more: positions of the front and the rear edge along x.
constexpr float FrontOf(const VehicleParams& vehicle) {
  return 0.5f * vehicle.length_m - vehicle.axle_offset_m;
}
constexpr float RearOf(const VehicleParams& vehicle) {
  return -0.5f * vehicle.length_m - vehicle.axle_offset_m;
}
// The edge that goes first, as a distance from the axle: positive in reverse too.
constexpr float LeadingEdgeOf(const VehicleParams& vehicle, bool reverse) {
  return reverse ? -RearOf(vehicle) : FrontOf(vehicle);
}
constexpr float TrailingEdgeOf(const VehicleParams& vehicle, bool reverse) {
  return LeadingEdgeOf(vehicle, !reverse);
}
float PivotRadiusOf(const VehicleParams& vehicle);

// vehicle: all parameters in range. Cost: at most kMaxDiscs square roots.
Footprint FootprintOf(const VehicleParams& vehicle);

// Distance from a point of the body frame to the outline; 0 inside it [m].
float DistanceToOutline(const Footprint& footprint, Vec2 point_body);

}  // namespace hardpack
