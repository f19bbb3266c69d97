// SPDX-License-Identifier: Apache-2.0
#include "core/areas/area_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "test/core/areas/polygon.h"
#include "test/core/base/rounds.h"

// Areas against cells and outlines, compared with double arithmetic.

namespace hardpack {
namespace {

using testing::AreaOf;
using testing::Box;
using testing::Place;
using testing::RelationOf;

constexpr double kCell = 0.2;
constexpr GridWindow kMiddle = {{-256, -256}};

std::vector<Place> CellBox(const GridWindow& window, int column, int row, double wider = 0.0) {
  const double x = kCell * (window.origin.x + column);
  const double y = kCell * (window.origin.y + row);
  return Box(x - wider, y - wider, x + kCell + wider, y + kCell + wider);
}

// The cell must be closed if its square touches the area (or is not inside the fence), and must not
// be if that is also false of a square that is larger by `tolerance`.
void ExpectRow(const Area& area, const GridWindow& window, int row, double tolerance) {
  const std::vector<Place> corners = testing::CornersOf(area);
  const RowRange rows = RowsOf(area, window);
  const bool in_rows = row >= rows.first && row <= rows.last;
  const RowCells cells = in_rows ? ClosedCells(area, window, row) : RowCells{};
  const bool is_fence = area.kind == AreaKind::kFence;
  for (int column = 0; column < kMapSize_cells; ++column) {
    const auto relation = RelationOf(corners, CellBox(window, column, row));
    const bool touches = relation.border_m <= 0.0 || relation.holds || relation.is_inside;
    const bool inside = relation.border_m > 0.0 && relation.holds;
    const bool must_close = is_fence ? !inside : touches;
    if (must_close) {
      ASSERT_TRUE(cells.Has(column)) << column << ", " << row;
    } else if (relation.border_m > tolerance) {
      ASSERT_FALSE(cells.Has(column)) << column << ", " << row;
    }
  }
}

int Closed(const Area& area, const GridWindow& window) {
  int closed = 0;
  const RowRange rows = RowsOf(area, window);
  for (int row = rows.first; row <= rows.last; ++row) {
    const RowCells cells = ClosedCells(area, window, row);
    for (int column = 0; column < kMapSize_cells; ++column) closed += cells.Has(column) ? 1 : 0;
  }
  return closed;
}

// SR-ARE02
TEST(AreaShape, EveryCellThatAKeepOutAreaTouchesIsClosed) {
  // A concave polygon, with edges through cells, along their borders, and a narrow spike.
  const Area area = AreaOf(
      AreaKind::kKeepOut,
      {{0.0, 0.0}, {4.05, 0.0}, {4.05, 3.0}, {2.0, 0.55}, {1.0, 9.0}, {0.99, 0.55}, {-1.3, 3.7}});
  ASSERT_EQ(CheckArea(area), Status::kOk);
  for (int row = 0; row < kMapSize_cells; ++row) ExpectRow(area, kMiddle, row, 0.001);
}

TEST(AreaShape, EdgesOnCellBordersCloseTheCellsOnBothSides) {
  const Area area = AreaOf(AreaKind::kKeepOut, Box(1.0, 1.0, 2.0, 2.0));
  EXPECT_EQ(Closed(area, kMiddle), 7 * 7);
  const Area within = AreaOf(AreaKind::kKeepOut, Box(1.01, 1.01, 1.99, 1.99));
  EXPECT_EQ(Closed(within, kMiddle), 5 * 5);
}

TEST(AreaShape, OfAFenceAllCellsButThoseEntirelyInsideAreClosed) {
  const Area fence = AreaOf(AreaKind::kFence, Box(-1.01, -1.01, 1.01, 1.01));
  EXPECT_EQ(Closed(fence, kMiddle), kMapCells - 10 * 10);
  const Area on_borders = AreaOf(AreaKind::kFence, Box(-1.0, -1.0, 1.0, 1.0));
  EXPECT_EQ(Closed(on_borders, kMiddle), kMapCells - 8 * 8);
  // Far from the map: all are outside; around the map: none is.
  EXPECT_EQ(Closed(AreaOf(AreaKind::kFence, Box(500, 500, 600, 600)), kMiddle), kMapCells);
  EXPECT_EQ(Closed(AreaOf(AreaKind::kFence, Box(-900, -900, 900, 900)), kMiddle), 0);
}

TEST(AreaShape, AKeepOutAreaOffTheMapClosesNothingAndOneAroundItAll) {
  for (const Place& beside : {Place{200, 0}, Place{-200, 0}, Place{0, 200}, Place{0, -200}}) {
    const Area area =
        AreaOf(AreaKind::kKeepOut, Box(beside.x - 9, beside.y - 9, beside.x + 9, beside.y + 9));
    EXPECT_EQ(Closed(area, kMiddle), 0);
  }
  EXPECT_EQ(Closed(AreaOf(AreaKind::kKeepOut, Box(-900, -900, 900, 900)), kMiddle), kMapCells);
  EXPECT_EQ(Closed(AreaOf(AreaKind::kSpeedZone, Box(-9, -9, 9, 9), 1.0f), kMiddle), 0);
}

TEST(AreaShape, RandomPolygonsCloseWhatTheyTouch) {
  const uint32_t seed = 72;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> at(-60.0, 60.0);
  std::uniform_real_distribution<double> size(0.5, 70.0);
  std::uniform_int_distribution<int32_t> shift(-300, 300);
  std::uniform_int_distribution<int> any_row(0, kMapSize_cells - 1);
  for (int run = 0; run < Rounds(120, 15); ++run) {
    const AreaKind kind = run % 3 == 0 ? AreaKind::kFence : AreaKind::kKeepOut;
    const Area area = testing::RandomStar(random, kind, {at(random), at(random)}, size(random));
    if (CheckArea(area) != Status::kOk) continue;
    const GridWindow window = {{-256 + shift(random), -256 + shift(random)}};
    for (int i = 0; i < 12; ++i) ExpectRow(area, window, any_row(random), 0.001);
  }
}

// Corners 90 km away, edges through the map: closed for certain, and by no more than rounding.
TEST(AreaShape, HugePolygonsCloseWhatTheyTouch) {
  const uint32_t seed = 73;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> far(-90'000.0, 90'000.0);
  std::uniform_real_distribution<double> near(-40.0, 40.0);
  std::uniform_int_distribution<int> any_row(0, kMapSize_cells - 1);
  for (int run = 0; run < 60; ++run) {
    const Area area = AreaOf(
        AreaKind::kKeepOut,
        {{near(random), near(random)}, {far(random), far(random)}, {far(random), far(random)}});
    if (CheckArea(area) != Status::kOk) continue;
    for (int i = 0; i < 8; ++i) ExpectRow(area, kMiddle, any_row(random), 0.5);
  }
}

Footprint Warthog() {
  return FootprintOf(VehicleParams{});
}

std::vector<Place> OutlineOf(const Footprint& footprint, const Pose2& pose, double ends = 0.0,
                             double flanks = 0.0) {
  const double c = std::cos(double{pose.theta_rad});
  const double s = std::sin(double{pose.theta_rad});
  const double front = double{footprint.front_m} + ends;
  const double rear = double{footprint.rear_m} - ends;
  const double side = double{footprint.half_width_m} + flanks;
  std::vector<Place> outline;
  for (const auto& [x, y] : {Place{front, side}, {rear, side}, {rear, -side}, {front, -side}}) {
    outline.push_back({double{pose.x_m} + c * x - s * y, double{pose.y_m} + s * x + c * y});
  }
  return outline;
}

// SR-ARE03
TEST(AreaShape, AnOutlineBreachesWhatItTouches) {
  const uint32_t seed = 74;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> at(-15.0f, 15.0f);
  std::uniform_real_distribution<float> angle(-3.14f, 3.14f);
  std::uniform_real_distribution<double> size(0.3, 18.0);
  const Footprint footprint = Warthog();
  int breached = 0;
  int free = 0;
  for (int run = 0; run < 20000; ++run) {
    const AreaKind kind = run % 2 == 0 ? AreaKind::kFence : AreaKind::kKeepOut;
    const Area area =
        testing::RandomStar(random, kind, {double{at(random)}, double{at(random)}}, size(random));
    if (CheckArea(area) != Status::kOk) continue;
    const Pose2 pose = {at(random), at(random), angle(random)};
    const auto relation = RelationOf(testing::CornersOf(area), OutlineOf(footprint, pose));
    if (relation.border_m > 0.0 && relation.border_m < 0.004) continue;  // a matter of rounding
    const bool touches = relation.border_m <= 0.0 || relation.holds || relation.is_inside;
    const bool inside = relation.border_m > 0.0 && relation.holds;
    const bool expected = kind == AreaKind::kFence ? !inside : touches;
    ASSERT_EQ(IsBreached(area, footprint, pose), expected) << run;
    ASSERT_EQ(IsTouched(area, footprint, pose, 0.0f, 0.0f), touches) << run;
    ++(expected ? breached : free);
  }
  EXPECT_GT(breached, 2000);
  EXPECT_GT(free, 2000);
}

TEST(AreaShape, AnOutlineGrownByAMarginTouchesFromAfar) {
  const Area area = AreaOf(AreaKind::kSpeedZone, Box(10, -1, 12, 1), 1.0f);
  const Footprint footprint = Warthog();
  const float before_m = 10.0f - footprint.front_m;
  EXPECT_TRUE(IsTouched(area, footprint, {before_m - 0.49f, 0.0f, 0.0f}, 0.5f, 0.0f));
  EXPECT_FALSE(IsTouched(area, footprint, {before_m - 0.51f, 0.0f, 0.0f}, 0.5f, 0.0f));
  const float beside_m = -1.0f - footprint.half_width_m;
  EXPECT_TRUE(IsTouched(area, footprint, {11.0f, beside_m - 0.29f, 0.0f}, 0.0f, 0.3f));
  EXPECT_FALSE(IsTouched(area, footprint, {11.0f, beside_m - 0.31f, 0.0f}, 0.0f, 0.3f));
  EXPECT_FALSE(IsBreached(area, footprint, {11.0f, 0.0f, 0.0f})) << "a zone forbids nothing";
}

TEST(AreaShape, APointIsForbiddenInAKeepOutAreaAndOutsideAFence) {
  const std::vector<Place> ell = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}};
  const Area keep_out = AreaOf(AreaKind::kKeepOut, ell);
  const Area fence = AreaOf(AreaKind::kFence, ell);
  for (const Vec2& inside : {Vec2{0.5f, 3.5f}, Vec2{3.5f, 0.5f}}) {
    EXPECT_TRUE(Forbids(keep_out, inside));
    EXPECT_FALSE(Forbids(fence, inside));
  }
  for (const Vec2& outside : {Vec2{2.0f, 2.0f}, Vec2{-1.0f, 0.5f}, Vec2{9.0e5f, 9.0e5f}}) {
    EXPECT_FALSE(Forbids(keep_out, outside));
    EXPECT_TRUE(Forbids(fence, outside));
  }
  EXPECT_TRUE(Forbids(keep_out, {1.0f, 2.0f})) << "on the border";
  EXPECT_TRUE(Forbids(fence, {1.0f, 2.0f})) << "on the border";
}

}  // namespace
}  // namespace hardpack
