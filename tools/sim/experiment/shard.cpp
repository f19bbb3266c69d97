// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/shard.h"

#include <charconv>

namespace hardpack::experiment {

ReadOutcome ParseShard(const std::string& text, Shard& shard) {
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, shard.number);
  if (number.ec == std::errc() && number.ptr != end && *number.ptr == '/') {
    const auto count = std::from_chars(number.ptr + 1, end, shard.count);
    if (count.ec == std::errc() && count.ptr == end && shard.count >= 1 && shard.count <= 100000 &&
        shard.number >= 1 && shard.number <= shard.count) {
      return {};
    }
  }
  return {Status::kInvalidArgument, "'" + text + "' is not a shard: K/N with K from 1 to N"};
}

}  // namespace hardpack::experiment
