// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Converts one message of a VectorNav inertial navigation system (VN-300 and related models) to an
// InsSample. Layouts as documented by the manufacturer (REFERENCES.md). Keeps no state and does not
// search a stream for messages (hal/vectornav/stream_parser.h does).
//
// Binary output: 0xFA; a byte that selects groups; for each selected group, lowest bit first, a u16
// that selects its fields; the fields, lowest bit of the lowest group first; CRC-16. Numbers are
// little-endian; the CRC is sent high byte first and covers everything between 0xFA and itself.
//
//   bit  group     used of it
//   0    Common    TimeStartup, TimeGps, YawPitchRoll, AngularRate, PosLla, VelNed, Accel,
//                  InsStatus
//   1    Time      TimeStartup, TimeGps
//   2    IMU       Accel, AngularRate
//   3    GPS       nothing: what one receiver alone says is not the solution
//   4    Attitude  YawPitchRoll
//   5    INS       InsStatus, PosLla, VelNed, PosU, VelU
//   6    GPS2      nothing
//
// All other fields are skipped by their sizes. A message that selects a field whose size is
// undocumented or varies (satellites, raw measurements), a further group byte or a further field
// word (their extension bits) is kUnsupported. If a quantity occurs twice, the last one counts.
//
// ASCII output: $VNINS, 15 fields and a checksum over the characters between $ and *; either two
// hex digits, the exclusive or of the characters, or four, their CRC-16 (in capitals, as the sensor
// writes them):
//
//   $VNINS,time of week [s],week,status (hex),yaw,pitch,roll [deg],latitude,longitude [deg],
//          altitude [m],velocity north,east,down [m/s],attitude [deg],position [m] and
//          velocity [m/s] uncertainty*XX, carriage return, line feed
//
// In both:
//   time      GPS time of less than a week is not GPS time: the sensor counts from its start until
//             it knows the week. It is omitted.
//   angles    within 360 degrees either way, pitch within 90; converted to radians, yaw and roll
//             wrapped.
//   position  must be on the globe: latitude within 90, longitude within 180 degrees.
//   status    does not affect what is returned: before its first fix the sensor sends a position of
//             zeros, and odometry decides whether a value is to be believed.

namespace hardpack::vectornav {

inline constexpr uint8_t kBinarySync = 0xFA;
inline constexpr uint8_t kAsciiStart = '$';

// With every documented field of every group.
inline constexpr size_t kMaxBinaryBytes = 1175;
// Longest accepted line, including its end; $VNINS has about 135.
inline constexpr size_t kMaxAsciiBytes = 256;

// The size of the binary message at the beginning of `bytes`, including its sync byte and CRC: at
// most kMaxBinaryBytes. kTruncated: its header is incomplete; kUnsupported: not the beginning of a
// known message; then `message_bytes` is unchanged. Cost: a look at each of the 105 fields.
Status BinaryMessageSize(std::span<const uint8_t> bytes, size_t& message_bytes);

// Decodes exactly one complete binary message. kTruncated, kOversized: not exactly the size that
// its header requires; kUnsupported; kBadCrc; kNotFinite: one of the used numbers is not;
// kInvalidArgument: an angle, a position or an uncertainty out of range; kWrongPacketType: nothing
// in it is used. On failure `sample` is unchanged. Cost: one pass over the bytes.
Status DecodeBinary(std::span<const uint8_t> message, InsSample& sample);

// The same for a message whose size and CRC are known to be right. Cost: a look at each of the 105
// fields.
Status DecodeCheckedBinary(std::span<const uint8_t> message, InsSample& sample);

// The size of the line at the beginning of `bytes`: from $ to the line feed, with a * and two or
// four hex digits before its end, and otherwise printable characters except $ and *. kTruncated:
// its end is missing; kWrongPacketType: not the beginning of such a line, or one longer than
// kMaxAsciiBytes; then `message_bytes` is unchanged. Cost: one pass, at most kMaxAsciiBytes.
Status AsciiMessageSize(std::span<const uint8_t> bytes, size_t& message_bytes);

// Decodes exactly one complete $VNINS line. kTruncated, kOversized: not exactly one line; kBadCrc;
// kWrongPacketType: another line, or none; kInvalidArgument: a field that is not written as a
// number (at most nine digits before the point and nine after), is out of range, or too many or too
// few fields. On failure `sample` is unchanged. Cost: three passes, at most kMaxAsciiBytes each.
Status DecodeAscii(std::span<const uint8_t> message, InsSample& sample);

}  // namespace hardpack::vectornav
