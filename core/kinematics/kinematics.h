// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "core/base/math.h"

// How a vehicle can move, by how it is steered: the one place that knows. All about the body
// frame's origin: the centre of a skid-steered vehicle's axle, or of the rear axle where front
// wheels are steered, whose motion is always along the heading (docs/vehicle.md).
//
//   skid-steered   any curvature, and a turn on the spot
//   Ackermann      kappa = tan(delta) / L, |delta| <= max_steering_rad; no turn on the spot
//
// delta is the steering angle of a wheel in the middle of the front axle, L the wheelbase: the
// bicycle model (J. Ackermann's steering geometry makes the two front wheels turn about its
// centre).

namespace hardpack {

constexpr bool CanPivot(const VehicleParams& vehicle) {
  return vehicle.kinematics == VehicleParams::kSkidSteered;
}

// The largest magnitude of a curvature [1/m]: 1 / least turning radius; kAnyCurvature_per_m of a
// vehicle that can turn on the spot. Precondition: the parameters are in their ranges.
inline constexpr float kAnyCurvature_per_m = 1.0e6f;
float MostCurvature(const VehicleParams& vehicle);

// The part of it that a plan may ask for: the rest is for tracking it.
inline constexpr float kPlannedCurvatureShare = 0.9f;

// The curvature that a steering angle drives, and the angle that a curvature needs: the forward and
// the inverse model. Clamped to what the vehicle can. 0 for a vehicle without a steering angle.
float CurvatureOfSteering(const VehicleParams& vehicle, float steering_rad);
float SteeringOfCurvature(const VehicleParams& vehicle, float curvature_per_m);

// The yaw rate nearest to the one that is wanted which the vehicle can have at a speed:
// |w| <= |v| MostCurvature. All that is finite of a vehicle that can turn on the spot.
float PossibleYawRate(const VehicleParams& vehicle, float speed_mps, float yaw_rate_radps);

}  // namespace hardpack
