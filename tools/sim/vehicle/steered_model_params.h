// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tools/sim/vehicle/vehicle_model_params.h"

// The parameters of a simulated vehicle with steered wheels (tools/sim/vehicle/steered_model.h
// explains each); config/vehicles/ackermann.toml has a set with the source of each.

namespace hardpack::sim {

struct SteeredModelParams {
  double dead_time_speed_s = 0.1;
  double time_constant_speed_s = 0.3;
  double max_acceleration_mps2 = 2.0;
  double max_deceleration_mps2 = 3.0;
  double max_speed_mps = 5.0;
  double measured_speed_share = 1.0;
  double dead_time_steering_s = 0.1;
  double time_constant_steering_s = 0.15;
  double steering_rate_radps = 0.7;
  double max_steering_rad = 0.489;
  double wheelbase_m = 1.23;
  double understeer_s2pm2 = 0.004;
  double yaw_time_constant_s = 0.1;
  double length_m = 2.0;
  double width_m = 1.5;
  double rear_overhang_m = 0.385;
  double track_m = 1.2;
  double lidar_x_m = 0.615;
  double lidar_z_m = 1.284;
};

template <>
std::span<const ModelParameter<SteeredModelParams>> ParametersOf<SteeredModelParams>();

using UncertainSteered = Uncertain<SteeredModelParams>;

}  // namespace hardpack::sim
