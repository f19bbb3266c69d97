// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

// Counts of non-negative values in bins of equal width. A run stores a quantity this way, so that
// quantiles over hundreds of runs are those of all their values together.

namespace hardpack::experiment {

class Histogram {
 public:
  // Values from `bins` widths on, and NaN, count as infinite.
  explicit Histogram(double width = 0.005, int bins = 400)
      : width_(width), counts_(static_cast<size_t>(bins)) {}

  void Add(double value, int64_t times = 1) {
    count_ += times;
    const double bin = std::fabs(value) / width_;
    if (bin < static_cast<double>(counts_.size())) {
      counts_[static_cast<size_t>(bin)] += times;
    } else {
      beyond_ += times;
    }
  }
  // Precondition: the other histogram has the same width and number of bins.
  void Add(const Histogram& other) {
    for (size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
    beyond_ += other.beyond_;
    count_ += other.count_;
  }

  // The smallest value that `share` of all values do not exceed, to the width of a bin (its upper
  // edge); infinity if it is beyond all bins, NaN if there are no values.
  double Quantile(double share) const {
    if (count_ == 0) return std::nan("");
    const double wanted = share * static_cast<double>(count_);
    int64_t seen = 0;
    for (size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (static_cast<double>(seen) >= wanted && seen > 0) {
        return static_cast<double>(i + 1) * width_;
      }
    }
    return INFINITY;
  }

  int64_t count() const { return count_; }
  int64_t beyond() const { return beyond_; }
  double width() const { return width_; }
  const std::vector<int64_t>& counts() const { return counts_; }
  bool operator==(const Histogram&) const = default;

 private:
  double width_;
  std::vector<int64_t> counts_;
  int64_t beyond_ = 0;
  int64_t count_ = 0;
};

}  // namespace hardpack::experiment
