// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/flight_log/flight_log.h"

#include "core/base/assert.h"
#include "core/base/crc32.h"
#include "core/base/loop_bound.h"

namespace hardpack::flight_log {
namespace {

constexpr Endpoint kOwn = {kLoopback, kRecordPort};
constexpr int kMaxTextParts = FlightLog::kMaxTextBytes / kMaxPartBytes;
constexpr size_t kMaxCommandBytes = kMaxPayloadBytes - kMaxRecordHeadBytes;

TickBeginRecord Describe(const TickInput& input) {
  TickBeginRecord record;
  record.index = input.index;
  record.now_ns = input.now_ns;
  record.bus = input.bus;
  InputSource before = InputSource::kIns;
  HP_LOOP_BOUND(TickLimits::kMaxDatagramsPerTick)
  for (const TickDatagram& datagram : input.datagrams) {
    // Readers tell the sources apart by their counts.
    HP_ASSERT(datagram.source >= before);
    before = datagram.source;
    ++record.datagrams[static_cast<int>(datagram.source)];
  }
  record.frames = static_cast<uint16_t>(input.frames.size());
  record.command_bytes = static_cast<uint16_t>(input.command.size());
  return record;
}

}  // namespace

FlightLog::FlightLog(Recorder& recorder, std::span<uint8_t> snapshot)
    : recorder_(recorder), snapshot_(snapshot) {}

Status FlightLog::Start(const FlightLogSetup& setup) {
  started_ = false;
  files_ = 0;
  any_tick_ = false;
  image_bytes_ = 0;
  const bool fits =
      setup.configuration.size() <= kMaxTextBytes && setup.lidar_metadata.size() <= kMaxTextBytes;
  if (!fits) return Status::kOversized;
  setup_ = setup;
  started_ = true;
  return Status::kOk;
}

void FlightLog::BeginTick(const TickInput& input, const TickArrivals& arrivals,
                          std::span<const std::byte> state) {
  HP_ASSERT(input.datagrams.size() <= TickLimits::kMaxDatagramsPerTick &&
            input.frames.size() <= CanBus::kMaxFramesPerTick &&
            input.command.size() <= kMaxCommandBytes);
  HP_ASSERT(arrivals.datagrams.empty() || arrivals.datagrams.size() == input.datagrams.size());
  if (!started_) return;
  tick_time_ns_ = static_cast<int64_t>(input.now_ns) + setup_.wall_clock_offset_ns;
  if (recorder_.wants_opening()) Open(state);
  RecordTick(input);
  HP_LOOP_BOUND(CanBus::kMaxFramesPerTick)
  for (const CanFrame& frame : input.frames) {
    const bool is_timed = frame.received_ns != 0 && frame.received_ns < input.now_ns;
    const uint64_t age_ns = is_timed ? input.now_ns - frame.received_ns : 0;
    RecordFrame(frame, Direction::kIn, tick_time_ns_ - static_cast<int64_t>(age_ns));
  }
  HP_LOOP_BOUND(TickLimits::kMaxDatagramsPerTick)
  for (size_t i = 0; i < input.datagrams.size(); ++i) {
    RecordDatagram(input.datagrams[i],
                   arrivals.datagrams.empty() ? nullptr : &arrivals.datagrams[i]);
  }
  if (!input.command.empty()) RecordCommand(arrivals.command_user, input.command);
}

void FlightLog::EndTick(const TickResult& result, const TickOutput& output) {
  if (!started_) return;
  HP_LOOP_BOUND(kMaxFramesOut)
  for (const CanFrame& frame : output.frames) {
    RecordFrame(frame, Direction::kOut, tick_time_ns_);
  }
  RecordImageParts();
  TickEndRecord record;
  record.index = result.index;
  record.status = result.status;
  record.frames = static_cast<uint16_t>(output.frames.size());
  record.refused = static_cast<uint16_t>(result.refused_frames);
  record.decision_hash = result.decision_hash;
  record.duration_ns = result.duration_ns;
  RecordOwn(RecordHead(record), {});
  any_tick_ = true;
  last_index_ = result.index;
}

void FlightLog::End() {
  if (started_) RecordOwn(RecordHead::End(), {});
  started_ = false;
}

void FlightLog::Open(std::span<const std::byte> state) {
  recorder_.BeginFile();
  RecordVersion(state.size());
  RecordText(RecordKind::kConfiguration, setup_.configuration);
  RecordText(RecordKind::kLidarMetadata, setup_.lidar_metadata);
  image_bytes_ = 0;
  if (any_tick_) TakeSnapshot(state);
}

void FlightLog::TakeSnapshot(std::span<const std::byte> state) {
  if (state.size() > snapshot_.size() || state.size() > kMaxStateBytes) return;
  // Not through the member, which the bytes could be part of, for all that a compiler knows: it
  // would copy them one by one.
  const std::span<uint8_t> copy = snapshot_.first(state.size());
  const std::byte* const from = state.data();
  uint8_t* const to = copy.data();
  HP_LOOP_BOUND(kMaxStateBytes)
  for (size_t i = 0; i < copy.size(); ++i) to[i] = static_cast<uint8_t>(from[i]);
  image_bytes_ = state.size();
  image_done_bytes_ = 0;
  image_crc_ = 0;
  image_index_ = last_index_;
}

void FlightLog::RecordVersion(size_t state_bytes) {
  VersionRecord record = setup_.version;
  record.file = files_++;
  record.next_tick = any_tick_ ? last_index_ + 1 : 0;
  record.state_bytes = state_bytes;
  RecordOwn(RecordHead(record), {});
}

void FlightLog::RecordTick(const TickInput& input) {
  RecordOwn(RecordHead(Describe(input)), {});
}

void FlightLog::RecordCommand(uint32_t user, std::span<const uint8_t> command) {
  RecordOwn(RecordHead(CommandRecord{user, {}}), command);
}

// An empty text is one empty part: that it was empty is to be known.
void FlightLog::RecordText(RecordKind kind, std::span<const uint8_t> text) {
  const auto whole_bytes = static_cast<uint32_t>(text.size());
  if (text.empty()) RecordPart(kind, PartRecord{}, {});
  HP_LOOP_BOUND(kMaxTextParts)
  for (size_t offset = 0; offset < text.size(); offset += kMaxPartBytes) {
    const size_t rest = text.size() - offset;
    RecordPart(kind, {static_cast<uint32_t>(offset), whole_bytes, {}},
               text.subspan(offset, rest < kMaxPartBytes ? rest : kMaxPartBytes));
  }
}

void FlightLog::RecordPart(RecordKind kind, const PartRecord& part,
                           std::span<const uint8_t> bytes) {
  RecordOwn(RecordHead(kind, part), bytes);
}

void FlightLog::RecordDatagram(const TickDatagram& datagram, const Arrival* arrival) {
  HP_ASSERT(datagram.bytes.size() <= kMaxPayloadBytes);
  const auto source = static_cast<size_t>(datagram.source);
  const Endpoint& from = arrival != nullptr ? arrival->sender : setup_.sender[source];
  const int64_t age_ns = arrival != nullptr ? tick_time_ns_ - arrival->kernel_time_ns : 0;
  const bool stamped = arrival != nullptr && age_ns >= 0 && age_ns <= kMaxStampAge_ns;
  uint8_t head[kDatagramHeadBytes];
  EncodeDatagramHead(from, setup_.receiver[source], datagram.bytes.size(), head);
  static_cast<void>(
      recorder_.Record(stamped ? arrival->kernel_time_ns : tick_time_ns_, head, datagram.bytes));
}

void FlightLog::RecordFrame(const CanFrame& frame, Direction direction, int64_t time_ns) {
  uint8_t packet[kCanPacketBytes];
  EncodeCan(frame, direction, setup_.can_interface, packet);
  static_cast<void>(recorder_.Record(time_ns, packet, {}));
}

void FlightLog::RecordImageParts() {
  HP_LOOP_BOUND(kImagePartsPerTick)
  for (int part = 0; part < kImagePartsPerTick && image_bytes_ != 0; ++part) {
    const size_t rest = image_bytes_ - image_done_bytes_;
    const std::span<const uint8_t> bytes =
        snapshot_.subspan(image_done_bytes_, rest < kMaxPartBytes ? rest : kMaxPartBytes);
    image_crc_ = ExtendCrc32<kMaxPartBytes>(image_crc_, bytes);
    ImageRecord record;
    record.index = image_index_;
    record.offset = static_cast<uint32_t>(image_done_bytes_);
    record.whole_bytes = static_cast<uint32_t>(image_bytes_);
    record.crc = image_crc_;
    RecordOwn(RecordHead(record), bytes);
    image_done_bytes_ += bytes.size();
    if (image_done_bytes_ == image_bytes_) image_bytes_ = 0;
  }
}

void FlightLog::RecordOwn(const RecordHead& head, std::span<const uint8_t> bytes) {
  uint8_t packet[kDatagramHeadBytes + kMaxRecordHeadBytes];
  const std::span<const uint8_t> own = head.bytes();
  EncodeDatagramHead(kOwn, kOwn, own.size() + bytes.size(),
                     std::span(packet).first<kDatagramHeadBytes>());
  HP_LOOP_BOUND(kMaxRecordHeadBytes)
  for (size_t i = 0; i < own.size(); ++i) packet[kDatagramHeadBytes + i] = own[i];
  // What it cannot take is its counters' and its Gap record's.
  static_cast<void>(recorder_.Record(
      tick_time_ns_, std::span(packet).first(kDatagramHeadBytes + own.size()), bytes));
}

}  // namespace hardpack::flight_log
