// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/control/status_report.h"

#include <bit>
#include <cstddef>
#include <type_traits>

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"
#include "hal/onboard/control/message_writer.h"
#include "hal/onboard/control/status_table.h"

namespace hardpack::control {
namespace {

// The body: u32 of the table, then the fields in its order: numbers little-endian in their own
// sizes, a flag as a byte, an age as two u64, a text as its kTextBytes bytes.
constexpr size_t kFieldsOffset = kHeaderBytes + 4;

template <typename Value>
constexpr size_t EncodedBytes() {
  return std::is_same_v<Value, Age> ? 16 : sizeof(Value);
}

// FNV-1a over names, kinds and sizes: two programs that have the same number mean the same fields.
class TableDigest {
 public:
  constexpr void BeginGroup(const char* name) { AddText(name); }
  template <typename Value>
  constexpr void operator()(const char* name, FieldKind kind, Concern, const Value&) {
    AddText(name);
    Add(static_cast<uint8_t>(kind));
    Add(static_cast<uint8_t>(EncodedBytes<Value>()));
    Add(std::is_same_v<Value, float> ? 1 : 0);
    Add(std::is_signed_v<Value> ? 1 : 0);
    bytes_ += EncodedBytes<Value>();
  }
  constexpr uint32_t value() const { return value_; }
  constexpr size_t bytes() const { return bytes_; }

 private:
  static constexpr int kMaxNameBytes = 64;

  constexpr void Add(uint8_t byte) { value_ = (value_ ^ byte) * 16777619u; }
  constexpr void AddText(const char* text) {
    HP_LOOP_BOUND(kMaxNameBytes)
    for (int i = 0; text[i] != '\0'; ++i) Add(static_cast<uint8_t>(text[i]));
    Add(0);
  }

  uint32_t value_ = 2166136261u;
  size_t bytes_ = 0;
};

constexpr TableDigest DigestOfTable() {
  TableDigest digest;
  const StatusReport report;
  VisitStatus(report, digest);
  return digest;
}
constexpr TableDigest kTable = DigestOfTable();
constexpr size_t kMessageBytes = kFieldsOffset + kTable.bytes();
static_assert(kMessageBytes <= kMaxMessageBytes);

constexpr bool IsPrintable(char letter) {
  return letter >= ' ' && letter <= '~';
}

// Printable up to a zero, and zeros from there on.
template <size_t kBytes>
bool IsText(const char (&text)[kBytes]) {
  bool ended = false;
  HP_LOOP_BOUND(kBytes)
  for (const char letter : text) {
    if (ended ? letter != '\0' : letter != '\0' && !IsPrintable(letter)) return false;
    ended = ended || letter == '\0';
  }
  return ended;
}

class Writing {
 public:
  explicit Writing(MessageWriter& writer) : writer_(writer) {}

  void BeginGroup(const char*) {}
  void operator()(const char*, FieldKind, Concern, bool value) { writer_.U8(value ? 1 : 0); }
  void operator()(const char*, FieldKind, Concern, uint8_t value) { writer_.U8(value); }
  void operator()(const char*, FieldKind, Concern, uint16_t value) { writer_.U16(value); }
  void operator()(const char*, FieldKind, Concern, uint32_t value) { writer_.U32(value); }
  void operator()(const char*, FieldKind, Concern, uint64_t value) { writer_.U64(value); }
  void operator()(const char*, FieldKind, Concern, int32_t value) {
    writer_.U32(static_cast<uint32_t>(value));
  }
  void operator()(const char*, FieldKind, Concern, int64_t value) {
    writer_.U64(static_cast<uint64_t>(value));
  }
  void operator()(const char*, FieldKind, Concern, float value) { writer_.F32(value); }
  void operator()(const char*, FieldKind, Concern, const Age& value) {
    writer_.U64(value.age_ns);
    writer_.U64(value.limit_ns);
  }
  void operator()(const char*, FieldKind, Concern, const char (&text)[kTextBytes]) {
    HP_LOOP_BOUND(kTextBytes)
    for (const char letter : text) writer_.U8(static_cast<uint8_t>(letter));
  }

 private:
  MessageWriter& writer_;
};

// Reads each field; with `keep` false it only checks that it can be one. The sizes are right.
class Reading {
 public:
  Reading(std::span<const uint8_t> message, bool keep)
      : reader_(message), keep_(keep), offset_(kFieldsOffset) {}

  void BeginGroup(const char*) {}
  // Not inlined: there are some two hundred fields, and few types.
  template <typename Value>
  [[gnu::noinline]] void operator()(const char*, FieldKind, Concern, Value& value) {
    Value read{};
    Read(read);
    if (keep_) value = read;
    offset_ += EncodedBytes<Value>();
  }
  void operator()(const char*, FieldKind, Concern, char (&text)[kTextBytes]) {
    char read[kTextBytes] = {};
    HP_LOOP_BOUND(kTextBytes)
    for (size_t i = 0; i < kTextBytes; ++i) {
      read[i] = static_cast<char>(reader_.U8(offset_ + i));
      if (keep_) text[i] = read[i];
    }
    Require(IsText(read));
    offset_ += kTextBytes;
  }

  Status status() const { return status_; }

 private:
  void Read(bool& value) {
    const uint8_t byte = reader_.U8(offset_);
    Require(byte <= 1);
    value = byte == 1;
  }
  void Read(uint8_t& value) { value = reader_.U8(offset_); }
  void Read(uint16_t& value) { value = reader_.U16(offset_); }
  void Read(uint32_t& value) { value = reader_.U32(offset_); }
  void Read(uint64_t& value) { value = reader_.U64(offset_); }
  void Read(int32_t& value) { value = static_cast<int32_t>(reader_.U32(offset_)); }
  void Read(int64_t& value) { value = static_cast<int64_t>(reader_.U64(offset_)); }
  void Read(float& value) { value = reader_.F32(offset_); }
  void Read(Age& value) { value = {reader_.U64(offset_), reader_.U64(offset_ + 8)}; }
  void Require(bool condition) {
    if (!condition) status_ = Status::kInvalidArgument;
  }

  ByteReader reader_;
  bool keep_;
  size_t offset_;
  Status status_ = Status::kOk;
};

}  // namespace

Status Encode(const StatusReport& report, uint32_t sequence, std::span<uint8_t> buffer,
              int& size_bytes) {
  size_bytes = 0;
  const ProgramPart& program = report.program;
  if (!IsText(program.version) || !IsText(program.vehicle)) return Status::kInvalidArgument;
  if (buffer.size() < kMessageBytes) return Status::kCapacityExceeded;
  MessageWriter writer(buffer, Kind::kStatus, sequence);
  writer.U32(kTable.value());
  Writing writing(writer);
  VisitStatus(report, writing);
  return writer.Finish(size_bytes);
}

Status Decode(std::span<const uint8_t> message, StatusReport& report) {
  Header header;
  const Status status = ReadHeader(message, header);
  if (status != Status::kOk) return status;
  if (header.kind != Kind::kStatus) return Status::kWrongPacketType;
  if (message.size() < kFieldsOffset) return Status::kTruncated;
  if (ByteReader(message).U32(kHeaderBytes) != kTable.value()) return Status::kUnsupported;
  if (message.size() < kMessageBytes) return Status::kTruncated;
  if (message.size() > kMessageBytes) return Status::kOversized;
  Reading checking(message, false);
  VisitStatus(report, checking);
  if (checking.status() != Status::kOk) return checking.status();
  Reading keeping(message, true);
  VisitStatus(report, keeping);
  return keeping.status();
}

}  // namespace hardpack::control
