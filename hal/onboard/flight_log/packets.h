// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "hal/can_frame.h"

// The packets of a capture file of link type LINUX_SLL2 (276), which can mix datagrams and CAN
// frames: their headers. `tcpdump -i any` writes the same. Layouts as documented by libpcap
// (REFERENCES.md) and RFC 791, RFC 768. Encodes, and decodes the part shared with captures of other
// link types, a CAN frame.

namespace hardpack::flight_log {

inline constexpr uint32_t kLinkType = 276;              // LINKTYPE_LINUX_SLL2
inline constexpr uint32_t kPcapMagic_ns = 0xa1b23c4du;  // stamps in nanoseconds
inline constexpr size_t kPcapFileHeaderBytes = 24;
inline constexpr size_t kPcapPacketHeaderBytes = 16;

inline constexpr size_t kCookedHeaderBytes = 20;
inline constexpr size_t kDatagramHeadBytes = kCookedHeaderBytes + 20 + 8;  // and IPv4 and UDP
inline constexpr size_t kCanBytes = 16;                                    // a can_frame
inline constexpr size_t kCanPacketBytes = kCookedHeaderBytes + kCanBytes;
inline constexpr size_t kMaxPayloadBytes = 65535 - 20 - 8;  // of an IPv4 datagram of UDP

struct Endpoint {
  uint32_t address = 0;  // IPv4, host byte order
  uint16_t port = 0;
  bool operator==(const Endpoint&) const = default;
};
inline constexpr uint32_t kLoopback = 0x7f000001u;  // 127.0.0.1

enum class Direction : uint8_t { kIn = 0, kOut = 4 };  // values of the header's packet type

// Header of a capture file.
void EncodeFileHeader(std::span<uint8_t, kPcapFileHeaderBytes> bytes);

// Header of a packet in it: its stamp, since 1970, and its size.
void EncodePacketHeader(uint32_t seconds, uint32_t nanoseconds, uint32_t packet_bytes,
                        std::span<uint8_t, kPcapPacketHeaderBytes> bytes);

// Headers of a received datagram: cooked header, IPv4 with its checksum, UDP without (0: not
// computed). Precondition: payload_bytes <= kMaxPayloadBytes.
void EncodeDatagramHead(const Endpoint& from, const Endpoint& to, size_t payload_bytes,
                        std::span<uint8_t, kDatagramHeadBytes> bytes);

// A frame as a complete packet. The identifier is stored lowest byte first, as Linux does on the
// machines that this runs on: readers of such files assume the file's own byte order. Precondition:
// IsValid(frame).
void EncodeCan(const CanFrame& frame, Direction direction, int32_t interface_index,
               std::span<uint8_t, kCanPacketBytes> bytes);

enum class IdOrder : uint8_t { kLowestFirst, kHighestFirst };

// A can_frame as it follows the link layer's header; bytes after its data may be missing.
// kTruncated: fewer bytes than its size says; kUnsupported: an error report, or an FD frame;
// kInvalidArgument: not a frame that a bus can carry. On failure `frame` is unchanged.
Status DecodeCan(std::span<const uint8_t> bytes, IdOrder order, CanFrame& frame);

}  // namespace hardpack::flight_log
