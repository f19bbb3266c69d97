// SPDX-License-Identifier: Apache-2.0
// Any bytes as a stream of pose datagrams, in pieces. The first byte says how long the pieces are,
// and whether each CRC is put right. Required: what is told is finite and possible, and is encoded
// to a datagram that says the same; of the same bytes in one piece as much is told; the counters
// add up.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/base/crc32.h"
#include "hal/pose_datagram/pose_datagram.h"
#include "test/fuzz/accepted.h"

using namespace hardpack;
using namespace hardpack::pose_datagram;

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

// No fuzzer guesses a checksum.
void FixCrcs(std::vector<uint8_t>& bytes) {
  for (size_t at = 0; at + kDatagram_bytes <= bytes.size();) {
    const bool begins =
        bytes[at] == 'H' && bytes[at + 1] == 'P' && bytes[at + 2] == 'P' && bytes[at + 3] == 'D';
    if (!begins) {
      ++at;
      continue;
    }
    const uint32_t crc = Crc32<112>(std::span<const uint8_t>(bytes).subspan(at, 112));
    for (size_t i = 0; i < 4; ++i) bytes[at + 112 + i] = static_cast<uint8_t>(crc >> (8 * i));
    at += kDatagram_bytes;
  }
}

void RequireSound(const InsSample& sample) {
  Require(std::isfinite(sample.yaw_rad) && std::abs(sample.yaw_rad) < 3.2f);
  std::array<uint8_t, kDatagram_bytes> bytes = {};
  Require(IsUsable(Encode(sample, 1, bytes)));
  uint32_t sequence = 0;
  InsSample again;
  Require(IsUsable(Decode(bytes, sequence, again)) && sequence == 1);
  std::array<uint8_t, kDatagram_bytes> twice = {};
  Require(IsUsable(Encode(again, 1, twice)) && twice == bytes);
}

uint64_t Told(const std::vector<uint8_t>& bytes, size_t piece) {
  const auto receiver = std::make_unique<Receiver>();
  InsSample sample;
  for (size_t at = 0; at < bytes.size(); at += piece) {
    std::span<const uint8_t> rest =
        std::span(bytes).subspan(at, std::min(piece, bytes.size() - at));
    while (!rest.empty()) {
      rest = rest.subspan(receiver->Feed(rest));
      while (IsUsable(receiver->Next(sample))) RequireSound(sample);
    }
  }
  const Counters& counters = receiver->counters();
  const uint64_t datagrams = counters.samples + counters.refused + counters.repeated;
  const uint64_t known = counters.skipped_bytes + datagrams * kDatagram_bytes;
  Require(counters.bytes == bytes.size() && known <= counters.bytes &&
          counters.bytes - known < kDatagram_bytes);
  return counters.samples;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  std::vector<uint8_t> bytes(data + 1, data + size);
  if (data[0] % 2 == 0) FixCrcs(bytes);
  const uint64_t told = Told(bytes, 1 + data[0] / 2u);
  Require(told == Told(bytes, bytes.size() + 1));
  if (told > 0) Accepted("samples");
  return 0;
}
