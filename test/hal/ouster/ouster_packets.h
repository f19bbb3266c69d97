// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
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
  // Floats by their bits.
  void PutFloat(float value) { Put(std::bit_cast<uint32_t>(value), 4); }
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

inline void PutHeader(const PacketIdentity& identity, ByteWriter& out) {
  out.Put(identity.packet_type, 2);
  out.Put(identity.frame_id, 2);
  out.Put(identity.init_id, 3);
  out.Put(identity.serial_number, 5);
  for (int i = 0; i < 20; ++i) out.Put(0xc3, 1);  // alerts, limits: not ours
}

inline void PutColumnHeader(const LidarColumn& column, ByteWriter& out) {
  out.Put(column.timestamp_ns, 8);
  out.Put(column.measurement_id, 2);
  out.Put(column.status, 2);
}

inline std::vector<uint8_t> EncodeRng19(const PacketIdentity& identity,
                                        const std::vector<LidarColumn>& columns) {
  ByteWriter out;
  PutHeader(identity, out);
  for (const LidarColumn& column : columns) {
    PutColumnHeader(column, out);
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

// Ranges are to be multiples of 8 mm and near-IR of 16.
inline std::vector<uint8_t> EncodeRng15(const PacketIdentity& identity,
                                        const std::vector<LidarColumn>& columns) {
  ByteWriter out;
  PutHeader(identity, out);
  for (const LidarColumn& column : columns) {
    PutColumnHeader(column, out);
    for (int row = 0; row < column.beams; ++row) {
      out.Put(column.range_mm[row] / 8 | uint32_t{column.flags[row]} << 15, 2);
      out.Put(column.reflectivity[row], 1);
      out.Put(column.near_ir[row] / 16u, 1);
    }
  }
  for (int i = 0; i < 32; ++i) out.Put(0x3c, 1);
  return out.bytes();
}

inline std::vector<uint8_t> EncodeDual(const PacketIdentity& identity,
                                       const std::vector<LidarColumn>& columns) {
  ByteWriter out;
  PutHeader(identity, out);
  for (const LidarColumn& column : columns) {
    PutColumnHeader(column, out);
    for (int row = 0; row < column.beams; ++row) {
      out.Put(column.range_mm[row] | uint32_t{column.flags[row]} << 19, 3);
      out.Put(column.reflectivity[row], 1);
      out.Put(column.second_range_mm[row] | uint32_t{column.second_flags[row]} << 19, 3);
      out.Put(column.second_reflectivity[row], 1);
      out.Put(column.signal[row], 2);
      out.Put(column.second_signal[row], 2);
      out.Put(column.near_ir[row], 2);
      out.Put(0xa5a5, 2);  // reserved
    }
  }
  for (int i = 0; i < 32; ++i) out.Put(0x3c, 1);
  return out.bytes();
}

inline std::vector<uint8_t> Encode(Profile profile, const PacketIdentity& identity,
                                   const std::vector<LidarColumn>& columns) {
  switch (profile) {
    case Profile::kLegacy:
      return EncodeLegacy(columns);
    case Profile::kRng19Rfl8Sig16Nir16:
      return EncodeRng19(identity, columns);
    case Profile::kRng15Rfl8Nir8:
      return EncodeRng15(identity, columns);
    case Profile::kRng19Rfl8Sig16Nir16Dual:
      return EncodeDual(identity, columns);
  }
  return {};
}

// Bit by bit, from the definition of the checksum.
inline uint64_t SlowCrc64(const uint8_t* bytes, size_t size) {
  uint64_t crc = ~uint64_t{0};
  for (size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      const bool one = (crc & 1u) != 0;
      crc >>= 1;
      if (one) crc ^= 0xC96C5795D7870F42u;
    }
  }
  return ~crc;
}

// Puts the CRC of everything before them into the last eight bytes.
inline void SetCrc(std::vector<uint8_t>& packet) {
  const size_t covered = packet.size() - 8;
  const uint64_t crc = SlowCrc64(packet.data(), covered);
  for (size_t i = 0; i < 8; ++i) packet[covered + i] = static_cast<uint8_t>(crc >> (8 * i));
}

// How much of each field a profile carries.
struct FieldLimits {
  uint32_t range_mask;
  uint32_t range_unit_mm;
  uint32_t flags_mask;
  uint32_t reflectivity_mask;
  uint32_t signal_mask;
  uint32_t near_ir_mask;
  uint32_t near_ir_unit;
  int returns;
};

inline FieldLimits LimitsOf(Profile profile) {
  switch (profile) {
    case Profile::kLegacy:
      return {0xfffff, 1, 0xf, 0xffff, 0xffff, 0xffff, 1, 1};
    case Profile::kRng15Rfl8Nir8:
      return {0x7fff, 8, 1, 0xff, 0, 0xff, 16, 1};
    case Profile::kRng19Rfl8Sig16Nir16Dual:
      return {0x7ffff, 1, 0x1f, 0xff, 0xffff, 0xffff, 1, 2};
    default:
      return {0x7ffff, 1, 0x1f, 0xff, 0xffff, 0xffff, 1, 1};
  }
}

// Columns with every field random within what the profile carries; all valid.
inline std::vector<LidarColumn> RandomColumns(std::mt19937& random, Profile profile, int beams,
                                              int columns, uint16_t frame_id, int first_id) {
  const bool legacy = profile == Profile::kLegacy;
  const FieldLimits limits = LimitsOf(profile);
  std::vector<LidarColumn> made(static_cast<size_t>(columns));
  for (int i = 0; i < columns; ++i) {
    LidarColumn& column = made[static_cast<size_t>(i)];
    const auto word = [&random](uint32_t mask) { return static_cast<uint32_t>(random()) & mask; };
    const auto half = [&word](uint32_t mask) { return static_cast<uint16_t>(word(mask)); };
    column.timestamp_ns = uint64_t{random()} << 32 | random();
    column.measurement_id = static_cast<uint16_t>(first_id + i);
    column.frame_id = frame_id;
    column.encoder_ticks = legacy ? word(0xffffffffu) : 0;
    column.status = legacy ? 0xffffffffu : word(0xffff) | 1u;
    column.valid = true;
    column.beams = beams;
    column.returns = limits.returns;
    for (int row = 0; row < beams; ++row) {
      column.range_mm[row] = word(limits.range_mask) * limits.range_unit_mm;
      column.flags[row] = static_cast<uint8_t>(word(limits.flags_mask));
      column.reflectivity[row] = half(limits.reflectivity_mask);
      column.signal[row] = half(limits.signal_mask);
      column.near_ir[row] = static_cast<uint16_t>(word(limits.near_ir_mask) * limits.near_ir_unit);
      if (limits.returns < 2) continue;
      column.second_range_mm[row] = word(limits.range_mask);
      column.second_flags[row] = static_cast<uint8_t>(word(limits.flags_mask));
      column.second_reflectivity[row] = half(limits.reflectivity_mask);
      column.second_signal[row] = half(limits.signal_mask);
    }
  }
  return made;
}

}  // namespace hardpack::ouster::test
