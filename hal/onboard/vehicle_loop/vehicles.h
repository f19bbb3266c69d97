// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/onboard/vehicle_loop/devices.h"
#include "hal/ouster/lidar.h"
#include "hal/sevcon/sevcon.h"
#include "hal/vectornav/stream_parser.h"

// The vehicles that are built. One of your own is a struct of this form.

namespace hardpack {

// Which devices make a vehicle, as types; kType: what vehicle.type in a configuration calls it, at
// most kMaxVehicleType letters.
inline constexpr int kMaxVehicleType = 31;
template <typename T>
concept VehicleType = LidarDevice<typename T::Lidar> && InsDevice<typename T::Ins> &&
    DriveDevice<typename T::Drives> && requires {
  { T::kType } -> std::convertible_to<const char*>;
};

// Clearpath's Warthog as its operators fit it out: an Ouster, a VectorNav, two Sevcon Gen4.
struct Warthog {
  static constexpr const char* kType = "warthog";
  using Lidar = ouster::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = sevcon::DrivePair;
};
static_assert(VehicleType<Warthog>);

template <VehicleType... Vehicle>
struct VehicleList {};

// All that one program can drive. Each is instantiated once, in vehicle_loop.cpp.
using Vehicles = VehicleList<Warthog>;

}  // namespace hardpack
