// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/ipv4_reassembly.h"

#include <algorithm>
#include <cstdlib>

namespace hardpack::capture {

// The slot of the fragment's datagram, a free one, or the oldest one's.
Ipv4Reassembly::Slot& Ipv4Reassembly::SlotFor(const Fragment& fragment) {
  Slot* chosen = nullptr;
  for (Slot& slot : slots_) {
    // The 16-bit identification wraps around: an old one belongs to another datagram.
    if (slot.used && std::abs(fragment.time_ns - slot.first_time_ns) > kMaxAge_ns) {
      slot.used = false;
      ++counters_.incomplete;
    }
    if (slot.used && slot.key == fragment.key) return slot;
    const bool better = chosen == nullptr || (chosen->used && !slot.used) ||
                        (chosen->used && slot.first_time_ns < chosen->first_time_ns);
    if (better) chosen = &slot;
  }
  if (chosen->used) ++counters_.incomplete;
  chosen->used = true;
  chosen->key = fragment.key;
  chosen->first_time_ns = fragment.time_ns;
  chosen->total_bytes = 0;
  chosen->end_bytes = 0;
  chosen->filled_bytes = 0;
  chosen->bytes.resize(kMaxBytes);
  chosen->filled.assign(kMaxBytes, 0);
  return *chosen;
}

// False if the fragment contradicts the contents of the slot.
bool Ipv4Reassembly::Place(const Fragment& fragment, Slot& slot) {
  const size_t end = fragment.offset + fragment.bytes.size();
  if (!fragment.more) {
    if (slot.total_bytes != 0 && slot.total_bytes != end) return false;
    slot.total_bytes = end;
  }
  slot.end_bytes = std::max(slot.end_bytes, end);
  if (slot.total_bytes != 0 && slot.end_bytes > slot.total_bytes) return false;
  for (size_t i = 0; i < fragment.bytes.size(); ++i) {
    const size_t at = fragment.offset + i;
    if (slot.filled[at] != 0 && slot.bytes[at] != fragment.bytes[i]) return false;
    slot.filled_bytes += slot.filled[at] == 0 ? 1 : 0;
    slot.filled[at] = 1;
    slot.bytes[at] = fragment.bytes[i];
  }
  return true;
}

std::span<const uint8_t> Ipv4Reassembly::Add(const Fragment& fragment) {
  ++counters_.fragments;
  const size_t size = fragment.bytes.size();
  const bool possible = size > 0 && fragment.offset % 8 == 0 && (!fragment.more || size % 8 == 0) &&
                        fragment.offset < kMaxBytes && size <= kMaxBytes - fragment.offset;
  if (!possible) {
    ++counters_.conflicts;
    return {};
  }
  Slot& slot = SlotFor(fragment);
  if (!Place(fragment, slot)) {
    slot.used = false;
    ++counters_.conflicts;
    return {};
  }
  if (slot.total_bytes == 0 || slot.filled_bytes != slot.total_bytes) return {};
  slot.used = false;
  ++counters_.completed;
  return {slot.bytes.data(), slot.total_bytes};
}

void Ipv4Reassembly::Finish() {
  for (Slot& slot : slots_) {
    if (slot.used) ++counters_.incomplete;
    slot.used = false;
  }
}

}  // namespace hardpack::capture
