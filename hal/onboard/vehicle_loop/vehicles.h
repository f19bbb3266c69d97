// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/onboard/vehicle_loop/devices.h"
#include "hal/ouster/lidar.h"
#include "hal/pose_datagram/pose_datagram.h"
#include "hal/sevcon/sevcon.h"
#include "hal/twist_drive/twist_drive.h"
#include "hal/vectornav/stream_parser.h"
#include "hal/velodyne/lidar.h"

// The vehicles that are built. Your own vehicle is a struct of this form.

namespace hardpack {

// The devices of a vehicle, as types; kType: its name in the configuration (vehicle.type), at most
// kMaxVehicleType letters.
inline constexpr int kMaxVehicleType = 31;
template <typename T>
concept VehicleType = LidarDevice<typename T::Lidar> && InsDevice<typename T::Ins> &&
    DriveDevice<typename T::Drives> && requires {
  { T::kType } -> std::convertible_to<const char*>;
};

// Clearpath's Warthog as equipped by its operators: an Ouster, a VectorNav, two Sevcon Gen4.
struct Warthog {
  static constexpr const char* kType = "warthog";
  using Lidar = ouster::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = sevcon::DrivePair;
};
static_assert(VehicleType<Warthog>);

// A Warthog with a Velodyne VLP-16 or VLP-32C in place of the Ouster.
struct WarthogVelodyne {
  static constexpr const char* kType = "warthog_velodyne";
  using Lidar = velodyne::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = sevcon::DrivePair;
};
static_assert(VehicleType<WarthogVelodyne>);

// Any vehicle with its own motion controller, skid-steered or with steered wheels (by
// vehicle.kinematics), and any navigation system: for example a ROS 2 base (docs/twist_drive.md,
// docs/pose_datagram.md).
struct TwistBase {
  static constexpr const char* kType = "twist_base";
  using Lidar = ouster::Lidar;
  using Ins = pose_datagram::Receiver;
  using Drives = twist_drive::TwistDrive;
};
static_assert(VehicleType<TwistBase>);

template <VehicleType... Vehicle>
struct VehicleList {};

// All vehicles that one program can drive. Each is instantiated once, in vehicle_loop.cpp.
using Vehicles = VehicleList<Warthog, WarthogVelodyne, TwistBase>;

}  // namespace hardpack
