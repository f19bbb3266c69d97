// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Ouster lidar packets to LidarColumns. Layouts as documented by the maker (REFERENCES.md): LEGACY
// (no packet header) and RNG19_RFL8_SIG16_NIR16 (32 B header, 32 B footer). Decodes one column at a
// time into the caller's LidarColumn; keeps no state, allocates nothing. Does not check the CRC of
// the footer: it is wrong or absent on the firmware these two profiles were recorded with.

namespace hardpack::ouster {

enum class Profile : uint8_t {
  kLegacy = 0,
  kRng19Rfl8Sig16Nir16 = 1,
  kRng15Rfl8Nir8 = 2,            // known by name; decoding it is kUnsupported
  kRng19Rfl8Sig16Nir16Dual = 3,  // known by name; decoding it is kUnsupported
};

// What the sensor's metadata say, as far as decoding and geometry need it. Filled by the port
// (ouster_metadata.h) from the sensor's JSON.
struct Metadata {
  Profile profile = Profile::kLegacy;
  int32_t beams = 0;               // pixels_per_column: 16, 32, 64 or 128
  int32_t columns_per_frame = 0;   // 512, 1024, 2048 (or 4096, which no ring here holds)
  int32_t columns_per_packet = 0;  // 1 .. 64
  int32_t column_window_first = 0;
  int32_t column_window_last = 0;  // inclusive; first > last wraps past zero
  uint32_t init_id = 0;            // 0: not stated
  uint64_t serial_number = 0;      // 0: not stated
  float beam_altitude_deg[kMaxBeams] = {};
  float beam_azimuth_deg[kMaxBeams] = {};
  float lidar_origin_to_beam_origin_m = 0.0f;
  Transform3 sensor_from_lidar;  // [m]
  char product_line[24] = {};    // zero-terminated
};

// Sizes and offsets of one profile at a number of beams.
struct PacketLayout {
  Profile profile = Profile::kLegacy;
  int32_t beams = 0;
  int32_t columns_per_packet = 0;
  int32_t columns_per_frame = 0;
  int32_t packet_header_bytes = 0;
  int32_t column_header_bytes = 0;
  int32_t pixel_bytes = 0;
  int32_t column_footer_bytes = 0;
  int32_t column_bytes = 0;
  int32_t packet_bytes = 0;
};

// kUnsupported: a profile that is not decoded; kInvalidArgument: a count out of range;
// kCapacityExceeded: more columns a frame than kMaxColumnsPerRevolution. On failure the layout is
// empty, and the functions below refuse it with kInvalidArgument.
Status MakeLayout(const Metadata& metadata, PacketLayout& layout);

// What a packet's header says. LEGACY has none: everything 0.
struct PacketHeader {
  uint16_t packet_type = 0;
  uint16_t frame_id = 0;
  uint32_t init_id = 0;
  uint64_t serial_number = 0;
};

// Checks a datagram as a whole before any column is taken from it, and reads its header.
// kTruncated / kOversized: not exactly layout.packet_bytes; kWrongPacketType: header type is not a
// lidar packet; kWrongSensor: the metadata state an init id or a serial number and the packet
// another. A LEGACY packet carries no identity: its size is all that can be checked.
Status CheckPacket(const PacketLayout& layout, const Metadata& metadata,
                   std::span<const uint8_t> packet, PacketHeader& header);

// Decodes column `index` (0 .. columns_per_packet - 1) of a packet that passed CheckPacket.
// kColumnInvalid: the sensor marked it so; kBadColumn: measurement id beyond the frame (both: the
// fields are decoded all the same); kTruncated; kInvalidArgument: no such index (both: `column` is
// untouched). Rows beyond layout.beams are untouched.
// Cost: one pass over the beams, at most kMaxBeams.
Status DecodeColumn(const PacketLayout& layout, std::span<const uint8_t> packet, int index,
                    LidarColumn& column);

}  // namespace hardpack::ouster
