// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/sim/sensors/lidar_settings.h"

// The datagrams of an OS1-64, and the description that goes with them. Layouts are written
// independently from the manufacturer's description (REFERENCES.md), so that they test the
// library's code instead of repeating it.

namespace hardpack::sim {

class OusterPackets {
 public:
  static constexpr int kColumns = 16;

  struct Column {
    uint16_t measurement_id = 0;
    uint16_t frame_id = 0;
    uint64_t stamp_ns = 0;
    bool is_valid = true;
  };

  explicit OusterPackets(const LidarSettings& settings);

  // True: the packet is complete, and bytes() returns it.
  bool Append(const Column& column, const LidarReturns& returns);
  const std::vector<uint8_t>& bytes() const { return bytes_; }
  // Restarts with another init id; an incomplete packet is dropped.
  void Restart();

  std::string MetadataJson(const LidarSettings& settings) const;

 private:
  void Begin(uint16_t frame_id);
  void AppendColumn(const Column& column, const LidarReturns& returns);

  bool legacy_;
  uint32_t columns_;
  uint32_t init_id_ = 0x00abcd;
  std::vector<uint8_t> bytes_;
};

}  // namespace hardpack::sim
