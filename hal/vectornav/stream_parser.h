// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "hal/vectornav/vectornav.h"

// Finds the messages of a VectorNav sensor in a byte stream that arrives in pieces, as from a
// bridge that puts a serial line into datagrams: messages do not align with them.
// hal/vectornav/vectornav.h decodes the messages; this class decides what is a message:
//
//   A message begins at the first byte from which a complete one with the right checksum follows.
//   If 0xFA or $ is not followed by such a message, only that byte is skipped: a message that
//   begins inside what looked like one is found.
//
// So the result depends on the bytes alone and not on how they are cut. Anything that looks like
// the beginning of a message is waited for: after a false start the next message may be reported up
// to kMaxMessageBytes of stream later than it arrived. The caller must know when a pause is so long
// that the rest of a message cannot arrive any more (Reset).

namespace hardpack::vectornav {

inline constexpr size_t kMaxMessageBytes = kMaxBinaryBytes;
static_assert(kMaxAsciiBytes <= kMaxMessageBytes);

// Since the parser was created; Reset keeps them.
//   samples + unused + not_finite + out_of_range = binary_messages + ascii_messages
struct StreamCounters {
  uint64_t bytes = 0;            // taken by Feed
  uint64_t skipped_bytes = 0;    // not in a message: noise, line ends between messages, truncated
  uint64_t binary_messages = 0;  // complete and with the right checksum
  uint64_t ascii_messages = 0;

  uint64_t samples = 0;       // returned
  uint64_t unused = 0;        // messages without data for an InsSample
  uint64_t not_finite = 0;    // messages refused because a number is not finite,
  uint64_t out_of_range = 0;  // because a value is out of range, or a text is not a number

  // Starts without a message; they occur by chance in noise.
  uint64_t bad_checksum = 0;  // damaged in transit
  uint64_t unsupported = 0;   // 0xFA or $ without a known header or text
};

// Trivially copyable, no pointers; the caller's. About 8 KiB.
//
//   while (!datagram.empty()) {
//     datagram = datagram.subspan(parser.Feed(datagram));
//     while (IsUsable(parser.Next(sample))) Use(sample);
//   }
class StreamParser {
 public:
  // What Feed accepts at least once Next has returned kTruncated: any Ethernet datagram fits at
  // once.
  static constexpr size_t kFeedBytes = 1536;
  // Most bytes that can wait.
  static constexpr size_t kCapacity = kMaxMessageBytes + kFeedBytes;

  // Takes as many bytes from the front as there is room for, and returns their number. Pass the
  // others again after Next has returned kTruncated. Cost: one step per byte taken, and once in
  // kFeedBytes a move of the waiting bytes.
  size_t Feed(std::span<const uint8_t> bytes);

  // The next sample in stream order. Messages without one are counted and skipped. kTruncated:
  // there is no complete message left, feed more, or BeginTick's looks are used up; `sample` is
  // unchanged. Cost, for all calls of a datagram together: for each byte at most a look at each
  // field of a header, 16 steps of CRC, and for a $ a pass over up to kMaxAsciiBytes; plus decoding
  // the messages.
  Status Next(InsSample& sample);

  // Limits the message starts, true or false, that Next examines until the next call; no limit
  // without it. The rest waits.
  void BeginTick(int looks) { looks_left_ = looks; }

  // Drops everything fed and not yet returned.
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
