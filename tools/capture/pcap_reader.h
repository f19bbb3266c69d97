// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/can_frame.h"
#include "hal/onboard/flight_log/packets.h"
#include "port_linux/files/read_outcome.h"
#include "tools/capture/duplicate_filter.h"
#include "tools/capture/ipv4_reassembly.h"

struct pcap;

// Reads UDP datagrams and CAN frames from a capture file (pcap or pcapng, through libpcap):
// Ethernet with VLAN tags, Linux cooked captures of both versions, raw IP, loopback and CAN
// interfaces; IPv4, whole or in fragments. Everything else is counted and skipped. Checksums are
// not checked: on a sending machine the capture is taken before the network card fills them in.

namespace hardpack::capture {

struct UdpDatagram {
  int64_t time_ns = 0;          // when the capture took it (its last fragment), since 1970
  uint32_t source_address = 0;  // host byte order
  uint32_t destination_address = 0;
  uint16_t source_port = 0;
  uint16_t destination_port = 0;
  std::span<const uint8_t> payload;  // valid until the next call of Next
};

// Either of the two.
struct CapturedPacket {
  enum class Kind : uint8_t { kDatagram, kCanFrame };
  Kind kind = Kind::kDatagram;
  int64_t time_ns = 0;  // when the capture took it, since 1970
  UdpDatagram datagram;
  CanFrame frame;
  // The packet type of a cooked capture, which is reliable only in a flight log: a capture by Linux
  // marks every CAN frame as a broadcast, whoever sent it.
  uint8_t packet_type = 0;
};

struct CaptureCounters {
  int64_t frames = 0;            // records in the file
  int64_t datagrams = 0;         // whole UDP datagrams
  int64_t can_frames = 0;        // data and remote frames of CAN
  int64_t duplicates = 0;        // already seen on another interface: dropped
  int64_t cut_frames = 0;        // the capture kept less than was sent (snaplen)
  int64_t malformed_frames = 0;  // lengths that contradict each other
  int64_t other_frames = 0;      // neither UDP over IPv4 nor classic CAN
};

class PcapReader {
 public:
  PcapReader();
  ~PcapReader();
  PcapReader(const PcapReader&) = delete;
  PcapReader& operator=(const PcapReader&) = delete;

  // kInvalidArgument: cannot be opened, or not a capture file; kUnsupported: another link type.
  ReadOutcome Open(const std::string& path);

  // From now on, packets that `tcpdump -i any` saw on several interfaces are returned once. If a
  // capture does not name the interfaces (all link types but LINUX_SLL2), nothing is dropped.
  void DropDuplicates() { drops_duplicates_ = true; }

  // The next datagram or frame. False at the end of the file, or if it cannot be read further:
  // outcome() says which (kOk, or kTruncated if the file ends within a record).
  bool Next(CapturedPacket& packet);

  // The same, skipping everything but datagrams.
  bool Next(UdpDatagram& datagram);

  const ReadOutcome& outcome() const { return outcome_; }
  const CaptureCounters& counters() const { return counters_; }
  const ReassemblyCounters& reassembly() const { return reassembly_.counters(); }

 private:
  bool ReadRecord(std::span<const uint8_t>& bytes, bool& cut, int64_t& time_ns);
  bool IsDuplicate(std::span<const uint8_t> frame, int64_t time_ns);
  bool TakeFrame(std::span<const uint8_t> frame, bool cut, CapturedPacket& packet);
  bool TakeCan(std::span<const uint8_t> bytes, bool cut, CapturedPacket& packet);
  bool TakeIpv4(std::span<const uint8_t> packet, bool cut, UdpDatagram& datagram);
  bool TakeUdp(std::span<const uint8_t> packet, UdpDatagram& datagram);

  std::string path_;
  pcap* file_ = nullptr;
  int link_type_ = 0;
  ReadOutcome outcome_;
  CaptureCounters counters_;
  Ipv4Reassembly reassembly_;
  bool drops_duplicates_ = false;
  DuplicateFilter duplicates_;
};

}  // namespace hardpack::capture
