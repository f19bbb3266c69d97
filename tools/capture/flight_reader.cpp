// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/flight_reader.h"

#include <span>

#include "core/base/crc32.h"
#include "hal/onboard/flight_log/flight_log.h"
#include "hal/onboard/flight_log/packets.h"

namespace hardpack::capture {
namespace {

using flight_log::RecordKind;

constexpr int kPacketsLookedAt = 1000;  // before a capture is taken for somebody else's

bool IsOwn(const UdpDatagram& datagram) {
  return datagram.source_address == flight_log::kLoopback &&
         datagram.destination_address == flight_log::kLoopback &&
         datagram.source_port == flight_log::kRecordPort &&
         datagram.destination_port == flight_log::kRecordPort &&
         flight_log::KindOf(datagram.payload) != RecordKind::kNone;
}

// Appends a part to the previous ones. A first part starts again.
void AddPart(uint64_t offset, uint64_t whole_bytes, std::span<const uint8_t> bytes,
             Assembled& assembled) {
  if (offset == 0) assembled = Assembled{};
  if (offset != assembled.next) {
    assembled.damaged = true;
    return;
  }
  assembled.bytes.insert(assembled.bytes.end(), bytes.begin(), bytes.end());
  assembled.next += bytes.size();
  assembled.whole = !assembled.damaged && assembled.next == whole_bytes;
}

}  // namespace

ReadOutcome FlightReader::IsFlightLog(const std::string& path, bool& is_log) {
  is_log = false;
  PcapReader reader;
  ReadOutcome opened = reader.Open(path);
  if (!opened.ok()) return opened;
  CapturedPacket packet;
  for (int i = 0; i < kPacketsLookedAt && !is_log && reader.Next(packet); ++i) {
    is_log = packet.kind == CapturedPacket::Kind::kDatagram && IsOwn(packet.datagram);
  }
  return {};
}

ReadOutcome FlightReader::Open(const std::string& path) {
  has_version_ = false;
  version_ = {};
  configuration_ = {};
  lidar_metadata_ = {};
  image_ = {};
  image_index_ = 0;
  image_crc_ = 0;
  gap_records_ = 0;
  damage_.clear();
  in_tick_ = false;
  return reader_.Open(path);
}

FlightReader::Item FlightReader::Next(LoggedTick& tick) {
  CapturedPacket packet;
  while (reader_.Next(packet)) {
    Item item = Item::kFileEnd;  // none yet
    bool good = true;
    if (packet.kind == CapturedPacket::Kind::kCanFrame) {
      good = TakeFrame(packet, tick);
    } else if (IsOwn(packet.datagram)) {
      good = TakeRecord(packet.datagram, tick, item);
    } else {
      good = TakeDatagram(packet.datagram, tick);
    }
    if (!good) return Item::kDamaged;
    if (item != Item::kFileEnd) return item;
  }
  const CaptureCounters& counters = reader_.counters();
  const bool all_taken = counters.frames == counters.datagrams + counters.can_frames;
  if (damage_.empty() && !all_taken) {
    Damage("it has packets that do not belong in a flight log");
    return Item::kDamaged;
  }
  return Item::kFileEnd;
}

bool FlightReader::Damage(const std::string& reason) {
  damage_ = reason;
  in_tick_ = false;
  return false;
}

bool FlightReader::TakeRecord(const UdpDatagram& datagram, LoggedTick& tick, Item& item) {
  const std::span<const uint8_t> payload = datagram.payload;
  switch (flight_log::KindOf(payload)) {
    case RecordKind::kVersion:
      if (!IsUsable(Decode(payload, version_))) return Damage("a version record is malformed");
      has_version_ = true;
      return true;
    case RecordKind::kConfiguration:
      return TakePart(RecordKind::kConfiguration, payload);
    case RecordKind::kLidarMetadata:
      return TakePart(RecordKind::kLidarMetadata, payload);
    case RecordKind::kStateImage:
      return TakeImage(payload);
    case RecordKind::kTickBegin:
      return BeginTick(payload, datagram.time_ns, tick);
    case RecordKind::kCommand:
      return TakeCommand(payload, tick);
    case RecordKind::kTickEnd:
      item = Item::kTick;
      return EndTick(payload, tick);
    case RecordKind::kGap: {
      flight_log::GapRecord gap;
      if (!IsUsable(Decode(payload, gap))) return Damage("a gap record is malformed");
      gap_records_ = gap.records;
      in_tick_ = false;
      item = Item::kGap;
      return true;
    }
    case RecordKind::kEnd:
      item = Item::kEnd;
      return true;
    case RecordKind::kNone:
      break;
  }
  return Damage("a record is of an unknown kind");
}

bool FlightReader::TakePart(RecordKind kind, std::span<const uint8_t> payload) {
  flight_log::PartRecord part;
  if (!IsUsable(Decode(payload, part))) return Damage("a part of a text is malformed");
  if (part.whole_bytes > flight_log::FlightLog::kMaxTextBytes) return Damage("a text is too long");
  AddPart(part.offset, part.whole_bytes, part.bytes,
          kind == RecordKind::kConfiguration ? configuration_ : lidar_metadata_);
  return true;
}

// A damaged image is no damage to the ticks: the file before may lead to them.
bool FlightReader::TakeImage(std::span<const uint8_t> payload) {
  flight_log::ImageRecord part;
  const bool usable =
      IsUsable(Decode(payload, part)) && part.whole_bytes <= flight_log::FlightLog::kMaxStateBytes;
  if (!usable) {
    image_.damaged = true;
    return true;
  }
  if (part.offset == 0) {
    image_crc_ = 0;
    image_index_ = part.index;
  }
  image_crc_ = ExtendCrc32<flight_log::kMaxPartBytes>(image_crc_, part.bytes);
  AddPart(part.offset, part.whole_bytes, part.bytes, image_);
  if (image_crc_ != part.crc || part.index != image_index_) {
    image_.damaged = true;
    image_.whole = false;
  }
  return true;
}

bool FlightReader::BeginTick(std::span<const uint8_t> payload, int64_t time_ns, LoggedTick& tick) {
  if (in_tick_) return Damage("a tick begins before the previous one has ended");
  tick = LoggedTick{};
  tick.time_ns = time_ns;
  if (!IsUsable(Decode(payload, tick.begin))) return Damage("a tick's first record is malformed");
  in_tick_ = true;
  return true;
}

bool FlightReader::EndTick(std::span<const uint8_t> payload, LoggedTick& tick) {
  if (!in_tick_) return Damage("a tick ends that has not begun");
  if (!IsUsable(Decode(payload, tick.end))) return Damage("a tick's last record is malformed");
  size_t datagrams = 0;
  for (const uint16_t count : tick.begin.datagrams) datagrams += count;
  const bool agrees =
      tick.end.index == tick.begin.index && tick.frames_in.size() == tick.begin.frames &&
      tick.datagrams.size() == datagrams && tick.command.size() == tick.begin.command_bytes &&
      tick.frames_out.size() == tick.end.frames;
  if (!agrees) {
    return Damage("tick " + std::to_string(tick.begin.index) + " does not match its records");
  }
  in_tick_ = false;
  return true;
}

bool FlightReader::TakeCommand(std::span<const uint8_t> payload, LoggedTick& tick) {
  flight_log::CommandRecord command;
  const bool good = in_tick_ && tick.command.empty() && IsUsable(Decode(payload, command));
  if (!good) return Damage("a command is malformed or outside a tick");
  tick.command.assign(command.bytes.begin(), command.bytes.end());
  tick.command_user = command.user;
  return true;
}

// The datagrams of a tick are in the order of their sources, with a given number of each.
bool FlightReader::TakeDatagram(const UdpDatagram& datagram, LoggedTick& tick) {
  size_t last = 0;
  for (size_t source = 0; source < kInputSources; ++source) {
    last += tick.begin.datagrams[source];
    if (!in_tick_ || tick.datagrams.size() >= last) continue;
    tick.datagrams.push_back({static_cast<InputSource>(source),
                              {datagram.source_address, datagram.source_port},
                              {datagram.payload.begin(), datagram.payload.end()}});
    return true;
  }
  return Damage("a datagram is outside a tick");
}

bool FlightReader::TakeFrame(const CapturedPacket& packet, LoggedTick& tick) {
  if (!in_tick_) return Damage("a CAN frame is outside a tick");
  if (packet.packet_type == static_cast<uint8_t>(flight_log::Direction::kIn)) {
    tick.frames_in.push_back(packet.frame);
    // Logs of before frames had a time of their own have the tick's: they came in it.
    const int64_t age_ns = tick.time_ns - packet.time_ns;
    const bool is_older = age_ns > 0 && static_cast<uint64_t>(age_ns) < tick.begin.now_ns;
    tick.frames_in.back().received_ns =
        is_older ? tick.begin.now_ns - static_cast<uint64_t>(age_ns) : 0;
  } else if (packet.packet_type == static_cast<uint8_t>(flight_log::Direction::kOut)) {
    tick.frames_out.push_back(packet.frame);
  } else {
    return Damage("a CAN frame has no direction");
  }
  return true;
}

}  // namespace hardpack::capture
