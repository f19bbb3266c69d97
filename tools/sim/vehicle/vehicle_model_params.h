// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "port_linux/files/read_outcome.h"

// The parameters of a simulated skid-steered vehicle (tools/sim/vehicle/vehicle_model.h explains
// each), their known variation, and vehicles drawn from it. Fitted to a recording by
// `hardpack fit`, stored in config/vehicles (vehicle_model_file.h).

namespace hardpack::sim {

// Units in the names; the defaults are near config/vehicles/warthog_recorded.toml. Common and
// differential wheel speed: (right + left) / 2 and (right - left) / 2.
struct VehicleModelParams {
  double dead_time_common_s = 0.147;
  double dead_time_differential_s = 0.125;
  double time_constant_common_s = 0.227;
  double time_constant_differential_s = 0.431;
  double slew_common_radps2 = 14.35;
  double slew_differential_radps2 = 5.79;
  double common_turn_loss = 0.152;
  double scrub_radps = 1.82;
  double scrub_width_radps = 1.04;
  double integral_time_s = 3.72;
  double differential_limit_radps = 7.06;
  double differential_limit_slope = 0.117;
  double wheel_limit_radps = 13.4;
  double brake_radps2 = 30.0;
  double wheel_radius_m = 0.30;
  double ground_per_wheel = 0.961;
  double turn_slip = 0.467;
  double skid_baseline_m = 1.925;
  double speed_time_constant_s = 0.305;
  double yaw_time_constant_s = 0.21;
  double turning_point_m = 0.797;
  double turning_point_speed_mps = 1.67;
};

// Params: the parameters of a kind of vehicle, a struct of doubles.
template <typename Params>
struct ModelParameter {
  const char* name;
  double Params::*value;
  double low;
  double high;
  const char* description;
};

// One row per member, in the order of the struct.
template <typename Params>
std::span<const ModelParameter<Params>> ParametersOf();
template <>
std::span<const ModelParameter<VehicleModelParams>> ParametersOf<VehicleModelParams>();

using VehicleParameter = ModelParameter<VehicleModelParams>;
inline std::span<const VehicleParameter> VehicleParameters() {
  return ParametersOf<VehicleModelParams>();
}

// kNotFinite or kParameterOutOfRange, and a line that names the parameter and its range.
template <typename Params>
ReadOutcome CheckVehicleModel(const Params& params);

// What is known about a vehicle: `typical`, and the standard deviation of each number from it; 0:
// exact.
template <typename Params>
struct Uncertain {
  Params typical;
  Params deviation;

  Uncertain();  // no deviations
};
using UncertainVehicle = Uncertain<VehicleModelParams>;

// Draws one such vehicle: each number from a normal distribution (a sum of twelve uniform ones),
// truncated at two deviations and at its range. The same seed gives the same bits everywhere; the
// draw of a number depends on its name, not on the other numbers.
template <typename Params>
Params Draw(const Uncertain<Params>& vehicle, uint64_t seed);

}  // namespace hardpack::sim
