// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace hardpack::experiment {
namespace {

TEST(Histogram, GivesQuantilesToTheWidthOfABin) {
  std::mt19937 random(7);
  std::exponential_distribution<double> lengths(5.0);
  Histogram histogram(0.005, 1000);
  std::vector<double> values;
  for (int i = 0; i < 20000; ++i) {
    values.push_back(lengths(random));
    histogram.Add(i % 2 == 0 ? values.back() : -values.back());  // its magnitude counts
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.01, 0.5, 0.95, 0.99, 1.0}) {
    const auto index = static_cast<size_t>(std::ceil(share * 20000.0)) - 1;
    EXPECT_NEAR(histogram.Quantile(share), values[index], 0.005) << share;
    EXPECT_GE(histogram.Quantile(share), values[index]) << share;
  }
}

TEST(Histogram, CountsWhatIsBeyondAndNanAsInfinite) {
  Histogram histogram(0.1, 10);
  histogram.Add(0.05, 96);
  histogram.Add(1.0);
  histogram.Add(1e300);
  histogram.Add(std::nan(""), 2);
  EXPECT_EQ(histogram.count(), 100);
  EXPECT_EQ(histogram.beyond(), 4);
  EXPECT_DOUBLE_EQ(histogram.Quantile(0.96), 0.1);
  EXPECT_TRUE(std::isinf(histogram.Quantile(0.97)));
}

TEST(Histogram, IsOfAllValuesOfThoseAddedToIt) {
  Histogram one(0.1, 10);
  Histogram other(0.1, 10);
  one.Add(0.01, 50);
  other.Add(0.51, 50);
  other.Add(5.0);
  one.Add(other);
  EXPECT_EQ(one.count(), 101);
  EXPECT_DOUBLE_EQ(one.Quantile(0.49), 0.1);
  EXPECT_DOUBLE_EQ(one.Quantile(0.5), 0.6);
  EXPECT_EQ(one.beyond(), 1);
}

TEST(Histogram, HasNoQuantileWithoutAValue) {
  EXPECT_TRUE(std::isnan(Histogram().Quantile(0.5)));
}

}  // namespace
}  // namespace hardpack::experiment
