// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Decodes data packets of the Velodyne VLP-16 (Puck, Puck LITE) and VLP-32C (Ultra Puck) into the
// returns of LidarColumns. Formats and timing as documented by the manufacturer (REFERENCES.md).
// Keeps no state (lidar.h follows a sensor's stream), allocates nothing.
//
// A packet is 1206 bytes: 12 blocks of 100, a stamp, and two bytes that say how to read it.
//
//   block  0  flag FF EE
//          2  azimuth [0.01 degree], 0 .. 35999, clockwise seen from above, of its first laser
//          4  32 returns of 3 bytes: distance (2 mm on the VLP-16, 4 mm on the VLP-32C; 0: none),
//             reflectivity
//   1200  microseconds past the hour, of the packet's first laser
//   1204  return mode: 37 strongest, 38 last, 39 dual
//   1205  product: 22 VLP-16 and Puck LITE, 28 VLP-32C
//
// All numbers are little-endian. A firing is all lasers once: 16 slots of 2.304 us and a pause,
// 55.296 us in all. On the VLP-16 one laser fires per slot and a block holds two firings; on the
// VLP-32C two fire together and a block holds one. In dual mode the blocks come in pairs with the
// same azimuth: first the last return, then the strongest (or the second strongest, if the last is
// the strongest). If there was only one return, both are the same.

namespace hardpack::velodyne {

enum class Model : uint8_t { kVlp16 = 0, kVlp32c = 1 };
// As on the wire.
enum class ReturnMode : uint8_t { kStrongest = 0x37, kLast = 0x38, kDual = 0x39 };

// How the sensor is configured; a sensor with any other configuration is refused. Its field of view
// must be the full circle.
struct Config {
  Model model = Model::kVlp16;
  ReturnMode return_mode = ReturnMode::kStrongest;
  int32_t rpm = 600;  // a multiple of 60, kLeastRpm .. kMostRpm
};
inline constexpr int32_t kRpmStep = 60;
// The sensor turns at 300 to 1200; below this rate it fires more often than a revolution may have
// columns.
inline constexpr int32_t kLeastRpm = 540;
inline constexpr int32_t kMostRpm = 1200;

inline constexpr int32_t kPacket_bytes = 1206;
inline constexpr int32_t kBlocks = 12;
inline constexpr int32_t kMostBeams = 32;
inline constexpr int32_t kMaxFirings = 24;  // per packet
inline constexpr int32_t kFiring_ns = 55'296;
inline constexpr int32_t kSlot_ns = 2'304;
// From the first of the sixteen slots to their middle, to which a firing's time and angle refer.
inline constexpr int32_t kMiddle_ns = 15 * kSlot_ns / 2;
inline constexpr int32_t kTurn_cdeg = 36'000;
inline constexpr uint32_t kHour_us = 3'600'000'000u;

// kUnsupported: no such model or return mode; kInvalidArgument: rpm.
Status CheckConfig(const Config& config);

// How the packets of a sensor are laid out. Precondition: CheckConfig.
struct Format {
  int32_t beams = 0;
  int32_t firings_per_block = 0;
  int32_t blocks_per_firing = 0;  // 2 in dual mode
  int32_t firings = 0;            // per packet
  int32_t unit_mm = 0;            // of a distance
  uint8_t product = 0;
};
Format FormatOf(const Config& config);

// How far the head turns from one firing to the next [0.01 degree], as configured.
float TurnOfFiring_cdeg(const Config& config);

// The contents of a packet besides its returns.
struct PacketHeader {
  uint32_t time_us = 0;  // past the hour, below kHour_us
  // One for blocks that belong together: kBlocks / blocks_per_firing, each below kTurn_cdeg.
  uint16_t azimuth_cdeg[kBlocks] = {};
};

// Checks a datagram as a whole, in this order, and reads its header: kTruncated, kOversized: not
// kPacket_bytes; kWrongPacketType: a block without its flag (position packets are shorter, and have
// none); kWrongSensor: another product, or firmware that does not say which; kUnsupported: a return
// mode other than the configured one; kBadColumn: an azimuth of 360 degrees or more, or different
// ones in a pair; kInvalidArgument: a stamp of an hour or more; kDeviceFault: the head does not
// turn as configured, by more than a twenty-fifth over the packet (and 0.03 degree of rounding) or
// by half of it from block to block. On failure the header is meaningless. Precondition:
// CheckConfig. Cost: the blocks.
Status ReadHeader(const Config& config, std::span<const uint8_t> packet, PacketHeader& header);

// Turn from one azimuth to another [0.01 degree], less than a revolution.
constexpr int32_t TurnedBetween_cdeg(int32_t from_cdeg, int32_t to_cdeg) {
  return to_cdeg >= from_cdeg ? to_cdeg - from_cdeg : to_cdeg - from_cdeg + kTurn_cdeg;
}

// Fills in the returns of one firing, in the order of the sensor's lasers. Signal, near infrared
// and flags are not available: 0. In dual mode the first return is the strongest and the second the
// last, 0 if it is the same. Preconditions: ReadHeader was kOk for this packet, 0 <= firing <
// format.firings. Cost: the beams.
void DecodeReturns(const Format& format, std::span<const uint8_t, kPacket_bytes> packet, int firing,
                   LidarColumn& column);

}  // namespace hardpack::velodyne
