// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/stream_parser.h"

#include "core/base/loop_bound.h"
#include "hal/vectornav/crc16.h"

namespace hardpack::vectornav {

size_t StreamParser::Feed(std::span<const uint8_t> bytes) {
  if (bytes.size() > kCapacity - end_ && begin_ != 0) {
    HP_LOOP_BOUND(kCapacity)
    for (size_t i = begin_; i < end_; ++i) {
      bytes_[i - begin_] = bytes_[i];
      crc_[i - begin_] = crc_[i];
    }
    crc_[end_ - begin_] = crc_[end_];
    end_ -= begin_;
    begin_ = 0;
  }
  const size_t room = kCapacity - end_;
  const std::span<const uint8_t> taken = bytes.size() < room ? bytes : bytes.first(room);
  HP_LOOP_BOUND(kCapacity)
  for (const uint8_t byte : taken) {
    bytes_[end_] = byte;
    crc_[end_ + 1] = Crc16Step(crc_[end_], byte);
    ++end_;
  }
  counters_.bytes += taken.size();
  return taken.size();
}

// Not inlined, as the two below: their calls are counted (config/timing.toml).
[[gnu::noinline]] Status StreamParser::Next(InsSample& sample) {
  HP_LOOP_BOUND(kCapacity)
  while (begin_ < end_) {
    const uint8_t first = bytes_[begin_];
    if (first != kBinarySync && first != kAsciiStart) {
      ++begin_;
      ++counters_.skipped_bytes;
      continue;
    }
    if (looks_left_ == 0) break;
    --looks_left_;
    const Status found = first == kBinarySync ? NextBinary(sample) : NextAscii(sample);
    if (IsUsable(found) || found == Status::kTruncated) return found;
  }
  return Status::kTruncated;
}

void StreamParser::Reset() {
  counters_.skipped_bytes += end_ - begin_;
  begin_ = 0;
  end_ = 0;
  crc_[0] = 0;
}

// The message that 0xFA at begin_ may begin. kTruncated: it is not whole; all else leads on by at
// least a byte.
[[gnu::noinline]] Status StreamParser::NextBinary(InsSample& sample) {
  size_t size = 0;
  const Status sized = BinaryMessageSize(Waiting(), size);
  if (sized == Status::kTruncated) return sized;
  if (!IsUsable(sized)) return PassOver(counters_.unsupported);
  if (size > end_ - begin_) return Status::kTruncated;
  if (Crc16Between(crc_[begin_ + 1], crc_[begin_ + size], size - 1) != 0) {
    return PassOver(counters_.bad_checksum);
  }
  ++counters_.binary_messages;
  const Status decoded = DecodeCheckedBinary(Waiting().first(size), sample);
  begin_ += size;
  return Count(decoded);
}

// The same of $.
[[gnu::noinline]] Status StreamParser::NextAscii(InsSample& sample) {
  size_t size = 0;
  const Status sized = AsciiMessageSize(Waiting(), size);
  if (sized == Status::kTruncated) return sized;
  if (!IsUsable(sized)) return PassOver(counters_.unsupported);
  const Status decoded = DecodeAscii(Waiting().first(size), sample);
  if (decoded == Status::kBadCrc) return PassOver(counters_.bad_checksum);
  ++counters_.ascii_messages;
  begin_ += size;
  return Count(decoded);
}

Status StreamParser::Count(Status decoded) {
  if (IsUsable(decoded)) {
    ++counters_.samples;
  } else if (decoded == Status::kWrongPacketType) {
    ++counters_.unused;
  } else if (decoded == Status::kNotFinite) {
    ++counters_.not_finite;
  } else {
    ++counters_.out_of_range;
  }
  return decoded;
}

Status StreamParser::PassOver(uint64_t& counter) {
  ++counter;
  ++begin_;
  ++counters_.skipped_bytes;
  return Status::kUnsupported;
}

}  // namespace hardpack::vectornav
