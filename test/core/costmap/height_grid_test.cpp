// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/height_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "test/core/costmap/stored_row.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

std::unique_ptr<HeightGrid> MakeGrid() {
  return std::make_unique<HeightGrid>();
}

void ExpectSame(const HeightGrid::CellHeights& actual, const HeightGrid::CellHeights& expected) {
  EXPECT_EQ(actual.lowest_cm, expected.lowest_cm);
  EXPECT_EQ(actual.lowest_hard_cm, expected.lowest_hard_cm);
  EXPECT_EQ(actual.highest_hard_cm, expected.highest_hard_cm);
  EXPECT_EQ(actual.highest_soft_cm, expected.highest_soft_cm);
  EXPECT_EQ(actual.ground, expected.ground);
  EXPECT_EQ(actual.person, expected.person);
}

TEST(HeightGrid, IsEmptyAtFirst) {
  const auto grid = MakeGrid();
  EXPECT_EQ(grid->window(), GridWindow::CenteredAt({0.0f, 0.0f}));
  for (int index = 0; index < kMapCells; ++index) {
    ExpectSame(grid->At(grid->window().FromIndex(index)), {});
  }
}

TEST(HeightGrid, KeepsTheExtremesOfEachClass) {
  const auto grid = MakeGrid();
  const float x_m = 1.05f;
  const float y_m = -2.1f;
  ASSERT_EQ(grid->Insert({x_m, y_m, 0.30f}, ReturnClass::kHard), Status::kOk);
  ASSERT_EQ(grid->Insert({x_m, y_m, -0.20f}, ReturnClass::kGround), Status::kOk);
  ASSERT_EQ(grid->Insert({x_m, y_m, 0.70f}, ReturnClass::kSoft), Status::kOk);
  ASSERT_EQ(grid->Insert({x_m, y_m, -0.10f}, ReturnClass::kSoft), Status::kOk);
  ASSERT_EQ(grid->Insert({x_m, y_m, 1.25f}, ReturnClass::kHard), Status::kOk);
  HeightGrid::CellHeights expected;
  expected.lowest_cm = -20;
  expected.lowest_hard_cm = 30;
  expected.highest_hard_cm = 125;
  expected.highest_soft_cm = 70;
  expected.ground = true;
  ExpectSame(grid->At(CellAt({x_m, y_m})), expected);
  ExpectSame(grid->At(CellAt({x_m + kCellSize_m, y_m})), {});
}

TEST(HeightGrid, CountsAPersonAsHard) {
  const auto grid = MakeGrid();
  ASSERT_EQ(grid->Insert({0.1f, 0.1f, 0.4f}, ReturnClass::kPerson), Status::kOk);
  HeightGrid::CellHeights expected;
  expected.lowest_cm = 40;
  expected.lowest_hard_cm = 40;
  expected.highest_hard_cm = 40;
  expected.person = true;
  ExpectSame(grid->At({0, 0}), expected);
}

TEST(HeightGrid, RoundsAndSaturatesHeights) {
  const struct {
    float z_m;
    int expected_cm;
  } cases[] = {{0.004f, 0},      {0.006f, 1},       {-0.006f, -1},      {199.99f, 19999},
               {200.01f, 20000}, {5000.0f, 20000},  {-200.01f, -20000}, {-9.0e9f, -20000},
               {3.4e38f, 20000}, {-3.4e38f, -20000}};
  for (const auto& item : cases) {
    const auto grid = MakeGrid();
    ASSERT_EQ(grid->Insert({0.1f, 0.1f, item.z_m}, ReturnClass::kHard), Status::kOk);
    EXPECT_EQ(grid->At({0, 0}).highest_hard_cm, item.expected_cm) << item.z_m;
    EXPECT_EQ(grid->At({0, 0}).lowest_cm, item.expected_cm) << item.z_m;
  }
}

TEST(HeightGrid, FilesNothingOfBadReturns) {
  const auto grid = MakeGrid();
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(grid->Insert({bad, 0.1f, 0.1f}, ReturnClass::kHard), Status::kNotFinite);
    EXPECT_EQ(grid->Insert({0.1f, bad, 0.1f}, ReturnClass::kHard), Status::kNotFinite);
    EXPECT_EQ(grid->Insert({0.1f, 0.1f, bad}, ReturnClass::kHard), Status::kNotFinite);
    EXPECT_EQ(grid->Insert({bad, bad, bad}, ReturnClass::kIgnored), Status::kOk);
  }
  EXPECT_EQ(grid->Insert({0.1f, 0.1f, 9.0f}, ReturnClass::kIgnored), Status::kOk);
  EXPECT_EQ(grid->Insert({0.1f, 0.1f, 9.0f}, static_cast<ReturnClass>(5)),
            Status::kInvalidArgument);
  EXPECT_EQ(grid->Insert({51.21f, 0.1f, 1.0f}, ReturnClass::kHard), Status::kInvalidArgument);
  EXPECT_EQ(grid->Insert({-51.21f, 0.1f, 1.0f}, ReturnClass::kHard), Status::kInvalidArgument);
  EXPECT_EQ(grid->Insert({3.0e38f, -3.0e38f, 1.0f}, ReturnClass::kHard), Status::kInvalidArgument);
  for (int index = 0; index < kMapCells; ++index) {
    ExpectSame(grid->At(grid->window().FromIndex(index)), {});
  }
}

TEST(HeightGrid, StaysWhereItIsWhenTheCenterIsNotFinite) {
  const auto grid = MakeGrid();
  ASSERT_EQ(grid->Insert({0.1f, 0.1f, 1.0f}, ReturnClass::kHard), Status::kOk);
  const GridWindow before = grid->window();
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(grid->Recenter({bad, 0.0f}), Status::kNotFinite);
    EXPECT_EQ(grid->Recenter({0.0f, bad}), Status::kNotFinite);
    EXPECT_EQ(grid->Reset({bad, 0.0f}), Status::kNotFinite);
    EXPECT_EQ(grid->Reset({0.0f, bad}), Status::kNotFinite);
  }
  EXPECT_EQ(grid->window(), before);
  EXPECT_EQ(grid->At({0, 0}).highest_hard_cm, 100);
}

TEST(HeightGrid, ResetEmptiesIt) {
  const auto grid = MakeGrid();
  ASSERT_EQ(grid->Insert({0.1f, 0.1f, 1.0f}, ReturnClass::kHard), Status::kOk);
  ASSERT_EQ(grid->Reset({0.0f, 0.0f}), Status::kOk);
  ExpectSame(grid->At({0, 0}), {});
}

// A window moved by one cell to the right loses its first column and gains one behind the last:
//
//   before   a b c d          after    b c d .     (a's storage is the new column's)
TEST(HeightGrid, ForgetsWhatRollsOut) {
  const auto grid = MakeGrid();
  const Cell origin = grid->window().origin;
  for (int column = 0; column < kMapSize_cells; ++column) {
    const Vec2 center = CellCenter({origin.x + column, 0});
    ASSERT_EQ(grid->Insert({center.x_m, center.y_m, 1.0f}, ReturnClass::kHard), Status::kOk);
  }
  ASSERT_EQ(grid->Recenter({kCellSize_m * 1.5f, 0.1f}), Status::kOk);
  ASSERT_EQ(grid->window().origin.x, origin.x + 1);
  ExpectSame(grid->At({origin.x, 0}), {});
  ExpectSame(grid->At({origin.x + kMapSize_cells, 0}), {});
  EXPECT_EQ(grid->At({origin.x + 1, 0}).highest_hard_cm, 100);
  EXPECT_EQ(grid->At({origin.x + kMapSize_cells - 1, 0}).highest_hard_cm, 100);
}

TEST(HeightGrid, RollsAnywhereWithoutOverflow) {
  const auto grid = MakeGrid();
  const float far_away[] = {0.0f, 1.0e9f, -1.0e9f, 3.0e38f, -3.0e38f, 4.29e8f, -4.29e8f, 50.0f};
  for (const float x_m : far_away) {
    for (const float y_m : far_away) {
      ASSERT_EQ(grid->Recenter({x_m, y_m}), Status::kOk);
      const GridWindow window = grid->window();
      EXPECT_EQ(window, GridWindow::CenteredAt({x_m, y_m}));
      ExpectSame(grid->At(window.FromIndex(0)), {});
      ExpectSame(grid->At(window.FromIndex(kMapCells - 1)), {});
      ExpectSame(StoredRow(*grid, window.origin).At(0), {});
      (void)grid->Insert({x_m, y_m, 1.0f}, ReturnClass::kHard);  // may be off a saturated window
    }
  }
}

TEST(HeightGrid, ReadsRowsAsSingleCells) {
  const auto grid = MakeGrid();
  ASSERT_EQ(grid->Recenter({13.7f, -8.1f}), Status::kOk);
  const Cell origin = grid->window().origin;
  std::mt19937 random(7);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < kMapSize_cells; ++column) {
      const Vec2 center = CellCenter({origin.x + column, origin.y + row});
      const auto kind = static_cast<ReturnClass>(random() % 5);
      const float z_m = static_cast<float>(random() % 300) * 0.01f;
      ASSERT_EQ(grid->Insert({center.x_m, center.y_m, z_m}, kind), Status::kOk);
    }
  }
  // Rows below, in and above what was filed; and rows that begin before and behind the window's.
  for (int row = -1; row < 4; ++row) {
    for (int column = -kMapSize_cells - 7; column <= kMapSize_cells; column += 37) {
      const Cell first = {origin.x + column, origin.y + row};
      const StoredRow stored(*grid, first);
      for (int x = 0; x < kMapSize_cells; ++x) {
        ExpectSame(stored.At(x), grid->At({first.x + x, first.y}));
      }
    }
  }
}

// The same as the grid, but slow and plain: every cell of the plane that was filed into.
class PlaneOfHeights {
 public:
  void Insert(Cell cell, int16_t height_cm, ReturnClass kind) {
    HeightGrid::CellHeights& heights = cells_[{cell.x, cell.y}];
    const bool hard = kind == ReturnClass::kHard || kind == ReturnClass::kPerson;
    Keep(heights.lowest_cm, height_cm, true, [](int a, int b) { return a < b; });
    Keep(heights.lowest_hard_cm, height_cm, hard, [](int a, int b) { return a < b; });
    Keep(heights.highest_hard_cm, height_cm, hard, [](int a, int b) { return a > b; });
    Keep(heights.highest_soft_cm, height_cm, kind == ReturnClass::kSoft,
         [](int a, int b) { return a > b; });
    heights.ground = heights.ground || kind == ReturnClass::kGround;
    heights.person = heights.person || kind == ReturnClass::kPerson;
  }
  void DropOutside(const GridWindow& window) {
    std::erase_if(cells_, [&](const auto& entry) {
      return !window.Contains({entry.first.first, entry.first.second});
    });
  }
  HeightGrid::CellHeights At(Cell cell) const {
    const auto found = cells_.find({cell.x, cell.y});
    return found == cells_.end() ? HeightGrid::CellHeights{} : found->second;
  }

 private:
  template <typename Better>
  static void Keep(int16_t& kept_cm, int16_t height_cm, bool counts, Better better) {
    if (counts && (kept_cm == HeightGrid::kNone || better(height_cm, kept_cm))) {
      kept_cm = height_cm;
    }
  }
  std::map<std::pair<int32_t, int32_t>, HeightGrid::CellHeights> cells_;
};

TEST(HeightGrid, EqualsAPlainMapUnderAnyMoves) {
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> share(0.0f, 1.0f);
    const auto grid = MakeGrid();
    PlaneOfHeights plane;
    Vec2 center = {1000.0f * share(random) - 500.0f, 1000.0f * share(random) - 500.0f};
    ASSERT_EQ(grid->Reset(center), Status::kOk);
    for (int move = 0; move < 60; ++move) {
      for (int i = 0; i < 100; ++i) {
        const Cell origin = grid->window().origin;
        const Cell cell = {origin.x + static_cast<int>(random() % kMapSize_cells),
                           origin.y + static_cast<int>(random() % kMapSize_cells)};
        const auto kind = static_cast<ReturnClass>(1 + random() % 4);
        const int16_t height_cm = static_cast<int16_t>(static_cast<int>(random() % 800) - 400);
        const Vec2 point = CellCenter(cell);
        ASSERT_EQ(grid->Insert({point.x_m, point.y_m, 0.01f * static_cast<float>(height_cm)}, kind),
                  Status::kOk);
        plane.Insert(cell, height_cm, kind);
      }
      // Small steps mostly, at times one of about a window's length or far beyond.
      const float reach_m = move % 10 == 9 ? 400.0f : move % 10 == 4 ? 110.0f : 8.0f;
      center.x_m += reach_m * (share(random) - 0.5f);
      center.y_m += reach_m * (share(random) - 0.5f);
      ASSERT_EQ(grid->Recenter(center), Status::kOk);
      ASSERT_EQ(grid->window(), GridWindow::CenteredAt(center));
      plane.DropOutside(grid->window());
      for (int i = 0; i < 2000; ++i) {
        const Cell cell =
            grid->window().FromIndex(static_cast<int>(random() % static_cast<uint32_t>(kMapCells)));
        ExpectSame(grid->At(cell), plane.At(cell));
      }
    }
    for (int index = 0; index < kMapCells; ++index) {
      const Cell cell = grid->window().FromIndex(index);
      ExpectSame(grid->At(cell), plane.At(cell));
    }
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace hardpack
