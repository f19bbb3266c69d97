// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/sim/sensors/lidar_settings.h"

// The data packets of a VLP-16 or a VLP-32C in strongest-return mode: 12 blocks of 32 returns, each
// with the azimuth of the block's first laser, the time of the packet's first laser, and the
// product code. Written independently from the manufacturer's manuals (REFERENCES.md), so that it
// tests the library's code instead of repeating it.

namespace hardpack::sim {

class VelodynePackets {
 public:
  static constexpr size_t kBytes = 1206;  // of a datagram's payload
  static constexpr int kBlocks = 12;
  static constexpr int kReturnsPerBlock = 32;

  explicit VelodynePackets(LidarModel model);

  // A firing sequence of 16 lasers, two per block, or of 32. azimuth_turns: [0, 1), the head's
  // azimuth at its first laser, and stamp_ns the time. True: the packet is complete, and bytes()
  // returns it.
  bool Append(double azimuth_turns, uint64_t stamp_ns, const LidarReturns& returns);
  const std::vector<uint8_t>& bytes() const { return bytes_; }
  // Drops an incomplete packet.
  void Restart();

 private:
  LidarModel model_;
  int returns_ = 0;  // in the current packet
  uint32_t first_us_ = 0;
  std::vector<uint8_t> bytes_;
};

}  // namespace hardpack::sim
