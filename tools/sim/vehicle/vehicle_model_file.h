// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/vehicle/steered_model_params.h"
#include "tools/sim/vehicle/vehicle_model_params.h"

// A vehicle for the simulator as a TOML file (config/vehicles): one table, [vehicle_model] for a
// skid-steered vehicle or [steered_model] for one with steered wheels, with all its parameters
// (ParametersOf), each with a standard deviation or exact:
//
//   [vehicle_model]
//   skid_baseline_m = { value = 1.88, deviation = 0.05 }
//   wheel_radius_m = 0.3
//
// Nothing is guessed: unknown or missing keys, wrong types, and values that are not finite or out
// of range are errors. All are reported at once, one per line, with the line in the file if there
// is one.

namespace hardpack::sim {

inline constexpr size_t kMaxVehicleFileBytes = 64 * 1024;

// On failure `vehicle` is untouched. kInvalidArgument (not TOML; an unknown or missing key, a wrong
// type), kNotFinite, kParameterOutOfRange, kOversized; the status of the first problem.
ReadOutcome ParseVehicle(std::string_view toml, const std::string& name, UncertainVehicle& vehicle);
ReadOutcome ReadVehicle(const std::string& path, UncertainVehicle& vehicle);

// Either kind, depending on the table in the file.
using UncertainBody = std::variant<UncertainVehicle, UncertainSteered>;
ReadOutcome ParseBody(std::string_view toml, const std::string& name, UncertainBody& vehicle);
ReadOutcome ReadBody(const std::string& path, UncertainBody& vehicle);

// A file that reads back as exactly the same vehicle, with `comment` (lines without #) on top, and
// the description and range of each number beside it.
std::string VehicleToToml(const UncertainVehicle& vehicle, const std::string& comment);
std::string VehicleToToml(const UncertainBody& vehicle, const std::string& comment);

// The shortest text that reads back as the same number.
std::string NumberText(double value);

}  // namespace hardpack::sim
