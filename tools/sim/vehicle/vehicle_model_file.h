// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/vehicle/steered_model_params.h"
#include "tools/sim/vehicle/vehicle_model_params.h"

// A vehicle for the simulator as a TOML file (config/vehicles): one table, [vehicle_model] of a
// skid-steered vehicle or [steered_model] of one with steered wheels, with every number of it
// (ParametersOf), with its standard deviation or as exact:
//
//   [vehicle_model]
//   skid_baseline_m = { value = 1.88, deviation = 0.05 }
//   wheel_radius_m = 0.3
//
// Nothing is guessed: an unknown or a missing key, another type, what is not finite or out of its
// range are errors, all told at once, one a line, with the line of the file where there is one.

namespace hardpack::sim {

inline constexpr size_t kMaxVehicleFileBytes = 64 * 1024;

// On failure `vehicle` is untouched. kInvalidArgument (no TOML, unknown, missing, of another type),
// kNotFinite, kParameterOutOfRange, kOversized; the first problem's status.
ReadOutcome ParseVehicle(std::string_view toml, const std::string& name, UncertainVehicle& vehicle);
ReadOutcome ReadVehicle(const std::string& path, UncertainVehicle& vehicle);

// Of either kind: that of the table which the file has.
using UncertainBody = std::variant<UncertainVehicle, UncertainSteered>;
ReadOutcome ParseBody(std::string_view toml, const std::string& name, UncertainBody& vehicle);
ReadOutcome ReadBody(const std::string& path, UncertainBody& vehicle);

// A file that reads as the same vehicle, exactly; `comment` (lines without #) on top, and each
// number's description and range beside it.
std::string VehicleToToml(const UncertainVehicle& vehicle, const std::string& comment);
std::string VehicleToToml(const UncertainBody& vehicle, const std::string& comment);

// The shortest text that reads as the same number.
std::string NumberText(double value);

}  // namespace hardpack::sim
