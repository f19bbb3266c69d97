// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "core/base/math.h"

// How a vehicle can move, depending on its steering. This is the only place that knows. Everything
// refers to the body frame's origin: the centre of a skid-steered vehicle's axle, or of the rear
// axle if the front wheels are steered, whose motion is always along the heading (docs/vehicle.md).
//
//   skid-steered   any curvature, and a turn on the spot
//   Ackermann      kappa = tan(delta) / L, |delta| <= max_steering_rad; no turn on the spot
//
// delta is the steering angle of a virtual wheel in the middle of the front axle, L the wheelbase:
// the bicycle model (Ackermann steering geometry makes the two front wheels turn about its centre).

namespace hardpack {

constexpr bool CanPivot(const VehicleParams& vehicle) {
  return vehicle.kinematics == VehicleParams::kSkidSteered;
}

// The largest magnitude of a curvature [1/m]: 1 / minimum turning radius; kAnyCurvature_per_m for a
// vehicle that can turn on the spot. Precondition: the parameters are in range.
inline constexpr float kAnyCurvature_per_m = 1.0e6f;
float MostCurvature(const VehicleParams& vehicle);

// The share of it that a plan may use; the rest is for tracking.
inline constexpr float kPlannedCurvatureShare = 0.9f;

// The curvature for a steering angle, and the angle for a curvature: the forward and the inverse
// model. Clamped to what the vehicle can do. 0 for a vehicle without a steering angle.
float CurvatureOfSteering(const VehicleParams& vehicle, float steering_rad);
float SteeringOfCurvature(const VehicleParams& vehicle, float curvature_per_m);

// The possible yaw rate closest to the requested one at a speed: |w| <= |v| MostCurvature. For a
// vehicle that can turn on the spot, any finite one.
float PossibleYawRate(const VehicleParams& vehicle, float speed_mps, float yaw_rate_radps);

}  // namespace hardpack
