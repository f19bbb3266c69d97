// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "hal/can_batch.h"
#include "hal/can_frame.h"

// The requirements on a device of a vehicle (hal/onboard/vehicle_loop/vehicles.h). Bytes in,
// measurements out; no clock, no heap, no pointer in the state, every loop with its bound. The
// compiler checks the form, test/hal/conformance the rest.

namespace hardpack {

// The state of a device is copied into a flight log.
template <typename T>
concept DeviceState = std::is_trivially_copyable_v<T> && std::default_initializable<T>;

// A lidar that sends columns: all beams in one direction, at one time.
//
//   Config, LayoutOf, MostColumnsPerSecond  its description; the layout refers to the configuration
//   Check       checks a datagram before any column is taken from it. kOk: its columns can be
//               decoded; kSensorRestarted: the sensor has restarted, and Check says so until
//               Resume; anything else: refused
//   columns     of a datagram that Check accepted, at most kMaxColumns
//   Decode      one of them. Not usable: there is none, whatever `column` holds
template <typename T>
concept LidarDevice = DeviceState<T> && std::is_trivially_copyable_v<typename T::Config> &&
    requires(T lidar, const T& known, const typename T::Config& config,
             std::span<const uint8_t> datagram, int index, LidarColumn& column) {
  { T::kMaxColumns } -> std::convertible_to<int>;
  { T::LayoutOf(config) } -> std::same_as<LidarLayout>;
  { T::MostColumnsPerSecond(config) } -> std::same_as<int32_t>;
  { lidar.Configure(config) } -> std::same_as<Status>;
  { lidar.Check(datagram) } -> std::same_as<Status>;
  { lidar.Resume() } -> std::same_as<void>;
  { known.columns() } -> std::same_as<int>;
  { known.Decode(datagram, index, column) } -> std::same_as<Status>;
};

// An inertial navigation system whose messages arrive in a stream that datagrams cut anywhere, or
// one per datagram.
//
//   BeginTick   limits the messages that Next examines from now on
//   Feed        takes as many bytes as there is room for, and returns their number
//   Next        the next sample. Not usable: there is none, until more is fed or the next tick
//   Reset       drops what was fed and not returned
template <typename T>
concept InsDevice = DeviceState<T> &&
    requires(T ins, std::span<const uint8_t> bytes, InsSample& sample) {
  { ins.BeginTick(0) } -> std::same_as<void>;
  { ins.Feed(bytes) } -> std::same_as<size_t>;
  { ins.Next(sample) } -> std::same_as<Status>;
  { ins.Reset() } -> std::same_as<void>;
};

// The device that drives the wheels and reports how they turn.
//
//   ParamsOf    its part of the configuration; Configure also gets the vehicle's
//   TakeFrame   each received frame of the bus, in order
//   State       of this tick, after its frames
//   Tick        once, after State: adds the frames to send
//   AreOff      no drive can produce torque: each has said so, or has been silent for longer than a
//               stop takes
template <typename T>
concept DriveDevice = DeviceState<T> &&
    requires(T drives, const T& known, const VehicleParams& vehicle, const OnboardParams& onboard,
             const CanFrame& frame, uint64_t now_ns, const DriveDemand& demand, CanBatch& out) {
  { drives.Configure(vehicle, T::ParamsOf(onboard)) } -> std::same_as<Status>;
  { drives.TakeFrame(frame, now_ns) } -> std::same_as<void>;
  { known.State(now_ns) } -> std::same_as<DriveFeedback>;
  { known.AreOff(now_ns) } -> std::same_as<bool>;
  { drives.Tick(now_ns, demand, out) } -> std::same_as<void>;
};

}  // namespace hardpack
