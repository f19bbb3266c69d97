// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "hal/vectornav/vectornav.h"

// Finds the messages of a VectorNav sensor in a stream of bytes that comes in pieces, as from a
// bridge that puts a serial line into datagrams: messages do not align with them. What the messages
// say is decided in hal/vectornav/vectornav.h; here is decided what is a message:
//
//   A message begins at the first byte from which on one is whole and has the right checksum. Where
//   0xFA or $ stands but no such message, only that byte is passed over: a message that begins
//   inside what looked like one is found.
//
// So what is found depends on the bytes alone and not on how they are cut. What looks like the
// beginning of a message is waited for: after a false beginning the next message may be told up to
// kMaxMessageBytes of stream later than it came. Whether a pause is so long that the rest of a
// message cannot come any more is for the caller to know (Reset).

namespace hardpack::vectornav {

inline constexpr size_t kMaxMessageBytes = kMaxBinaryBytes;
static_assert(kMaxAsciiBytes <= kMaxMessageBytes);

// Since the parser was made; Reset keeps them.
//   samples + unused + not_finite + out_of_range = binary_messages + ascii_messages
struct StreamCounters {
  uint64_t bytes = 0;            // taken by Feed
  uint64_t skipped_bytes = 0;    // no part of a message: noise, line ends between messages, cut off
  uint64_t binary_messages = 0;  // whole and with the right checksum
  uint64_t ascii_messages = 0;

  uint64_t samples = 0;       // told
  uint64_t unused = 0;        // messages with nothing that an InsSample says
  uint64_t not_finite = 0;    // messages refused because a number in them is not finite,
  uint64_t out_of_range = 0;  // because an angle or a position cannot be, or a text is no number

  // Beginnings at which there was no message; noise has them by chance.
  uint64_t bad_checksum = 0;  // damaged on the way
  uint64_t unsupported = 0;   // 0xFA or $ without a header or text that is known
};

// Trivially copyable, no pointers; the caller's. About 8 KiB.
//
//   while (!datagram.empty()) {
//     datagram = datagram.subspan(parser.Feed(datagram));
//     while (IsUsable(parser.Next(sample))) Use(sample);
//   }
class StreamParser {
 public:
  // What Feed takes at least once Next has said that there is nothing more: any datagram of an
  // Ethernet goes in at once.
  static constexpr size_t kFeedBytes = 1536;
  // Bytes that wait at most.
  static constexpr size_t kCapacity = kMaxMessageBytes + kFeedBytes;

  // Takes as many bytes as there is room for, from the front, and says how many. The others are to
  // be given again after Next has said kTruncated. Cost: one step a byte taken, and once in
  // kFeedBytes a move of what waits.
  size_t Feed(std::span<const uint8_t> bytes);

  // The next sample in the order of the stream. Messages without one are counted and passed over.
  // kTruncated: there is no whole message left, feed more, or BeginTick's looks are used up;
  // `sample` is untouched.
  // Cost, all calls of a datagram together: for each byte at most a look at each field of a header,
  // 16 steps of CRC, and for a $ a pass over up to kMaxAsciiBytes; besides, decoding the messages.
  Status Next(InsSample& sample);

  // From now on Next looks at no more than so many beginnings of messages, true or false ones,
  // until the next call; without it there is no limit. What was not looked at waits.
  void BeginTick(int looks) { looks_left_ = looks; }

  // Forgets what has been fed and not told.
  void Reset();

  const StreamCounters& counters() const { return counters_; }

 private:
  Status NextBinary(InsSample& sample);
  Status NextAscii(InsSample& sample);
  Status Count(Status decoded);
  Status PassOver(uint64_t& counter);
  std::span<const uint8_t> Waiting() const {
    return std::span<const uint8_t>(bytes_).subspan(begin_, end_ - begin_);
  }

  uint8_t bytes_[kCapacity] = {};  // [begin_, end_) wait
  // crc_[i]: of the stream up to bytes_[i]; for all begins and ends from begin_ to end_.
  uint16_t crc_[kCapacity + 1] = {};
  int32_t looks_left_ = INT32_MAX;
  size_t begin_ = 0;
  size_t end_ = 0;
  StreamCounters counters_;
};
static_assert(std::is_trivially_copyable_v<StreamParser>);

}  // namespace hardpack::vectornav
