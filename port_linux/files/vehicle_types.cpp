// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/vehicle_types.h"

#include "hal/onboard/vehicle_loop/vehicles.h"

namespace hardpack {
namespace {

template <typename... Vehicle>
std::vector<std::string_view> TypesOf(VehicleList<Vehicle...>) {
  return {Vehicle::kType...};
}

}  // namespace

std::vector<std::string_view> VehicleTypes() {
  return TypesOf(Vehicles{});
}

}  // namespace hardpack
