// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// One message of a VectorNav inertial navigation system (VN-300 and its relatives) to an InsSample.
// Layouts as documented by the maker (REFERENCES.md). Keeps no state and does not look for messages
// in a stream (hal/vectornav/stream_parser.h does).
//
// Binary output: 0xFA; a byte that selects groups; for each selected group, lowest bit first, a u16
// that selects its fields; the fields, lowest bit of the lowest group first; CRC-16. Numbers are
// little-endian, the CRC is sent high byte first and covers everything between 0xFA and itself.
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
// All other fields are stepped over by their sizes. A message that selects a field whose size is
// not documented or varies (satellites, raw measurements), a further group byte or a further field
// word (their extension bits) is kUnsupported. Of a quantity that occurs twice, the last counts.
//
// ASCII output: $VNINS, 15 fields and a checksum over what stands between $ and *; either two hex
// digits, the exclusive or of the characters, or four, their CRC-16 (in capitals, as the sensor
// writes them):
//
//   $VNINS,time of week [s],week,status (hex),yaw,pitch,roll [deg],latitude,longitude [deg],
//          altitude [m],velocity north,east,down [m/s],attitude [deg],position [m] and
//          velocity [m/s] uncertainty*XX, carriage return, line feed
//
// In both:
//   time      GPS time of less than a week is not GPS time: the sensor counts from its start until
//             it knows the week. It is left out.
//   angles    within 360 degrees either way, pitch within 90; become radians, yaw and roll wrapped.
//   position  must lie on the globe: latitude within 90, longitude within 180 degrees.
//   status    does not decide what is told: before its first fix the sensor sends a position of
//             zeros, and whether a value is to be believed is for odometry to say.

namespace hardpack::vectornav {

inline constexpr uint8_t kBinarySync = 0xFA;
inline constexpr uint8_t kAsciiStart = '$';

// With every documented field of every group.
inline constexpr size_t kMaxBinaryBytes = 1175;
// What is taken for a line at all, with its end; $VNINS has about 135.
inline constexpr size_t kMaxAsciiBytes = 256;

// The size of the binary message that `bytes` begin with, its sync byte and CRC included: at most
// kMaxBinaryBytes. kTruncated: its header is not whole yet; kUnsupported: not the beginning of a
// message that is known; then `message_bytes` is untouched. Cost: a look at each of the 105 fields.
Status BinaryMessageSize(std::span<const uint8_t> bytes, size_t& message_bytes);

// Decodes a binary message, given whole and alone. kTruncated, kOversized: not exactly of the size
// that its header asks for; kUnsupported; kBadCrc; kNotFinite: one of the used numbers is not;
// kInvalidArgument: an angle, a position or an uncertainty out of its range; kWrongPacketType:
// nothing in it is used. On failure `sample` is untouched. Cost: one pass over the bytes.
Status DecodeBinary(std::span<const uint8_t> message, InsSample& sample);

// The same of a message whose size and CRC are known to be right. Cost: a look at each of the 105
// fields.
Status DecodeCheckedBinary(std::span<const uint8_t> message, InsSample& sample);

// The size of the line that `bytes` begin with: from $ to the line feed, with a * and two or four
// hex digits before its end, and else printable characters but $ and *. kTruncated: its end is not
// there yet; kWrongPacketType: not the beginning of such a line, or one longer than
// kMaxAsciiBytes; then `message_bytes` is untouched. Cost: one pass, at most kMaxAsciiBytes.
Status AsciiMessageSize(std::span<const uint8_t> bytes, size_t& message_bytes);

// Decodes a $VNINS line, given whole and alone. kTruncated, kOversized: not exactly one line;
// kBadCrc; kWrongPacketType: another line, or none; kInvalidArgument: a field that is not written
// as a number (at most nine digits before the point and nine behind), out of its range, or too many
// or too few of them. On failure `sample` is untouched. Cost: three passes, at most
// kMaxAsciiBytes each.
Status DecodeAscii(std::span<const uint8_t> message, InsSample& sample);

}  // namespace hardpack::vectornav
