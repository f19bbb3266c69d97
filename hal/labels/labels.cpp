// SPDX-License-Identifier: Apache-2.0
#include "hal/labels/labels.h"

#include <cstddef>

#include "core/base/assert.h"
#include "core/base/byte_reader.h"
#include "core/base/crc32.h"
#include "core/base/loop_bound.h"

namespace hardpack::labels {
namespace {

constexpr size_t kMagicOffset = 0;
constexpr size_t kVersionOffset = 4;
constexpr size_t kBeamsOffset = 5;
constexpr size_t kFrameIdOffset = 6;
constexpr size_t kFirstMeasurementOffset = 8;
constexpr size_t kColumnsOffset = 10;
constexpr size_t kSequenceOffset = 12;
constexpr size_t kTimestampOffset = 16;
constexpr size_t kLeastBytes = kHeaderBytes + kFooterBytes;

bool CountsInRange(const Header& header) {
  return header.beams >= 1 && header.beams <= kMaxBeams && header.columns >= 1 &&
         header.columns <= kMaxColumns;
}

uint32_t CrcOf(std::span<const uint8_t> bytes) {
  return Crc32<kMaxDatagramBytes>(bytes);
}

// Precondition: CountsInRange.
size_t CodeBytes(const Header& header) {
  return static_cast<size_t>(header.beams) * header.columns;
}

// `value`'s lowest `size` bytes, lowest first. Precondition: they fit.
void Write(std::span<uint8_t> bytes, size_t offset, size_t size, uint64_t value) {
  HP_LOOP_BOUND(8)
  for (size_t i = 0; i < size; ++i) {
    bytes[offset + i] = static_cast<uint8_t>(value >> (8 * i) & 0xffu);
  }
}

}  // namespace

Status CheckDatagram(std::span<const uint8_t> datagram, int beams, int columns_per_revolution,
                     Header& header) {
  header = Header{};
  if (datagram.size() < kLeastBytes) return Status::kTruncated;
  ByteReader reader(datagram);
  header.version = reader.U8(kVersionOffset);
  header.beams = reader.U8(kBeamsOffset);
  header.frame_id = reader.U16(kFrameIdOffset);
  header.first_measurement = reader.U16(kFirstMeasurementOffset);
  header.columns = reader.U16(kColumnsOffset);
  header.sequence = reader.U32(kSequenceOffset);
  header.timestamp_ns = reader.U64(kTimestampOffset);
  if (reader.U32(kMagicOffset) != kMagic) return Status::kWrongPacketType;
  if (header.version != kVersion) return Status::kUnsupported;
  if (!CountsInRange(header)) return Status::kInvalidArgument;

  const size_t checked_bytes = kHeaderBytes + CodeBytes(header);
  if (datagram.size() < checked_bytes + kFooterBytes) return Status::kTruncated;
  if (datagram.size() > checked_bytes + kFooterBytes) return Status::kOversized;
  if (CrcOf(datagram.first(checked_bytes)) != reader.U32(checked_bytes)) return Status::kBadCrc;
  if (header.beams != beams) return Status::kWrongSensor;
  return header.first_measurement + header.columns <= columns_per_revolution ? Status::kOk
                                                                             : Status::kBadColumn;
}

Status DecodeColumn(const Header& header, std::span<const uint8_t> datagram, int index,
                    ColumnLabels& column) {
  if (!CountsInRange(header) || index < 0 || index >= header.columns ||
      header.first_measurement + index > UINT16_MAX) {
    return Status::kInvalidArgument;
  }
  if (datagram.size() != kLeastBytes + CodeBytes(header)) return Status::kTruncated;
  const std::span<const uint8_t> codes =
      datagram.subspan(kHeaderBytes + static_cast<size_t>(index) * header.beams, header.beams);
  column.frame_id = header.frame_id;
  column.measurement_id = static_cast<uint16_t>(header.first_measurement + index);
  column.beams = header.beams;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (size_t row = 0; row < codes.size(); ++row) column.label[row] = codes[row];
  return Status::kOk;
}

Status Encode(const Header& header, std::span<const uint8_t> codes, std::span<uint8_t> datagram,
              int& size_bytes) {
  size_bytes = 0;
  if (!CountsInRange(header) || codes.size() != CodeBytes(header) ||
      header.first_measurement + header.columns > kMaxColumnsPerRevolution) {
    return Status::kInvalidArgument;
  }
  if (datagram.size() < kLeastBytes + codes.size()) return Status::kCapacityExceeded;
  Write(datagram, kMagicOffset, 4, kMagic);
  Write(datagram, kVersionOffset, 1, kVersion);
  Write(datagram, kBeamsOffset, 1, header.beams);
  Write(datagram, kFrameIdOffset, 2, header.frame_id);
  Write(datagram, kFirstMeasurementOffset, 2, header.first_measurement);
  Write(datagram, kColumnsOffset, 2, header.columns);
  Write(datagram, kSequenceOffset, 4, header.sequence);
  Write(datagram, kTimestampOffset, 8, header.timestamp_ns);
  HP_LOOP_BOUND(kMaxColumns * kMaxBeams)
  for (size_t i = 0; i < codes.size(); ++i) datagram[kHeaderBytes + i] = codes[i];
  const size_t checked_bytes = kHeaderBytes + codes.size();
  Write(datagram, checked_bytes, kFooterBytes, CrcOf(datagram.first(checked_bytes)));
  size_bytes = static_cast<int>(checked_bytes) + kFooterBytes;
  return Status::kOk;
}

}  // namespace hardpack::labels
