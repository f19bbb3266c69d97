// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/status.h"

// Receives a sensor's datagrams. Receive only: nothing is sent to a sensor over this interface. It
// returns the datagrams of one configured sender and counts the others. No call blocks.
// test/hal/conformance tests every implementation against this page.

namespace hardpack {

// The largest lidar packet (128-row DUAL, 33,024 B) plus some room.
inline constexpr int kMaxDatagram_bytes = 33280;

struct Datagram {
  // Wall clock [ns since 1970] of the receiving computer's kernel, for the log only; 0: unknown.
  int64_t kernel_time_ns = 0;
  uint32_t sender_address = 0;  // IPv4, host byte order
  uint16_t sender_port = 0;
  std::span<const uint8_t> bytes;  // valid until the next Receive
};

struct DatagramCounters {
  uint64_t received = 0;              // returned by Receive
  uint64_t received_bytes = 0;        // of these
  uint64_t foreign = 0;               // from other senders: dropped
  uint64_t oversized = 0;             // more than kMaxDatagram_bytes: dropped
  uint64_t lost_in_kernel = 0;        // no room in the socket's buffer
  uint64_t system_errors = 0;         // of receiving
  uint64_t receive_buffer_bytes = 0;  // as granted by the kernel; 0: unknown
};

class DatagramSocket {
 public:
  // Most datagrams returned by one Receive.
  static constexpr int kMaxBatch = 32;

  // Takes received datagrams, the oldest first, at most `max` (1 .. kMaxBatch), including foreign
  // ones, which are not returned. The rest stays for the next call. The spans are valid until then.
  // Empty: nothing received, or the socket fails (counted).
  virtual std::span<const Datagram> Receive(int max) = 0;

  virtual const DatagramCounters& counters() const = 0;

 protected:
  ~DatagramSocket() = default;
};

}  // namespace hardpack
