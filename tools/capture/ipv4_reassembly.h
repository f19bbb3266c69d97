// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Reassembles fragments of IPv4 datagrams (RFC 791): a lidar packet of 12.6 kB crosses an Ethernet
// in nine. Bounded: a fixed number of datagrams in flight, each of at most 64 KiB. It counts
// separately what it could not complete, and does not look at the contents.

namespace hardpack::capture {

// Identifies the fragments of one datagram.
struct FragmentKey {
  uint32_t source_address = 0;  // host byte order
  uint32_t destination_address = 0;
  uint16_t identification = 0;
  uint8_t protocol = 0;
  bool operator==(const FragmentKey&) const = default;
};

struct Fragment {
  FragmentKey key;
  int64_t time_ns = 0;
  size_t offset = 0;  // bytes, a multiple of 8
  bool more = false;  // not the last one
  std::span<const uint8_t> bytes;
};

struct ReassemblyCounters {
  int64_t fragments = 0;
  int64_t completed = 0;
  int64_t incomplete = 0;  // given up: too old, or displaced by newer ones
  int64_t conflicts = 0;   // given up: fragments that contradict each other or are impossible
};

class Ipv4Reassembly {
 public:
  static constexpr size_t kMaxInFlight = 16;
  static constexpr size_t kMaxBytes = 65535;
  static constexpr int64_t kMaxAge_ns = 2'000'000'000;

  // Takes one fragment, in any order, repeated or overlapping. Returns the payload of the datagram
  // that it completes, valid until the next call; otherwise nothing. Bytes carried by two fragments
  // must agree: otherwise the datagram is given up.
  std::span<const uint8_t> Add(const Fragment& fragment);

  // Gives up what is in flight; call at the end of the capture.
  void Finish();

  const ReassemblyCounters& counters() const { return counters_; }

 private:
  struct Slot {
    bool used = false;
    FragmentKey key;
    int64_t first_time_ns = 0;
    size_t total_bytes = 0;  // 0: the last fragment has not arrived
    size_t end_bytes = 0;    // end of the farthest fragment
    size_t filled_bytes = 0;
    std::vector<uint8_t> bytes;   // [kMaxBytes] once used
    std::vector<uint8_t> filled;  // [kMaxBytes] 1 where a fragment has written
  };

  Slot& SlotFor(const Fragment& fragment);
  static bool Place(const Fragment& fragment, Slot& slot);

  std::array<Slot, kMaxInFlight> slots_;
  ReassemblyCounters counters_;
};

}  // namespace hardpack::capture
