// SPDX-License-Identifier: Apache-2.0
#include "core/base/grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <ostream>
#include <random>

#include "gtest/gtest.h"
#include "test/core/base/broken_assumption.h"
#include "test/not_finite.h"

namespace hardpack {

void PrintTo(const Cell& cell, std::ostream* out) {
  *out << '(' << cell.x << ", " << cell.y << ')';
}

namespace {

using testing::kInfinity;
using testing::kNaN;

//   y
//   0.4 +------+------+
//       | 0,1  | 1,1  |
//   0.2 +------+------+
//       | 0,0  | 1,0  |
//   0   +------+------+
//       0     0.2    0.4  x
TEST(CellAt, TakesTheLowerBorderToTheCell) {
  EXPECT_EQ(CellAt({0.0f, 0.0f}), (Cell{0, 0}));
  EXPECT_EQ(CellAt({0.19f, 0.39f}), (Cell{0, 1}));
  EXPECT_EQ(CellAt({0.2f, 0.4f}), (Cell{1, 2}));
  EXPECT_EQ(CellAt({-0.001f, -0.2f}), (Cell{-1, -1}));
  EXPECT_EQ(CellAt({-0.21f, 51.1f}), (Cell{-2, 255}));
}

TEST(CellAt, SaturatesAndTakesNanAsZero) {
  EXPECT_EQ(CellAt({1.0e20f, -1.0e20f}), (Cell{INT32_MAX, INT32_MIN}));
  EXPECT_EQ(CellAt({kInfinity, -kInfinity}), (Cell{INT32_MAX, INT32_MIN}));
  EXPECT_EQ(CellAt({kNaN, 1.0f}), (Cell{0, 5}));
}

TEST(CellAt, OfACellsCenterIsTheCell) {
  for (int32_t x = -3000; x <= 3000; ++x) {
    ASSERT_EQ(CellAt(CellCenter({x, -x})), (Cell{x, -x}));
  }
  constexpr uint32_t kSeed = 31;
  std::mt19937 random(kSeed);
  constexpr int32_t kFar = 1 << 22;
  std::uniform_int_distribution<int32_t> number(-kFar, kFar - 1);
  for (int i = 0; i < 500000; ++i) {
    const Cell cell = {number(random), number(random)};
    ASSERT_EQ(CellAt(CellCenter(cell)), cell) << "seed " << kSeed;
  }
  EXPECT_EQ(CellAt(CellCenter({-kFar, kFar - 1})), (Cell{-kFar, kFar - 1}));
}

TEST(CellCenter, LiesHalfACellFromItsBorders) {
  EXPECT_FLOAT_EQ(CellCenter({0, 0}).x_m, 0.1f);
  EXPECT_FLOAT_EQ(CellCenter({0, -1}).y_m, -0.1f);
  EXPECT_FLOAT_EQ(CellCenter({255, 0}).x_m, 51.1f);
}

TEST(GridWindow, HoldsItsCellsAndNoOthers) {
  const GridWindow window{{-100, 20}};
  EXPECT_TRUE(window.Contains({-100, 20}));
  EXPECT_TRUE(window.Contains({411, 531}));
  EXPECT_FALSE(window.Contains({-101, 20}));
  EXPECT_FALSE(window.Contains({-100, 19}));
  EXPECT_FALSE(window.Contains({412, 531}));
  EXPECT_FALSE(window.Contains({411, 532}));
}

TEST(GridWindow, NumbersItsCellsAlongX) {
  const GridWindow window{{-100, 20}};
  EXPECT_EQ(window.Index({-100, 20}), 0);
  EXPECT_EQ(window.Index({-99, 20}), 1);
  EXPECT_EQ(window.Index({-100, 21}), kMapSize_cells);
  EXPECT_EQ(window.Index({411, 531}), kMapCells - 1);
  for (int index = 0; index < kMapCells; ++index) {
    ASSERT_EQ(window.Index(window.FromIndex(index)), index);
  }
}

TEST(GridWindow, IsAssertedToHoldWhatIsNumbered) {
  const GridWindow window{{0, 0}};
  int seen = 0;
  EXPECT_NE(BrokenAssumption([&] { seen = window.Index({512, 0}); }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { seen = window.Index({0, -1}); }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { seen = window.FromIndex(-1).x; }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { seen = window.FromIndex(kMapCells).x; }).expression(), "");
  EXPECT_EQ(seen, 0);
}

// The differences of coordinates are up to 2^32 there.
TEST(GridWindow, IsRightAtTheEndsOfTheIntegers) {
  const GridWindow low{{INT32_MIN, INT32_MIN}};
  const GridWindow high{{INT32_MAX - 511, INT32_MAX - 511}};
  EXPECT_TRUE(low.Contains({INT32_MIN, INT32_MIN + 511}));
  EXPECT_FALSE(low.Contains({INT32_MIN, INT32_MAX}));
  EXPECT_FALSE(low.Contains({INT32_MIN + 512, INT32_MIN}));
  EXPECT_TRUE(high.Contains({INT32_MAX, INT32_MAX - 511}));
  EXPECT_FALSE(high.Contains({INT32_MIN, INT32_MAX}));
  EXPECT_EQ(high.Index({INT32_MAX, INT32_MAX}), kMapCells - 1);
  EXPECT_EQ(high.FromIndex(kMapCells - 1), (Cell{INT32_MAX, INT32_MAX}));
  EXPECT_EQ(low.Nearest({INT32_MAX, INT32_MIN}), (Cell{INT32_MIN + 511, INT32_MIN}));
  EXPECT_EQ(high.Nearest({INT32_MIN, INT32_MAX}), (Cell{INT32_MAX - 511, INT32_MAX}));
}

TEST(GridWindow, NearestIsTheCellItselfOrOnTheBorder) {
  const GridWindow window{{-100, 20}};
  EXPECT_EQ(window.Nearest({0, 100}), (Cell{0, 100}));
  EXPECT_EQ(window.Nearest({-300, 100}), (Cell{-100, 100}));
  EXPECT_EQ(window.Nearest({1000, 1000}), (Cell{411, 531}));
}

TEST(GridWindow, NearestIsNearest) {
  constexpr uint32_t kSeed = 32;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int32_t> number(-2000, 2000);
  const GridWindow window{{-256, -256}};
  for (int i = 0; i < 40; ++i) {
    const Cell cell = {number(random), number(random)};
    const auto distance2 = [&](Cell other) {
      const int64_t dx = other.x - cell.x;
      const int64_t dy = other.y - cell.y;
      return dx * dx + dy * dy;
    };
    int64_t least = INT64_MAX;
    for (int index = 0; index < kMapCells; ++index) {
      least = std::min(least, distance2(window.FromIndex(index)));
    }
    ASSERT_TRUE(window.Contains(window.Nearest(cell)));
    ASSERT_EQ(distance2(window.Nearest(cell)), least) << "seed " << kSeed;
  }
}

TEST(GridWindow, CentersAtAPoint) {
  const GridWindow window = GridWindow::CenteredAt({10.05f, -3.0f});
  EXPECT_EQ(window.origin, (Cell{50 - 256, -15 - 256}));
}

TEST(GridWindow, CenteredFarAwayIsStillAWindowOfIntegers) {
  for (const float far : {4.0e8f, 1.0e9f, 1.0e30f, kInfinity}) {
    const GridWindow window = GridWindow::CenteredAt({far, -far});
    EXPECT_LE(window.origin.x, INT32_MAX - 511) << far;
    EXPECT_TRUE(window.Contains(window.FromIndex(0))) << far;
    EXPECT_TRUE(window.Contains(window.FromIndex(kMapCells - 1))) << far;
  }
  EXPECT_EQ(GridWindow::CenteredAt({kNaN, kNaN}).origin, (Cell{-256, -256}));
}

}  // namespace
}  // namespace hardpack
