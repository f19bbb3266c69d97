// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/onboard/vehicle_loop/devices.h"
#include "hal/ouster/lidar.h"
#include "hal/sevcon/sevcon.h"
#include "hal/vectornav/stream_parser.h"

// The vehicles that are built. one of your own is a struct of this form.

namespace hardpack {

// Which devices make a vehicle, as types.
template <typename T>
concept VehicleType =
    LidarDevice<typename T::Lidar> && InsDevice<typename T::Ins> && DriveDevice<typename T::Drives>;

// Clearpath's Warthog as its operators fit it out: an Ouster, a VectorNav, two Sevcon Gen4.
struct Warthog {
  using Lidar = ouster::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = sevcon::DrivePair;
};
static_assert(VehicleType<Warthog>);

}  // namespace hardpack
