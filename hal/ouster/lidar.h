// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/measurements/measurements.h"
#include "hal/ouster/ouster.h"
#include "hal/ouster/packet_monitor.h"

// An Ouster as the lidar of a vehicle (hal/onboard/vehicle_loop/devices.h).

namespace hardpack::ouster {

class Lidar {
 public:
  using Config = Metadata;
  static constexpr int kMaxColumns = kMaxColumnsPerPacket;

  static LidarLayout LayoutOf(const Metadata& metadata);
  // The metadata do not give the rotation rate: assumes 20 revolutions per second, or 10 with 2048
  // columns.
  static int32_t MostColumnsPerSecond(const Metadata& metadata);

  Status Configure(const Metadata& metadata) { return monitor_.Configure(metadata); }
  Status Check(std::span<const uint8_t> datagram) {
    PacketHeader header;
    return monitor_.Check(datagram, header);
  }
  void Resume() { monitor_.Resume(); }
  int columns() const { return monitor_.layout().columns_per_packet; }
  Status Decode(std::span<const uint8_t> datagram, int index, LidarColumn& column) const {
    return DecodeColumn(monitor_.layout(), datagram, index, column);
  }

  const PacketMonitor& monitor() const { return monitor_; }

 private:
  PacketMonitor monitor_;
};
static_assert(std::is_trivially_copyable_v<Lidar>);

}  // namespace hardpack::ouster
