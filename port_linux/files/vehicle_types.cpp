// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/vehicle_types.h"

#include <type_traits>

#include "hal/onboard/vehicle_loop/vehicles.h"

namespace hardpack {
namespace {

template <typename... Vehicle>
std::vector<std::string_view> TypesOf(VehicleList<Vehicle...>) {
  return {Vehicle::kType...};
}

template <typename... Vehicle>
VehicleDevices DevicesIn(VehicleList<Vehicle...>, std::string_view type) {
  VehicleDevices devices;
  const auto take = [&]<typename V>(V) {
    if (type != V::kType) return;
    devices.ouster = std::is_same_v<typename V::Lidar, ouster::Lidar>;
    devices.velodyne = std::is_same_v<typename V::Lidar, velodyne::Lidar>;
    devices.pose_datagram = std::is_same_v<typename V::Ins, pose_datagram::Receiver>;
    devices.sevcon = std::is_same_v<typename V::Drives, sevcon::DrivePair>;
    devices.twist_drive = std::is_same_v<typename V::Drives, twist_drive::TwistDrive>;
  };
  (take(Vehicle{}), ...);
  return devices;
}

}  // namespace

std::vector<std::string_view> VehicleTypes() {
  return TypesOf(Vehicles{});
}

VehicleDevices DevicesOf(std::string_view type) {
  return DevicesIn(Vehicles{}, type);
}

}  // namespace hardpack
