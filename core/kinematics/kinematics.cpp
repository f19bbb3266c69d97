// SPDX-License-Identifier: Apache-2.0
#include "core/kinematics/kinematics.h"

namespace hardpack {

float MostCurvature(const VehicleParams& vehicle) {
  if (CanPivot(vehicle)) return kAnyCurvature_per_m;
  return CurvatureOfSteering(vehicle, vehicle.max_steering_rad);
}

float CurvatureOfSteering(const VehicleParams& vehicle, float steering_rad) {
  if (CanPivot(vehicle)) return 0.0f;
  const SinCosPair steering =
      SinCos(Clamp(steering_rad, -vehicle.max_steering_rad, vehicle.max_steering_rad));
  return steering.sin / (steering.cos * vehicle.wheelbase_m);
}

float SteeringOfCurvature(const VehicleParams& vehicle, float curvature_per_m) {
  if (CanPivot(vehicle)) return 0.0f;
  const float steering_rad = Atan2(curvature_per_m * vehicle.wheelbase_m, 1.0f);
  return Clamp(steering_rad, -vehicle.max_steering_rad, vehicle.max_steering_rad);
}

float PossibleYawRate(const VehicleParams& vehicle, float speed_mps, float yaw_rate_radps) {
  if (CanPivot(vehicle)) return yaw_rate_radps;
  const float most_radps = Abs(speed_mps) * MostCurvature(vehicle);
  return Clamp(yaw_rate_radps, -most_radps, most_radps);
}

}  // namespace hardpack
