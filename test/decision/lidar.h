// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/measurements/measurements.h"
#include "hal/ouster/ouster.h"
#include "test/decision/random.h"
#include "test/decision/world.h"

// An OS1-64 that drives through a World and sends LEGACY packets of what it sees, with noise,
// dropped returns and an invalid column now and then. Integers and core/base arithmetic only, so
// that the bytes are the same everywhere.

namespace hardpack::decision {

inline constexpr int kBeams = 64;
inline constexpr int kColumns = 512;  // a revolution: the sensor's 512x10 mode
inline constexpr int kColumnsPerPacket = 16;
inline constexpr int kPackets = kColumns / kColumnsPerPacket;
inline constexpr int kPacketBytes = kColumnsPerPacket * (16 + 12 * kBeams + 4);

class SyntheticLidar {
 public:
  // kOk unless core or hal refuse the sensor's own description.
  Status Configure(uint32_t seed);

  const ouster::Metadata& metadata() const { return metadata_; }
  const BeamModel& model() const { return model_; }

  // Packet `index` (0 .. kPackets - 1) of a revolution, and the true label of each return.
  // odom_from_sensor: [kColumns], the sensor's pose at each column.
  void MakePacket(const World& world, std::span<const Transform3> odom_from_sensor, int index,
                  int revolution = 0);
  std::span<const uint8_t> packet() const { return packet_; }
  std::span<const ColumnLabels> labels() const { return labels_; }

 private:
  void Put(size_t offset, uint64_t value, size_t size);
  uint32_t Measure(const World& world, const Transform3& odom_from_sensor, SinCosPair encoder,
                   int row, uint8_t& label);

  ouster::Metadata metadata_;
  BeamModel model_;
  Random random_{1};
  uint8_t packet_[kPacketBytes] = {};
  ColumnLabels labels_[kColumnsPerPacket];
};

}  // namespace hardpack::decision
