// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

// The names of the vehicles that the program is built with: what vehicle.type may be.

namespace hardpack {

std::vector<std::string_view> VehicleTypes();

}  // namespace hardpack
