// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/vehicle_model_params.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <string_view>

#include "tools/sim/vehicle/steered_model_params.h"

namespace hardpack::sim {
namespace {

using P = VehicleModelParams;

constexpr std::array<ModelParameter<P>, 22> kParameters = {{
    {"dead_time_common_s", &P::dead_time_common_s, 0.0, 1.0,
     "from a setpoint of both sides together to its first effect"},
    {"dead_time_differential_s", &P::dead_time_differential_s, 0.0, 1.0,
     "from a setpoint of the sides' difference to its first effect"},
    {"time_constant_common_s", &P::time_constant_common_s, 0.02, 10.0,
     "first-order lag of the common wheel speed"},
    {"time_constant_differential_s", &P::time_constant_differential_s, 0.02, 10.0,
     "first-order lag of the differential wheel speed"},
    {"slew_common_radps2", &P::slew_common_radps2, 0.1, 1000.0,
     "largest change of the common wheel speed"},
    {"slew_differential_radps2", &P::slew_differential_radps2, 0.1, 1000.0,
     "largest change of the differential wheel speed"},
    {"common_turn_loss", &P::common_turn_loss, 0.0, 0.9,
     "share of the common wheel speed that a turn on the spot would lose"},
    {"scrub_radps", &P::scrub_radps, 0.0, 10.0,
     "what of the differential setpoint is spent on the wheels' sideways scrubbing"},
    {"scrub_width_radps", &P::scrub_width_radps, 0.01, 10.0,
     "differential wheel speed at which 0.7 of that resistance is reached"},
    {"integral_time_s", &P::integral_time_s, 0.05, 100.0,
     "of the drives' integral action, which makes up for the scrubbing in the end"},
    {"differential_limit_radps", &P::differential_limit_radps, 0.1, 100.0,
     "differential wheel speed that a large setpoint reaches at standstill"},
    {"differential_limit_slope", &P::differential_limit_slope, 0.0, 1.0,
     "how much lower that is for each rad/s of the common wheel speed"},
    {"wheel_limit_radps", &P::wheel_limit_radps, 0.1, 100.0, "no wheel turns faster"},
    {"brake_radps2", &P::brake_radps2, 0.1, 1000.0,
     "how the spring-applied brake of an undriven side slows its wheels"},
    {"wheel_radius_m", &P::wheel_radius_m, 0.01, 2.0, "of the tyres"},
    {"ground_per_wheel", &P::ground_per_wheel, 0.1, 1.5,
     "speed over ground by the wheels' rim speed, straight ahead"},
    {"turn_slip", &P::turn_slip, 0.0, 0.9,
     "share of that speed that a turn on the spot would lose"},
    {"skid_baseline_m", &P::skid_baseline_m, 0.1, 10.0,
     "effective track: difference of rim speeds by yaw rate"},
    {"speed_time_constant_s", &P::speed_time_constant_s, 0.0, 5.0,
     "first-order lag of the body's speed behind its wheels"},
    {"yaw_time_constant_s", &P::yaw_time_constant_s, 0.0, 5.0,
     "first-order lag of the body's yaw rate behind its wheels"},
    {"turning_point_m", &P::turning_point_m, 0.0, 3.0,
     "how far ahead of the middle it turns at high speed"},
    {"turning_point_speed_mps", &P::turning_point_speed_mps, 0.01, 20.0,
     "speed at which 0.7 of that is reached"},
}};

double Uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1.0p-53;
}

// Mean 0, standard deviation 1 before it is cut off.
double CutNormal(std::mt19937_64& random) {
  constexpr int kUniforms = 12;
  constexpr double kCut = 2.0;
  for (;;) {  // the share that is beyond the cut is 4.5 %
    double sum = -0.5 * kUniforms;
    for (int i = 0; i < kUniforms; ++i) sum += Uniform(random);
    if (std::abs(sum) <= kCut) return sum;
  }
}

uint64_t HashOf(std::string_view name) {  // FNV-1a
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char letter : name) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace

template <>
std::span<const ModelParameter<P>> ParametersOf<P>() {
  return kParameters;
}

template <typename Params>
ReadOutcome CheckVehicleModel(const Params& params) {
  for (const ModelParameter<Params>& parameter : ParametersOf<Params>()) {
    const double value = params.*parameter.value;
    if (!std::isfinite(value)) {
      return {Status::kNotFinite, std::string(parameter.name) + ": is not a finite number"};
    }
    if (value < parameter.low || value > parameter.high) {
      return {Status::kParameterOutOfRange,
              std::string(parameter.name) + ": " + std::to_string(value) + " is not from " +
                  std::to_string(parameter.low) + " to " + std::to_string(parameter.high)};
    }
  }
  return {};
}

template <typename Params>
Uncertain<Params>::Uncertain() {
  for (const ModelParameter<Params>& parameter : ParametersOf<Params>()) {
    deviation.*parameter.value = 0.0;
  }
}

template <typename Params>
Params Draw(const Uncertain<Params>& vehicle, uint64_t seed) {
  Params drawn;
  for (const ModelParameter<Params>& parameter : ParametersOf<Params>()) {
    std::mt19937_64 random(HashOf(parameter.name) ^ seed * 0x9e3779b97f4a7c15u);
    const double value =
        vehicle.typical.*parameter.value + vehicle.deviation.*parameter.value * CutNormal(random);
    drawn.*parameter.value = std::clamp(value, parameter.low, parameter.high);
  }
  return drawn;
}

// Of each kind of vehicle.
template ReadOutcome CheckVehicleModel(const VehicleModelParams&);
template ReadOutcome CheckVehicleModel(const SteeredModelParams&);
template struct Uncertain<VehicleModelParams>;
template struct Uncertain<SteeredModelParams>;
template VehicleModelParams Draw(const Uncertain<VehicleModelParams>&, uint64_t);
template SteeredModelParams Draw(const Uncertain<SteeredModelParams>&, uint64_t);

}  // namespace hardpack::sim
