// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// A capture of all interfaces sees a packet on each one that it crosses: a bridge and its port, a
// VLAN and its carrier. This detects packets already seen. A packet that appears again on the same
// interface has been sent again and is not a duplicate.

namespace hardpack::capture {

class DuplicateFilter {
 public:
  static constexpr size_t kRemembered = 512;  // packets
  static constexpr int64_t kMaxApart_ns = 20'000'000;

  // Records a packet. True if another interface has recently shown it more often than this one has
  // so far.
  bool IsDuplicate(std::span<const uint8_t> packet, uint32_t interface_index, int64_t time_ns);

 private:
  struct Seen {
    uint64_t hash = 0;
    uint32_t interface_index = 0;
    int64_t time_ns = INT64_MIN;
  };

  std::array<Seen, kRemembered> seen_ = {};
  size_t next_ = 0;
};

}  // namespace hardpack::capture
