// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/flight_log/packets.h"

#include "core/base/assert.h"
#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"

namespace hardpack::flight_log {
namespace {

constexpr uint16_t kProtocolIpv4 = 0x0800;
constexpr uint16_t kProtocolCan = 0x000c;    // LINUX_SLL_P_CAN
constexpr uint16_t kHardwareLoopback = 772;  // ARPHRD_LOOPBACK
constexpr uint16_t kHardwareEthernet = 1;    // ARPHRD_ETHER
constexpr uint16_t kHardwareCan = 280;       // ARPHRD_CAN
constexpr uint32_t kLoopbackInterface = 1;
constexpr size_t kIpv4HeaderBytes = 20;
constexpr size_t kUdpHeaderBytes = 8;
constexpr uint32_t kMaxSnapshotBytes = 262144;  // as tcpdump has it

// linux/can.h
constexpr uint32_t kExtendedFlag = 0x80000000u;
constexpr uint32_t kRemoteFlag = 0x40000000u;
constexpr uint32_t kErrorFlag = 0x20000000u;
constexpr uint8_t kFdFlag = 0x04u;  // CANFD_FDF, in the byte behind the length
constexpr size_t kFdBytes = 72;     // of a canfd_frame

// Precondition of both: they fit.
void PutLow(uint64_t value, size_t size, std::span<uint8_t> bytes) {
  HP_LOOP_BOUND(8)
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(value >> (8 * i) & 0xffu);
}

void PutHigh(uint64_t value, size_t size, std::span<uint8_t> bytes) {
  HP_LOOP_BOUND(8)
  for (size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<uint8_t>(value >> (8 * (size - 1 - i)) & 0xffu);
  }
}

// LINKTYPE_LINUX_SLL2, without a link layer's address.
void PutCooked(uint16_t protocol, uint32_t interface_index, uint16_t hardware, Direction direction,
               std::span<uint8_t> bytes) {
  PutHigh(protocol, 2, bytes);
  PutHigh(0, 2, bytes.subspan(2));
  PutHigh(interface_index, 4, bytes.subspan(4));
  PutHigh(hardware, 2, bytes.subspan(8));
  bytes[10] = static_cast<uint8_t>(direction);
  bytes[11] = 0;
  PutHigh(0, 8, bytes.subspan(12));
}

// RFC 791: the ones' complement of the ones' complement sum of the header's 16-bit words.
uint16_t HeaderChecksum(std::span<const uint8_t> header) {
  uint32_t sum = 0;
  HP_LOOP_BOUND(kIpv4HeaderBytes / 2)
  for (size_t i = 0; i + 1 < kIpv4HeaderBytes; i += 2) {
    sum += uint32_t{header[i]} << 8u | header[i + 1];
  }
  sum = (sum & 0xffffu) + (sum >> 16u);
  sum = (sum & 0xffffu) + (sum >> 16u);
  return static_cast<uint16_t>(~sum & 0xffffu);
}

uint32_t Turned(uint32_t value) {
  return value >> 24u | (value >> 8u & 0xff00u) | (value << 8u & 0xff0000u) | value << 24u;
}

}  // namespace

void EncodeFileHeader(std::span<uint8_t, kPcapFileHeaderBytes> bytes) {
  PutLow(kPcapMagic_ns, 4, bytes);
  PutLow(2, 2, bytes.subspan(4));
  PutLow(4, 2, bytes.subspan(6));
  PutLow(0, 8, bytes.subspan(8));
  PutLow(kMaxSnapshotBytes, 4, bytes.subspan(16));
  PutLow(kLinkType, 4, bytes.subspan(20));
}

void EncodePacketHeader(uint32_t seconds, uint32_t nanoseconds, uint32_t packet_bytes,
                        std::span<uint8_t, kPcapPacketHeaderBytes> bytes) {
  PutLow(seconds, 4, bytes);
  PutLow(nanoseconds, 4, bytes.subspan(4));
  PutLow(packet_bytes, 4, bytes.subspan(8));
  PutLow(packet_bytes, 4, bytes.subspan(12));
}

void EncodeDatagramHead(const Endpoint& from, const Endpoint& to, size_t payload_bytes,
                        std::span<uint8_t, kDatagramHeadBytes> bytes) {
  HP_ASSERT(payload_bytes <= kMaxPayloadBytes);
  const bool own = from.address == kLoopback;
  PutCooked(kProtocolIpv4, own ? kLoopbackInterface : 0,
            own ? kHardwareLoopback : kHardwareEthernet, Direction::kIn, bytes);
  const std::span<uint8_t> ipv4 = bytes.subspan(kCookedHeaderBytes);
  PutHigh(0x4500, 2, ipv4);  // version 4, five words
  PutHigh(kIpv4HeaderBytes + kUdpHeaderBytes + payload_bytes, 2, ipv4.subspan(2));
  PutHigh(0x00004000, 4, ipv4.subspan(4));  // no identification: not to be taken apart
  PutHigh(0x4011, 2, ipv4.subspan(8));      // 64 hops, UDP
  PutHigh(0, 2, ipv4.subspan(10));
  PutHigh(from.address, 4, ipv4.subspan(12));
  PutHigh(to.address, 4, ipv4.subspan(16));
  PutHigh(HeaderChecksum(ipv4), 2, ipv4.subspan(10));
  const std::span<uint8_t> udp = ipv4.subspan(kIpv4HeaderBytes);
  PutHigh(from.port, 2, udp);
  PutHigh(to.port, 2, udp.subspan(2));
  PutHigh(kUdpHeaderBytes + payload_bytes, 2, udp.subspan(4));
  PutHigh(0, 2, udp.subspan(6));
}

void EncodeCan(const CanFrame& frame, Direction direction, int32_t interface_index,
               std::span<uint8_t, kCanPacketBytes> bytes) {
  HP_ASSERT(IsValid(frame));
  PutCooked(kProtocolCan, static_cast<uint32_t>(interface_index), kHardwareCan, direction, bytes);
  const std::span<uint8_t> can = bytes.subspan(kCookedHeaderBytes);
  const uint32_t id =
      frame.id | (frame.extended ? kExtendedFlag : 0u) | (frame.remote ? kRemoteFlag : 0u);
  PutLow(id, 4, can);
  PutLow(frame.size, 4, can.subspan(4));  // and three bytes that mean nothing
  HP_LOOP_BOUND(kMaxCanData_bytes)
  for (size_t i = 0; i < kMaxCanData_bytes; ++i) {
    can[8 + i] = i < frame.size && !frame.remote ? frame.data[i] : uint8_t{0};
  }
}

Status DecodeCan(std::span<const uint8_t> bytes, IdOrder order, CanFrame& frame) {
  ByteReader reader(bytes);
  const uint32_t word = order == IdOrder::kLowestFirst ? reader.U32(0) : Turned(reader.U32(0));
  CanFrame read;
  read.extended = (word & kExtendedFlag) != 0;
  read.remote = (word & kRemoteFlag) != 0;
  read.id = word & (read.extended ? kMaxExtendedCanId : ~(kRemoteFlag | kErrorFlag));
  read.size = reader.U8(4);
  const bool fd = bytes.size() >= kFdBytes || (reader.U8(5) & kFdFlag) != 0;
  if (!IsUsable(reader.status())) return reader.status();
  if (fd || (word & kErrorFlag) != 0) return Status::kUnsupported;
  if (!IsValid(read)) return Status::kInvalidArgument;
  const size_t data_bytes = read.remote ? 0 : read.size;
  const std::span<const uint8_t> data = reader.Sub(8, data_bytes);
  if (!IsUsable(reader.status())) return reader.status();
  HP_LOOP_BOUND(kMaxCanData_bytes)
  for (size_t i = 0; i < data_bytes; ++i) read.data[i] = data[i];
  frame = read;
  return Status::kOk;
}

}  // namespace hardpack::flight_log
