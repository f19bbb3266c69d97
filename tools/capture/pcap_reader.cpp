// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/pcap_reader.h"

#include <pcap/pcap.h>

#include <array>
#include <bit>
#include <cstdio>

#include "core/base/byte_reader.h"

namespace hardpack::capture {
namespace {

constexpr uint16_t kEtherTypeIpv4 = 0x0800;
constexpr uint16_t kCookedCan = 0x000c;  // LINUX_SLL_P_CAN
constexpr int kMaxVlanTags = 4;
constexpr size_t kUdpHeaderBytes = 8;
constexpr size_t kMinIpv4HeaderBytes = 20;
constexpr uint8_t kProtocolUdp = 17;
constexpr uint32_t kFamilyIpv4 = 2;  // AF_INET, in loopback captures

uint16_t U16NetworkOrder(ByteReader& reader, size_t offset) {
  return __builtin_bswap16(reader.U16(offset));
}
uint32_t U32NetworkOrder(ByteReader& reader, size_t offset) {
  return __builtin_bswap32(reader.U32(offset));
}

bool IsVlanTag(uint16_t ether_type) {
  return ether_type == 0x8100 || ether_type == 0x88a8 || ether_type == 0x9100;
}

// The start of the IPv4 packet or the can_frame in a frame.
struct PacketStart {
  enum class Kind : uint8_t { kIpv4, kCan, kOther, kTooShort };
  Kind kind = Kind::kTooShort;
  size_t offset = 0;
};

// The position after an EtherType field, past any VLAN tags. `offset`: of the field; `header_end`:
// start of the data after it.
PacketStart BehindEtherType(ByteReader& reader, size_t offset, size_t header_end) {
  uint16_t type = U16NetworkOrder(reader, offset);
  for (int tag = 0; tag < kMaxVlanTags && IsVlanTag(type); ++tag) {
    type = U16NetworkOrder(reader, header_end + 2);
    header_end += 4;
  }
  if (!IsUsable(reader.status()) || header_end > reader.size()) return {};
  return {type == kEtherTypeIpv4 ? PacketStart::Kind::kIpv4 : PacketStart::Kind::kOther,
          header_end};
}

// The position after the header of a cooked capture, whose protocols are EtherTypes and Linux's
// own.
PacketStart BehindCooked(ByteReader& reader, size_t offset, size_t header_end) {
  if (U16NetworkOrder(reader, offset) != kCookedCan || header_end > reader.size()) {
    return BehindEtherType(reader, offset, header_end);
  }
  return {PacketStart::Kind::kCan, header_end};
}

// The address family stands in the byte order of the machine that captured, or the network's.
PacketStart BehindFamily(ByteReader& reader) {
  const uint32_t family = reader.U32(0);
  if (!IsUsable(reader.status())) return {};
  const bool ipv4 = family == kFamilyIpv4 || __builtin_bswap32(family) == kFamilyIpv4;
  return {ipv4 ? PacketStart::Kind::kIpv4 : PacketStart::Kind::kOther, 4};
}

PacketStart BehindNothing(ByteReader& reader) {
  const int version = reader.U8(0) >> 4;
  if (!IsUsable(reader.status())) return {};
  return {version == 4 ? PacketStart::Kind::kIpv4 : PacketStart::Kind::kOther, 0};
}

bool IsHandled(int link_type) {
  constexpr std::array kHandled = {DLT_EN10MB, DLT_LINUX_SLL, DLT_LINUX_SLL2, DLT_RAW,
                                   DLT_IPV4,   DLT_NULL,      DLT_LOOP,       DLT_CAN_SOCKETCAN};
  for (const int handled : kHandled) {
    if (link_type == handled) return true;
  }
  return false;
}

// Precondition: IsHandled(link_type).
PacketStart FindStart(int link_type, ByteReader& reader) {
  switch (link_type) {
    case DLT_EN10MB:
      return BehindEtherType(reader, 12, 14);
    case DLT_LINUX_SLL:
      return BehindCooked(reader, 14, 16);
    case DLT_LINUX_SLL2:
      return BehindCooked(reader, 0, 20);
    case DLT_CAN_SOCKETCAN:
      return {PacketStart::Kind::kCan, 0};
    case DLT_NULL:
    case DLT_LOOP:
      return BehindFamily(reader);
    default:
      return BehindNothing(reader);
  }
}

}  // namespace

PcapReader::PcapReader() = default;

PcapReader::~PcapReader() {
  if (file_ != nullptr) pcap_close(file_);
}

ReadOutcome PcapReader::Open(const std::string& path) {
  if (file_ != nullptr) pcap_close(file_);
  file_ = nullptr;
  path_ = path;
  counters_ = CaptureCounters{};
  reassembly_ = Ipv4Reassembly();
  drops_duplicates_ = false;
  duplicates_ = DuplicateFilter();
  std::FILE* const stream = std::fopen(path.c_str(), "rb");
  if (stream == nullptr) {
    outcome_ = {Status::kInvalidArgument, path + ": cannot be opened"};
    return outcome_;
  }
  std::array<char, PCAP_ERRBUF_SIZE> reason{};
  file_ =
      pcap_fopen_offline_with_tstamp_precision(stream, PCAP_TSTAMP_PRECISION_NANO, reason.data());
  if (file_ == nullptr) {
    std::fclose(stream);
    outcome_ = {Status::kInvalidArgument, path + ": not a capture file (" + reason.data() + ")"};
    return outcome_;
  }
  link_type_ = pcap_datalink(file_);
  outcome_ = {};
  if (!IsHandled(link_type_)) {
    const char* const name = pcap_datalink_val_to_name(link_type_);
    outcome_ = {Status::kUnsupported, path + ": link type " + std::to_string(link_type_) + " (" +
                                          (name == nullptr ? "unknown" : name) +
                                          ") is not handled"};
    pcap_close(file_);
    file_ = nullptr;
  }
  return outcome_;
}

bool PcapReader::Next(CapturedPacket& packet) {
  std::span<const uint8_t> bytes;
  bool cut = false;
  while (ReadRecord(bytes, cut, packet.time_ns)) {
    if (IsDuplicate(bytes, packet.time_ns)) continue;
    if (TakeFrame(bytes, cut, packet)) return true;
  }
  return false;
}

bool PcapReader::Next(UdpDatagram& datagram) {
  CapturedPacket packet;
  while (Next(packet)) {
    if (packet.kind != CapturedPacket::Kind::kDatagram) continue;
    datagram = packet.datagram;
    return true;
  }
  return false;
}

// The next record of the file. False at its end, which closes it.
bool PcapReader::ReadRecord(std::span<const uint8_t>& bytes, bool& cut, int64_t& time_ns) {
  if (file_ == nullptr) return false;
  pcap_pkthdr* header = nullptr;
  const u_char* data = nullptr;
  const int got = pcap_next_ex(file_, &header, &data);
  if (got == 1) {
    ++counters_.frames;
    bytes = {data, header->caplen};
    cut = header->caplen < header->len;
    // With nanosecond precision libpcap puts nanoseconds into tv_usec.
    time_ns = int64_t{header->ts.tv_sec} * 1'000'000'000 + header->ts.tv_usec;
    return true;
  }
  if (got != PCAP_ERROR_BREAK) {
    outcome_ = {Status::kTruncated, path_ + ": cannot be read beyond packet " +
                                        std::to_string(counters_.frames) + " (" +
                                        pcap_geterr(file_) + ")"};
  }
  reassembly_.Finish();
  pcap_close(file_);
  file_ = nullptr;
  return false;
}

bool PcapReader::IsDuplicate(std::span<const uint8_t> frame, int64_t time_ns) {
  constexpr size_t kHeaderBytes = flight_log::kCookedHeaderBytes;
  if (!drops_duplicates_ || link_type_ != DLT_LINUX_SLL2 || frame.size() < kHeaderBytes) {
    return false;
  }
  ByteReader reader(frame);
  const uint32_t interface_index = U32NetworkOrder(reader, 4);
  if (!duplicates_.IsDuplicate(frame.subspan(kHeaderBytes), interface_index, time_ns)) return false;
  ++counters_.duplicates;
  return true;
}

bool PcapReader::TakeFrame(std::span<const uint8_t> frame, bool cut, CapturedPacket& packet) {
  ByteReader reader(frame);
  const PacketStart start = FindStart(link_type_, reader);
  switch (start.kind) {
    case PacketStart::Kind::kIpv4:
      packet.kind = CapturedPacket::Kind::kDatagram;
      packet.datagram.time_ns = packet.time_ns;
      if (!TakeIpv4(frame.subspan(start.offset), cut, packet.datagram)) return false;
      ++counters_.datagrams;
      return true;
    case PacketStart::Kind::kCan:
      packet.packet_type = link_type_ == DLT_LINUX_SLL2 ? reader.U8(10) : uint8_t{0};
      return TakeCan(frame.subspan(start.offset), cut, packet);
    case PacketStart::Kind::kOther:
      ++counters_.other_frames;
      return false;
    case PacketStart::Kind::kTooShort:
      break;
  }
  ++(cut ? counters_.cut_frames : counters_.malformed_frames);
  return false;
}

// The identifier stands highest byte first in captures of a CAN interface, and in the machine's own
// order, which libpcap sees to, in cooked ones.
bool PcapReader::TakeCan(std::span<const uint8_t> bytes, bool cut, CapturedPacket& packet) {
  using flight_log::IdOrder;
  const IdOrder order = link_type_ == DLT_CAN_SOCKETCAN || std::endian::native == std::endian::big
                            ? IdOrder::kHighestFirst
                            : IdOrder::kLowestFirst;
  switch (flight_log::DecodeCan(bytes, order, packet.frame)) {
    case Status::kOk:
      packet.kind = CapturedPacket::Kind::kCanFrame;
      ++counters_.can_frames;
      return true;
    case Status::kUnsupported:
      ++counters_.other_frames;
      return false;
    default:
      ++(cut ? counters_.cut_frames : counters_.malformed_frames);
      return false;
  }
}

bool PcapReader::TakeIpv4(std::span<const uint8_t> packet, bool cut, UdpDatagram& datagram) {
  ByteReader reader(packet);
  const uint8_t version_and_length = reader.U8(0);
  const size_t header_bytes = (version_and_length & 0x0fu) * size_t{4};
  const size_t total_bytes = U16NetworkOrder(reader, 2);
  const uint16_t fragment_bits = U16NetworkOrder(reader, 6);
  Fragment fragment;
  fragment.key = {U32NetworkOrder(reader, 12), U32NetworkOrder(reader, 16),
                  U16NetworkOrder(reader, 4), reader.U8(9)};
  if (IsUsable(reader.status()) && fragment.key.protocol != kProtocolUdp) {
    ++counters_.other_frames;
    return false;
  }
  const bool consistent = IsUsable(reader.status()) && version_and_length >> 4 == 4 &&
                          header_bytes >= kMinIpv4HeaderBytes && total_bytes > header_bytes;
  if (!consistent || total_bytes > packet.size()) {
    ++(cut ? counters_.cut_frames : counters_.malformed_frames);
    return false;
  }
  // Padding may follow total_bytes.
  fragment.bytes = packet.subspan(header_bytes, total_bytes - header_bytes);
  fragment.time_ns = datagram.time_ns;
  fragment.offset = (fragment_bits & 0x1fffu) * size_t{8};
  fragment.more = (fragment_bits & 0x2000u) != 0;
  datagram.source_address = fragment.key.source_address;
  datagram.destination_address = fragment.key.destination_address;
  if (fragment.offset == 0 && !fragment.more) return TakeUdp(fragment.bytes, datagram);
  const std::span<const uint8_t> whole = reassembly_.Add(fragment);
  return !whole.empty() && TakeUdp(whole, datagram);
}

bool PcapReader::TakeUdp(std::span<const uint8_t> packet, UdpDatagram& datagram) {
  ByteReader reader(packet);
  datagram.source_port = U16NetworkOrder(reader, 0);
  datagram.destination_port = U16NetworkOrder(reader, 2);
  const size_t length = U16NetworkOrder(reader, 4);
  if (!IsUsable(reader.status()) || length < kUdpHeaderBytes || length > packet.size()) {
    ++counters_.malformed_frames;
    return false;
  }
  datagram.payload = packet.subspan(kUdpHeaderBytes, length - kUdpHeaderBytes);
  return true;
}

}  // namespace hardpack::capture
