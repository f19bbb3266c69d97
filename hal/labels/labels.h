// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The datagrams of an external segmentation computer: one byte per return, in the lidar's order of
// measurement (docs/label_datagram.md). Decodes and encodes; keeps no state. core/segmentation
// defines the meaning of a code, and core/scan decides whether its column can still take it. A
// datagram names the lidar's frame, its first column and the number of columns and beams, and ends
// with a checksum.

namespace hardpack::labels {

inline constexpr uint32_t kMagic = 0x424c5048u;  // "HPLB" as little-endian bytes
inline constexpr uint8_t kVersion = 1;
inline constexpr int kHeaderBytes = 24;
inline constexpr int kFooterBytes = 4;  // CRC-32 over everything before it
inline constexpr int kMaxColumns = 64;  // in one datagram
inline constexpr int kMaxDatagramBytes = kHeaderBytes + kMaxColumns * kMaxBeams + kFooterBytes;

// All numbers little-endian; offsets in bytes.
struct Header {
  uint8_t version = 0;             // @4
  uint8_t beams = 0;               // @5   1 .. kMaxBeams
  uint16_t frame_id = 0;           // @6   of the lidar, as it sent it
  uint16_t first_measurement = 0;  // @8   measurement id of the first column
  uint16_t columns = 0;            // @10  1 .. kMaxColumns; ids count on from the first, wrapping
                                   //      at no point: a datagram stays within one revolution
  uint32_t sequence = 0;           // @12  of the sender's datagrams, counts up by one, wraps
  uint64_t timestamp_ns = 0;       // @16  the lidar's stamp of the first column
};
static_assert(std::is_trivially_copyable_v<Header>);

// Checks a datagram as a whole and reads its header; if several things are wrong, returns the first
// in this list. kTruncated: fewer bytes than a header and a footer (`header` is then invalid);
// kWrongPacketType: another magic number; kUnsupported: another version; kInvalidArgument: no
// columns or beams, or too many; kTruncated, kOversized: not exactly the size that its header
// requires; kBadCrc; kWrongSensor: its beams are not the sensor's; kBadColumn: its columns reach
// beyond columns_per_revolution. On every other failure `header` holds the bytes' values. Cost: one
// pass over the bytes, at most kMaxDatagramBytes.
Status CheckDatagram(std::span<const uint8_t> datagram, int beams, int columns_per_revolution,
                     Header& header);

// Column `index` (0 .. header.columns - 1) of a datagram that passed CheckDatagram: its
// identification, and a code for each of its beams; codes beyond that are unchanged.
// kInvalidArgument: no such index, or an invalid header; kTruncated: the datagram does not have the
// header's size. Then `column` is unchanged. Cost: one pass over the beams.
Status DecodeColumn(const Header& header, std::span<const uint8_t> datagram, int index,
                    ColumnLabels& column);

// Writes a datagram (for the segmentation computer, the simulator and the tests) and sets
// `size_bytes`; its version is always kVersion. codes: [columns x beams], column by column.
// kInvalidArgument: counts out of range, columns beyond kMaxColumnsPerRevolution, or codes of
// another size; kCapacityExceeded: `datagram` is too small. Then nothing is written, and
// `size_bytes` is 0. Cost: as above.
Status Encode(const Header& header, std::span<const uint8_t> codes, std::span<uint8_t> datagram,
              int& size_bytes);

}  // namespace hardpack::labels
