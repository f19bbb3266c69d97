// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

// The names of the vehicles that the program is built with: what vehicle.type may be.

namespace hardpack {

std::vector<std::string_view> VehicleTypes();

// Which devices such a vehicle has, as far as its configuration differs by them. Of a type that
// there is not: none.
struct VehicleDevices {
  bool ouster = false;
  bool velodyne = false;
  bool pose_datagram = false;
  bool sevcon = false;
  bool twist_drive = false;
};
VehicleDevices DevicesOf(std::string_view type);

}  // namespace hardpack
