// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/flight_log/records.h"

#include "core/base/assert.h"
#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"

namespace hardpack::flight_log {
namespace {

static_assert(std::is_trivially_copyable_v<VersionRecord>);
static_assert(std::is_trivially_copyable_v<RecordHead>);

constexpr size_t kVersionTextOffset = kRecordHeaderBytes + 36;
constexpr size_t kBuildTextOffset = kVersionTextOffset + sizeof(VersionRecord::version);
constexpr size_t kProcessorTextOffset = kBuildTextOffset + sizeof(VersionRecord::build);
constexpr size_t kVehicleTextOffset = kProcessorTextOffset + sizeof(VersionRecord::processor);
constexpr size_t kVersionBytes = kVehicleTextOffset + sizeof(VersionRecord::vehicle);
constexpr size_t kPartHeadBytes = kRecordHeaderBytes + 8;
constexpr size_t kImageHeadBytes = kRecordHeaderBytes + 20;
constexpr size_t kTickBeginBytes = kRecordHeaderBytes + 17 + 2 * kInputSources + 4;
constexpr size_t kCommandHeadBytes = kRecordHeaderBytes + 4;
constexpr size_t kTickEndBytes = kRecordHeaderBytes + 29;
constexpr size_t kGapBytes = kRecordHeaderBytes + 8;
static_assert(kVersionBytes <= kMaxRecordHeadBytes);
constexpr size_t kMaxTextField = sizeof(VersionRecord::build);

// Whether the payload is of that kind and size.
Status CheckForm(std::span<const uint8_t> payload, RecordKind kind, size_t least_bytes,
                 size_t most_bytes) {
  if (KindOf(payload) != kind) return Status::kWrongPacketType;
  if (payload.size() < least_bytes) return Status::kTruncated;
  return payload.size() > most_bytes ? Status::kOversized : Status::kOk;
}

void ReadText(std::span<const uint8_t> bytes, std::span<char> text) {
  HP_LOOP_BOUND(kMaxTextField)
  for (size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(bytes[i]);
}

// Whether a part lies within its whole.
bool IsPart(uint32_t offset, size_t bytes, uint32_t whole_bytes) {
  return offset <= whole_bytes && bytes <= whole_bytes - offset;
}

}  // namespace

RecordHead::RecordHead(RecordKind kind) {
  Add(kRecordMagic, 4);
  Add(kRecordVersion, 1);
  Add(static_cast<uint8_t>(kind), 1);
  Add(0, 2);
}

RecordHead::RecordHead(const VersionRecord& record) : RecordHead(RecordKind::kVersion) {
  Add(record.run, 8);
  Add(record.file, 4);
  Add(record.next_tick, 8);
  Add(record.state_bytes, 8);
  Add(record.state_layout, 8);
  AddText(record.version);
  AddText(record.build);
  AddText(record.processor);
  AddText(record.vehicle);
}

RecordHead::RecordHead(RecordKind kind, const PartRecord& record) : RecordHead(kind) {
  HP_ASSERT(kind == RecordKind::kConfiguration || kind == RecordKind::kLidarMetadata);
  Add(record.offset, 4);
  Add(record.whole_bytes, 4);
}

RecordHead::RecordHead(const ImageRecord& record) : RecordHead(RecordKind::kStateImage) {
  Add(record.index, 8);
  Add(record.offset, 4);
  Add(record.whole_bytes, 4);
  Add(record.crc, 4);
}

RecordHead::RecordHead(const TickBeginRecord& record) : RecordHead(RecordKind::kTickBegin) {
  Add(record.index, 8);
  Add(record.now_ns, 8);
  Add(static_cast<uint8_t>(record.bus), 1);
  HP_LOOP_BOUND(kInputSources)
  for (const uint16_t count : record.datagrams) Add(count, 2);
  Add(record.frames, 2);
  Add(record.command_bytes, 2);
}

RecordHead::RecordHead(const CommandRecord& record) : RecordHead(RecordKind::kCommand) {
  Add(record.user, 4);
}

RecordHead::RecordHead(const TickEndRecord& record) : RecordHead(RecordKind::kTickEnd) {
  Add(record.index, 8);
  Add(static_cast<uint8_t>(record.status), 1);
  Add(record.frames, 2);
  Add(record.refused, 2);
  Add(record.decision_hash, 8);
  Add(record.duration_ns, 8);
}

RecordHead::RecordHead(const GapRecord& record) : RecordHead(RecordKind::kGap) {
  Add(record.records, 8);
}

void RecordHead::Add(uint64_t value, size_t bytes) {
  HP_ASSERT(bytes <= kMaxRecordHeadBytes - size_);
  HP_LOOP_BOUND(8)
  for (size_t i = 0; i < bytes; ++i) {
    bytes_[size_ + i] = static_cast<uint8_t>(value >> (8 * i) & 0xffu);
  }
  size_ += bytes;
}

void RecordHead::AddText(std::span<const char> text) {
  HP_ASSERT(text.size() <= kMaxRecordHeadBytes - size_);
  HP_LOOP_BOUND(kMaxTextField)
  for (size_t i = 0; i < text.size(); ++i) bytes_[size_ + i] = static_cast<uint8_t>(text[i]);
  size_ += text.size();
}

RecordKind KindOf(std::span<const uint8_t> payload) {
  ByteReader reader(payload);
  const bool ours = reader.U32(0) == kRecordMagic && reader.U8(4) == kRecordVersion;
  const uint8_t kind = reader.U8(5);
  const bool known = payload.size() >= kRecordHeaderBytes && ours &&
                     kind <= static_cast<uint8_t>(RecordKind::kEnd);
  return known ? static_cast<RecordKind>(kind) : RecordKind::kNone;
}

Status Decode(std::span<const uint8_t> payload, VersionRecord& record) {
  record = VersionRecord{};
  const Status form = CheckForm(payload, RecordKind::kVersion, kVersionBytes, kVersionBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  record.run = reader.U64(8);
  record.file = reader.U32(16);
  record.next_tick = reader.U64(20);
  record.state_bytes = reader.U64(28);
  record.state_layout = reader.U64(36);
  ReadText(reader.Sub(kVersionTextOffset, sizeof(record.version)), record.version);
  ReadText(reader.Sub(kBuildTextOffset, sizeof(record.build)), record.build);
  ReadText(reader.Sub(kProcessorTextOffset, sizeof(record.processor)), record.processor);
  ReadText(reader.Sub(kVehicleTextOffset, sizeof(record.vehicle)), record.vehicle);
  return reader.status();
}

Status Decode(std::span<const uint8_t> payload, PartRecord& record) {
  record = PartRecord{};
  const RecordKind kind = KindOf(payload) == RecordKind::kLidarMetadata
                              ? RecordKind::kLidarMetadata
                              : RecordKind::kConfiguration;
  const Status form = CheckForm(payload, kind, kPartHeadBytes, kPartHeadBytes + kMaxPartBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  const PartRecord read = {reader.U32(8), reader.U32(12), payload.subspan(kPartHeadBytes)};
  if (!IsPart(read.offset, read.bytes.size(), read.whole_bytes)) return Status::kInvalidArgument;
  record = read;
  return reader.status();
}

Status Decode(std::span<const uint8_t> payload, ImageRecord& record) {
  record = ImageRecord{};
  const Status form =
      CheckForm(payload, RecordKind::kStateImage, kImageHeadBytes, kImageHeadBytes + kMaxPartBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  const ImageRecord read = {reader.U64(8), reader.U32(16), reader.U32(20), reader.U32(24),
                            payload.subspan(kImageHeadBytes)};
  if (!IsPart(read.offset, read.bytes.size(), read.whole_bytes)) return Status::kInvalidArgument;
  record = read;
  return reader.status();
}

Status Decode(std::span<const uint8_t> payload, TickBeginRecord& record) {
  record = TickBeginRecord{};
  const Status form = CheckForm(payload, RecordKind::kTickBegin, kTickBeginBytes, kTickBeginBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  TickBeginRecord read;
  read.index = reader.U64(8);
  read.now_ns = reader.U64(16);
  const uint8_t bus = reader.U8(24);
  if (bus >= kCanBusStates) return Status::kInvalidArgument;
  read.bus = static_cast<CanBusState>(bus);
  HP_LOOP_BOUND(kInputSources)
  for (size_t i = 0; i < kInputSources; ++i) read.datagrams[i] = reader.U16(25 + 2 * i);
  read.frames = reader.U16(25 + 2 * kInputSources);
  read.command_bytes = reader.U16(27 + 2 * kInputSources);
  record = read;
  return reader.status();
}

Status Decode(std::span<const uint8_t> payload, CommandRecord& record) {
  record = CommandRecord{};
  const Status form = CheckForm(payload, RecordKind::kCommand, kCommandHeadBytes, kMaxPayloadBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  record = {reader.U32(8), payload.subspan(kCommandHeadBytes)};
  return reader.status();
}

Status Decode(std::span<const uint8_t> payload, TickEndRecord& record) {
  record = TickEndRecord{};
  const Status form = CheckForm(payload, RecordKind::kTickEnd, kTickEndBytes, kTickEndBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  record.index = reader.U64(8);
  record.status = static_cast<Status>(reader.U8(16));
  record.frames = reader.U16(17);
  record.refused = reader.U16(19);
  record.decision_hash = reader.U64(21);
  record.duration_ns = reader.U64(29);
  return reader.status();
}

Status Decode(std::span<const uint8_t> payload, GapRecord& record) {
  record = GapRecord{};
  const Status form = CheckForm(payload, RecordKind::kGap, kGapBytes, kGapBytes);
  if (!IsUsable(form)) return form;
  ByteReader reader(payload);
  record.records = reader.U64(8);
  return reader.status();
}

}  // namespace hardpack::flight_log
