// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/safety/reaction_meter.h"

// The recent reaction radius: the meter on board counts from the start of a mission; this extracts
// the columns counted within a recent window.

namespace hardpack::mission {

class ReactionWindow {
 public:
  static constexpr size_t kSamples = 20;  // at 0.05 s: one second

  // Adds the meter's bins, which only grow. Call once per sample.
  void Add(std::span<const uint32_t> bins) {
    counted_.emplace_back(bins.begin(), bins.end());
    if (counted_.size() > kSamples + 1) counted_.pop_front();
  }

  // The smallest upper edge of a bin below which lies at least this share (0 to 1) of the columns
  // counted since the first sample of the window. Beyond the last bin: its edge, 5 m. 0 if none was
  // counted.
  double Radius_m(double share) const {
    if (counted_.empty()) return 0.0;
    const std::vector<uint32_t>& before = counted_.front();
    const std::vector<uint32_t>& now = counted_.back();
    uint64_t all = 0;
    for (size_t i = 0; i < now.size(); ++i) all += now[i] - before[i];
    if (all == 0) return 0.0;
    const auto wanted = static_cast<uint64_t>(std::ceil(share * static_cast<double>(all)));
    uint64_t found = 0;
    size_t bin = 0;
    while (bin < now.size()) {
      found += now[bin] - before[bin];
      ++bin;
      if (found >= wanted) break;
    }
    const size_t edge = std::min(bin, static_cast<size_t>(ReactionMeter::kRadiusBins));
    return static_cast<double>(edge) * static_cast<double>(ReactionMeter::kRadiusBin_m);
  }

 private:
  std::deque<std::vector<uint32_t>> counted_;
};

}  // namespace hardpack::mission
