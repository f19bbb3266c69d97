// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/axes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hardpack::picture {
namespace {

TEST(Ticks, AreRoundAndWithinTheRange) {
  EXPECT_EQ(Ticks({0.0, 10.0}, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(Ticks({-1.2, 1.3}, 5), (std::vector<double>{-1, -0.5, 0, 0.5, 1}));
}

TEST(Ticks, HasNoneWithoutARange) {
  EXPECT_TRUE(Ticks({3.0, 3.0}, 5).empty());
  EXPECT_TRUE(Ticks({0.0, std::nan("")}, 5).empty());
}

TEST(TickText, ShowsAsManyDigitsAsTheStepNeeds) {
  EXPECT_EQ(TickText(2.0, 1.0), "2");
  EXPECT_EQ(TickText(0.5, 0.5), "0.5");
  EXPECT_EQ(TickText(-0.25, 0.05), "-0.25");
  EXPECT_EQ(TickText(-0.0, 0.1), "0.0");
}

TEST(Axes, OfAMapHasOneScale) {
  Canvas canvas(400, 300);
  const Axes axes = Axes::OfMap(canvas, {10.0, 10.0, 300.0, 200.0}, {0.0, 30.0}, {0.0, 10.0});
  EXPECT_DOUBLE_EQ(axes.PixelsPerUnit(), 10.0);
  EXPECT_DOUBLE_EQ(axes.X(1.0) - axes.X(0.0), axes.Y(0.0) - axes.Y(1.0));
}

}  // namespace
}  // namespace hardpack::picture
