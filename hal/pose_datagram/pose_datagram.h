// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The datagram in which any navigation system, or a program that reads one, sends the contents of
// an InsSample: the format of docs/pose_datagram.md, in both directions, and the device that
// receives it. Ours.

namespace hardpack::pose_datagram {

inline constexpr size_t kDatagram_bytes = 116;
inline constexpr uint8_t kVersion = 1;

// Writes one datagram. kInvalidArgument: a value that Decode would refuse.
Status Encode(const InsSample& sample, uint32_t sequence,
              std::span<uint8_t, kDatagram_bytes> bytes);

// kWrongPacketType: wrong magic number; kUnsupported: another version; kBadCrc; kNotFinite: a
// number in a group that is present; kInvalidArgument: an angle, a position, a mode or a bit that
// is out of range, or an uncertainty below zero. On failure nothing is written. Cost: one pass over
// the bytes.
Status Decode(std::span<const uint8_t, kDatagram_bytes> bytes, uint32_t& sequence,
              InsSample& sample);

// Counts since construction; Reset keeps them.
struct Counters {
  uint64_t bytes = 0;          // taken by Feed
  uint64_t skipped_bytes = 0;  // not part of a datagram
  uint64_t samples = 0;        // returned
  uint64_t refused = 0;        // datagrams with a correct CRC and an invalid value
  uint64_t repeated = 0;       // with a sequence number that is not newer
  uint64_t missed = 0;         // by the sequence numbers of those received
  uint64_t restarts = 0;       // of the sender, by its sequence numbers
  uint64_t bad_crc = 0;
};

// Finds the datagrams in the input, whole or in pieces, and skips other data byte by byte. A
// datagram whose sequence number is not newer than the last one's is dropped: it is a duplicate, or
// was overtaken. A sequence number kRestart or more behind means that the sender has restarted.
class Receiver {
 public:
  static constexpr size_t kFeed_bytes = 1536;
  static constexpr size_t kCapacity = kFeed_bytes + kDatagram_bytes;
  static constexpr uint32_t kRestart = 1000;

  // As for InsDevice (hal/onboard/vehicle_loop/devices.h).
  void BeginTick(int looks) { looks_left_ = looks; }
  // Cost: one step per byte taken, and at most one move of the waiting bytes.
  size_t Feed(std::span<const uint8_t> bytes);
  // kTruncated: no whole datagram is left, or the looks are used up; `sample` is untouched. A look
  // is one magic number, true or false. Cost: one step per byte skipped, one CRC per look.
  Status Next(InsSample& sample);
  void Reset();

  const Counters& counters() const { return counters_; }

 private:
  std::span<const uint8_t> Waiting() const {
    return std::span<const uint8_t>(bytes_).subspan(begin_, end_ - begin_);
  }
  void PassOver(size_t count);
  bool FindMagic();
  bool IsNewer(uint32_t sequence);

  uint8_t bytes_[kCapacity] = {};  // [begin_, end_) are waiting
  size_t begin_ = 0;
  size_t end_ = 0;
  int32_t looks_left_ = INT32_MAX;
  bool has_sequence_ = false;
  uint32_t sequence_ = 0;
  Counters counters_;
};
static_assert(std::is_trivially_copyable_v<Receiver>);

}  // namespace hardpack::pose_datagram
