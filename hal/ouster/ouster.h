// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Ouster lidar packets to LidarColumns and IMU packets to ImuSamples. Layouts as documented by the
// manufacturer (REFERENCES.md). Decodes one column at a time into the caller's LidarColumn; keeps
// no state (packet_monitor.h follows a sensor's stream), allocates nothing, knows nothing of
// revolutions.
//
//                               header  column header  pixel  column footer  footer  [B]
//   LEGACY                           0             16     12              4       0
//   RNG19_RFL8_SIG16_NIR16          32             12     12              0      32
//   RNG15_RFL8_NIR8                 32             12      4              0      32
//   RNG19_RFL8_SIG16_NIR16_DUAL     32             12     16              0      32
//
// Conversion of a pixel into a LidarColumn:
//   range         LEGACY 20 bits, RNG19 19 bits of 1 mm; RNG15 15 bits of 8 mm: a multiple of 8 mm,
//                 at most 262,136 mm. 0: no return.
//   flags         LEGACY 4 bits, RNG19 5 bits, RNG15 1 bit.
//   reflectivity  LEGACY 16 bits, otherwise 8.
//   signal        photons, 16 bits; RNG15 sends none: 0.
//   near_ir       photons, 16 bits; RNG15 sends 8 bits of 16 photons: a multiple of 16.
//   second_*      DUAL only: the second return of the beam (returns is 2). All others leave them
//                 unchanged and set returns to 1.

namespace hardpack::ouster {

enum class Profile : uint8_t {
  kLegacy = 0,
  kRng19Rfl8Sig16Nir16 = 1,
  kRng15Rfl8Nir8 = 2,
  kRng19Rfl8Sig16Nir16Dual = 3,
};

// As in v2.3.0. Pre-releases count as their release.
struct FirmwareVersion {
  int32_t first = 0;
  int32_t second = 0;
  int32_t third = 0;
};

// The sensor's metadata, as needed for decoding and geometry. Filled in by the port
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
  FirmwareVersion firmware;        // all 0: not stated
  // The firmware fills in the CRC-64 of the packet's footer. If it does not, or is not known to,
  // the eight bytes are meaningless.
  bool crc_in_footer = false;
  float beam_altitude_deg[kMaxBeams] = {};
  float beam_azimuth_deg[kMaxBeams] = {};
  float lidar_origin_to_beam_origin_m = 0.0f;
  Transform3 sensor_from_lidar;  // [m]
  char product_line[24] = {};    // zero-terminated
};

// Sizes and offsets of one profile at a number of beams.
struct PacketLayout {
  Profile profile = Profile::kLegacy;
  bool crc_in_footer = false;  // packets are checked with it
  int32_t beams = 0;
  int32_t columns_per_packet = 0;
  int32_t columns_per_frame = 0;
  int32_t packet_header_bytes = 0;
  int32_t column_header_bytes = 0;
  int32_t pixel_bytes = 0;
  int32_t column_footer_bytes = 0;
  int32_t packet_footer_bytes = 0;
  int32_t column_bytes = 0;
  int32_t packet_bytes = 0;
};

// The largest packet, for buffers and loop bounds: 16 columns of 128 DUAL beams are 33,024 B.
inline constexpr int32_t kMaxPacketBytes = 33280;
inline constexpr size_t kFrameIdOffset = 2;  // in the header of a packet, but for the legacy one
inline constexpr int32_t kMaxColumnsPerPacket = 64;

// kUnsupported: an unknown profile; kInvalidArgument: a count out of range; kCapacityExceeded: more
// columns per frame than kMaxColumnsPerRevolution, or packets beyond kMaxPacketBytes. On failure
// the layout is empty, and the functions below refuse it with kInvalidArgument.
Status MakeLayout(const Metadata& metadata, PacketLayout& layout);

// Content of a packet's header. LEGACY has none: everything 0.
struct PacketHeader {
  uint16_t packet_type = 0;
  uint16_t frame_id = 0;
  uint32_t init_id = 0;
  uint64_t serial_number = 0;
};

// Which sensor, and which start of it: the init id changes with each boot and each new
// configuration. 0: unknown, any will do.
struct SensorIdentity {
  uint32_t init_id = 0;
  uint64_t serial_number = 0;
};

// Checks a datagram as a whole before any column is taken from it, and reads its header. In this
// order, so that nothing in a damaged packet is believed: kTruncated / kOversized: not exactly
// layout.packet_bytes; kWrongPacketType: header type is not a lidar packet; kBadCrc:
// layout.crc_in_footer, and the CRC-64 differs; kWrongSensor: a serial number other than the
// expected one; kSensorRestarted: the serial number is the expected one or none is expected, but
// the init id differs from the expected one: the metadata may be out of date. A LEGACY packet
// carries no identity: only its size can be checked. Cost: constant; with a CRC one pass over the
// packet in steps of 8 bytes.
Status CheckPacket(const PacketLayout& layout, const SensorIdentity& expected,
                   std::span<const uint8_t> packet, PacketHeader& header);

// The same, expecting the sensor that the metadata describe.
Status CheckPacket(const PacketLayout& layout, const Metadata& metadata,
                   std::span<const uint8_t> packet, PacketHeader& header);

// Decodes column `index` (0 .. columns_per_packet - 1) of a packet that passed CheckPacket.
// kColumnInvalid: marked by the sensor, as outside its window; kBadColumn: measurement id beyond
// the frame (both: the fields are still decoded); kTruncated; kInvalidArgument: no such index
// (both: `column` is unchanged). Rows beyond layout.beams are unchanged. Cost: one pass over the
// beams, at most kMaxBeams.
Status DecodeColumn(const PacketLayout& layout, std::span<const uint8_t> packet, int index,
                    LidarColumn& column);

inline constexpr int32_t kImuPacketBytes = 48;

// Decodes an IMU packet (udp_profile_imu LEGACY) into SI units, in the IMU's own frame: g and deg/s
// on the wire. The packet names no sensor and has no checksum. kTruncated / kOversized: not exactly
// kImuPacketBytes; kNotFinite: a reading is not, or no longer is in SI units; on failure `sample`
// is unchanged. Cost: constant.
Status DecodeImu(std::span<const uint8_t> packet, ImuSample& sample);

}  // namespace hardpack::ouster
