// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/duplicate_filter.h"

namespace hardpack::capture {
namespace {

// FNV-1a. Packets differ in more than 64 bits can hide: two different ones of 20 ms that agree here
// are not met in years.
uint64_t HashOf(std::span<const uint8_t> bytes) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const uint8_t byte : bytes) hash = (hash ^ byte) * 0x00000100000001b3u;
  return hash;
}

}  // namespace

bool DuplicateFilter::IsDuplicate(std::span<const uint8_t> packet, uint32_t interface_index,
                                  int64_t time_ns) {
  const uint64_t hash = HashOf(packet);
  const auto is_copy = [&](const Seen& seen) {
    if (seen.hash != hash || seen.time_ns == INT64_MIN) return false;
    const int64_t apart_ns =
        time_ns > seen.time_ns ? time_ns - seen.time_ns : seen.time_ns - time_ns;
    return apart_ns <= kMaxApart_ns;
  };
  const auto count = [&](uint32_t index) {
    int times = 0;
    for (const Seen& seen : seen_) {
      times += is_copy(seen) && seen.interface_index == index ? 1 : 0;
    }
    return times;
  };
  const int here = count(interface_index);
  bool duplicate = false;
  for (const Seen& seen : seen_) {
    const bool elsewhere = is_copy(seen) && seen.interface_index != interface_index;
    duplicate = duplicate || (elsewhere && count(seen.interface_index) > here);
  }
  seen_[next_] = {hash, interface_index, time_ns};
  next_ = (next_ + 1) % kRemembered;
  return duplicate;
}

}  // namespace hardpack::capture
