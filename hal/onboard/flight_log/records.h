// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "hal/can_bus.h"
#include "hal/onboard/flight_log/packets.h"
#include "hal/onboard/pilot/input_source.h"

// The parts of a flight log that no wire carries: records of our own, each the payload of one UDP
// datagram from 127.0.0.1 to 127.0.0.1, port kRecordPort on both sides (docs/flight_log.md).
//
//   @0 magic "HPFL"  @4 version u8  @5 kind u8  @6 zero u16  @8 body
//
// All numbers little-endian. Encodes and decodes; keeps no state.

namespace hardpack::flight_log {

inline constexpr uint16_t kRecordPort = 47100;
inline constexpr uint32_t kRecordMagic = 0x4c465048u;  // "HPFL"
inline constexpr uint8_t kRecordVersion = 1;
inline constexpr size_t kRecordHeaderBytes = 8;
// Larger contents are split into parts. Half of a datagram, so that each tick can be given an even
// share.
inline constexpr size_t kMaxPartBytes = 32768;
inline constexpr size_t kMaxBodyHeadBytes = 184;  // of a body, before its bytes
inline constexpr size_t kMaxRecordHeadBytes = kRecordHeaderBytes + kMaxBodyHeadBytes;

enum class RecordKind : uint8_t {
  kNone = 0,           // not one of our records
  kVersion = 1,        // the first of a file
  kConfiguration = 2,  // a part of the configuration text (TOML)
  kLidarMetadata = 3,  // a part of the lidar's metadata (JSON)
  kStateImage = 4,  // a part of the state after a tick, from which the file can be replayed alone
  kTickBegin = 5,   // a tick's inputs follow: its frames, its datagrams, its command
  kCommand = 6,     // the tick's control message
  kTickEnd = 7,     // after the frames that the tick sent
  kGap = 8,         // records are missing here
  kEnd = 9,         // the run ended normally: nothing was lost at its end
};

// Texts end with a zero, or fill their field.
struct VersionRecord {
  uint64_t run = 0;           // the same in all files of a run, different in every run
  uint32_t file = 0;          // counts the files of a run, from 0
  uint64_t next_tick = 0;     // the index after the last tick of the previous file; 0: none
  uint64_t state_bytes = 0;   // of the whole state
  uint64_t state_layout = 0;  // AnyVehicle::state_layout() of the writing program
  char version[32] = {};
  char build[64] = {};
  char processor[16] = {};
  char vehicle[32] = {};  // its type
};

struct PartRecord {  // kConfiguration, kLidarMetadata
  uint32_t offset = 0;
  uint32_t whole_bytes = 0;
  std::span<const uint8_t> bytes;
};

struct ImageRecord {
  uint64_t index = 0;  // of the preceding tick
  uint32_t offset = 0;
  uint32_t whole_bytes = 0;
  uint32_t crc = 0;  // CRC-32 of the image up to here, including this part
  std::span<const uint8_t> bytes;
};

struct TickBeginRecord {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  CanBusState bus = CanBusState::kDown;
  uint16_t datagrams[kInputSources] = {};  // by InputSource
  uint16_t frames = 0;
  uint16_t command_bytes = 0;
};

struct CommandRecord {
  uint32_t user = 0;  // the peer's, from the operating system
  std::span<const uint8_t> bytes;
};

struct TickEndRecord {
  uint64_t index = 0;
  Status status = Status::kOk;
  uint16_t frames = 0;         // output of the tick, logged before this
  uint16_t refused = 0;        // of these, refused by the bus
  uint64_t decision_hash = 0;  // of everything decided so far
  uint64_t duration_ns = 0;    // of the tick; for information: it differs between runs
};

struct GapRecord {
  uint64_t records = 0;  // missing
};

// A record's head: everything except the bytes at the end of PartRecord, ImageRecord and
// CommandRecord.
class RecordHead {
 public:
  explicit RecordHead(const VersionRecord& record);
  RecordHead(RecordKind kind, const PartRecord& record);
  explicit RecordHead(const ImageRecord& record);
  explicit RecordHead(const TickBeginRecord& record);
  explicit RecordHead(const CommandRecord& record);
  explicit RecordHead(const TickEndRecord& record);
  explicit RecordHead(const GapRecord& record);
  static RecordHead End() { return RecordHead(RecordKind::kEnd); }

  std::span<const uint8_t> bytes() const { return std::span(bytes_).first(size_); }

 private:
  explicit RecordHead(RecordKind kind);
  void Add(uint64_t value, size_t bytes);
  void AddText(std::span<const char> text);

  uint8_t bytes_[kMaxRecordHeadBytes] = {};
  size_t size_ = 0;
};

// The kind of a datagram's payload: kNone if it does not have our magic number and version, is
// shorter than a header, or is of an unknown kind.
RecordKind KindOf(std::span<const uint8_t> payload);

// Each: kWrongPacketType: of another kind; kTruncated, kOversized: not the size of its kind;
// kInvalidArgument: a number that such a record cannot have (a part outside its whole, an unknown
// bus state). On failure `record` is empty. Cost: constant; the spans are into `payload`.
Status Decode(std::span<const uint8_t> payload, VersionRecord& record);
Status Decode(std::span<const uint8_t> payload, PartRecord& record);
Status Decode(std::span<const uint8_t> payload, ImageRecord& record);
Status Decode(std::span<const uint8_t> payload, TickBeginRecord& record);
Status Decode(std::span<const uint8_t> payload, CommandRecord& record);
Status Decode(std::span<const uint8_t> payload, TickEndRecord& record);
Status Decode(std::span<const uint8_t> payload, GapRecord& record);

}  // namespace hardpack::flight_log
