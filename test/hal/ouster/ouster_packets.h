// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "hal/ouster/ouster.h"

// Writes lidar packets from columns, from the published layouts and independently of the decoder:
// bytes are appended in order instead of being found at offsets.

namespace hardpack::ouster::test {

class ByteWriter {
 public:
  void Put(uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) bytes_.push_back(static_cast<uint8_t>(value >> (8 * i)));
  }
  const std::vector<uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<uint8_t> bytes_;
};

struct PacketIdentity {
  uint16_t packet_type = 1;
  uint16_t frame_id = 0;
  uint32_t init_id = 0;
  uint64_t serial_number = 0;
};

inline std::vector<uint8_t> EncodeLegacy(const std::vector<LidarColumn>& columns) {
  ByteWriter out;
  for (const LidarColumn& column : columns) {
    out.Put(column.timestamp_ns, 8);
    out.Put(column.measurement_id, 2);
    out.Put(column.frame_id, 2);
    out.Put(column.encoder_ticks, 4);
    for (int row = 0; row < column.beams; ++row) {
      out.Put(column.range_mm[row] | uint32_t{column.flags[row]} << 28, 4);
      out.Put(column.reflectivity[row], 2);
      out.Put(column.signal[row], 2);
      out.Put(column.near_ir[row], 2);
      out.Put(0xa5a5, 2);  // reserved
    }
    out.Put(column.status, 4);
  }
  return out.bytes();
}

inline std::vector<uint8_t> EncodeRng19(const PacketIdentity& identity,
                                        const std::vector<LidarColumn>& columns) {
  ByteWriter out;
  out.Put(identity.packet_type, 2);
  out.Put(identity.frame_id, 2);
  out.Put(identity.init_id, 3);
  out.Put(identity.serial_number, 5);
  for (int i = 0; i < 20; ++i) out.Put(0xc3, 1);  // alerts, limits: not ours
  for (const LidarColumn& column : columns) {
    out.Put(column.timestamp_ns, 8);
    out.Put(column.measurement_id, 2);
    out.Put(column.status, 2);
    for (int row = 0; row < column.beams; ++row) {
      out.Put(column.range_mm[row] | uint32_t{column.flags[row]} << 19, 4);
      out.Put(column.reflectivity[row], 1);
      out.Put(0x5a, 1);  // reserved
      out.Put(column.signal[row], 2);
      out.Put(column.near_ir[row], 2);
      out.Put(0xa5a5, 2);  // reserved
    }
  }
  for (int i = 0; i < 32; ++i) out.Put(0x3c, 1);
  return out.bytes();
}

// Columns with every field random within its width in the profile; all valid.
inline std::vector<LidarColumn> RandomColumns(std::mt19937& random, Profile profile, int beams,
                                              int columns, uint16_t frame_id, int first_id) {
  const bool legacy = profile == Profile::kLegacy;
  std::vector<LidarColumn> made(static_cast<size_t>(columns));
  for (int i = 0; i < columns; ++i) {
    LidarColumn& column = made[static_cast<size_t>(i)];
    const auto word = [&random] { return static_cast<uint32_t>(random()); };
    column.timestamp_ns = uint64_t{random()} << 32 | random();
    column.measurement_id = static_cast<uint16_t>(first_id + i);
    column.frame_id = frame_id;
    column.encoder_ticks = legacy ? word() : 0;
    column.status = legacy ? 0xffffffffu : (word() & 0xffffu) | 1u;
    column.valid = true;
    column.beams = beams;
    for (int row = 0; row < beams; ++row) {
      column.range_mm[row] = word() & (legacy ? 0xfffffu : 0x7ffffu);
      column.flags[row] = static_cast<uint8_t>(random() & (legacy ? 0xfu : 0x1fu));
      column.reflectivity[row] = static_cast<uint16_t>(random() & (legacy ? 0xffffu : 0xffu));
      column.signal[row] = static_cast<uint16_t>(random());
      column.near_ir[row] = static_cast<uint16_t>(random());
    }
  }
  return made;
}

}  // namespace hardpack::ouster::test
