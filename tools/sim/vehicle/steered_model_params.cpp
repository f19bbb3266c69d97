// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/steered_model_params.h"

#include <array>

namespace hardpack::sim {
namespace {

using P = SteeredModelParams;

constexpr std::array<ModelParameter<P>, 19> kParameters = {{
    {"dead_time_speed_s", &P::dead_time_speed_s, 0.0, 1.0,
     "from a commanded speed to its first effect"},
    {"time_constant_speed_s", &P::time_constant_speed_s, 0.02, 10.0,
     "first-order lag of the speed"},
    {"max_acceleration_mps2", &P::max_acceleration_mps2, 0.1, 20.0, "away from rest"},
    {"max_deceleration_mps2", &P::max_deceleration_mps2, 0.1, 20.0, "toward rest, brake too"},
    {"max_speed_mps", &P::max_speed_mps, 0.1, 30.0, "it drives no faster, either way"},
    {"measured_speed_share", &P::measured_speed_share, 0.8, 1.2,
     "speed that its controller measures, over the true one"},
    {"dead_time_steering_s", &P::dead_time_steering_s, 0.0, 1.0,
     "from a commanded steering angle to its first effect"},
    {"time_constant_steering_s", &P::time_constant_steering_s, 0.02, 10.0,
     "first-order lag of the steering angle"},
    {"steering_rate_radps", &P::steering_rate_radps, 0.05, 20.0, "largest change of that angle"},
    {"max_steering_rad", &P::max_steering_rad, 0.05, 1.2,
     "largest mean angle of the front wheels, to either side"},
    {"wheelbase_m", &P::wheelbase_m, 0.2, 10.0, "from the rear axle to the front axle"},
    {"understeer_s2pm2", &P::understeer_s2pm2, 0.0, 0.2,
     "how much less it turns at speed: by 1 + this times the square of the speed"},
    {"yaw_time_constant_s", &P::yaw_time_constant_s, 0.0, 5.0, "first-order lag of the yaw rate"},
    {"length_m", &P::length_m, 0.2, 12.0, "overall"},
    {"width_m", &P::width_m, 0.2, 4.0, "overall"},
    {"rear_overhang_m", &P::rear_overhang_m, 0.0, 6.0, "from its rear end to the rear axle"},
    {"track_m", &P::track_m, 0.1, 4.0, "between the middles of the wheels of an axle"},
    {"lidar_x_m", &P::lidar_x_m, -5.0, 10.0, "lidar ahead of the rear axle"},
    {"lidar_z_m", &P::lidar_z_m, 0.1, 5.0, "lidar above the ground"},
}};

}  // namespace

template <>
std::span<const ModelParameter<P>> ParametersOf<P>() {
  return kParameters;
}

}  // namespace hardpack::sim
