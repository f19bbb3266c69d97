// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/thicket.h"

#include <algorithm>
#include <array>
#include <vector>

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

using Field = ThicketField;

constexpr double kRadius_m = Field::kCell_m / 2.0;
constexpr double kBack_m = -5.0;  // of the yard of the start
constexpr double kEnd_m = 41.0;   // of the walls
constexpr Point2 kGoal = {36.0, 0.0};

// One kind of thing in each cell.
enum class Cell : uint8_t { kEmpty, kCylinder, kBox };
struct Cells {
  Cell cell[Field::kRows][Field::kColumns] = {};

  Cell* operator[](int row) { return cell[row]; }
  const Cell* operator[](int row) const { return cell[row]; }
};

Point2 MiddleOf(int row, int column) {
  return {Field::kBegin_m + (column + 0.5) * Field::kCell_m,
          (row + 0.5 - Field::kRows / 2.0) * Field::kCell_m};
}

// Of the eight; cells beyond the walls are full, cells beyond the ends are empty.
int FullNeighbours(const Cells& cells, int row, int column) {
  int full = 0;
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = column - 1; c <= column + 1; ++c) {
      if ((r == row && c == column) || c < 0 || c >= Field::kColumns) continue;
      const bool is_wall = r < 0 || r >= Field::kRows;
      full += is_wall || cells[r][c] != Cell::kEmpty ? 1 : 0;
    }
  }
  return full;
}

Cells Smoothed(const Cells& before) {
  constexpr int kFills = 5;
  constexpr int kEmpties = 1;
  Cells after = before;
  for (int row = 0; row < Field::kRows; ++row) {
    for (int column = 0; column < Field::kColumns; ++column) {
      const int full = FullNeighbours(before, row, column);
      if (full >= kFills) after[row][column] = Cell::kCylinder;
      if (full <= kEmpties) after[row][column] = Cell::kEmpty;
    }
  }
  return after;
}

// The cells connected to a cell become boxes.
void MakeBoxes(Cells& cells, int row, int column) {
  std::vector<std::array<int, 2>> open = {{row, column}};
  while (!open.empty()) {
    const auto [r, c] = open.back();
    open.pop_back();
    if (r < 0 || r >= Field::kRows || c < 0 || c >= Field::kColumns) continue;
    if (cells[r][c] != Cell::kCylinder) continue;
    cells[r][c] = Cell::kBox;
    for (int side = -1; side <= 1; side += 2) {
      open.push_back({r + side, c});
      open.push_back({r, c + side});
    }
  }
}

Cells Grown(Draws& draws, double full_share, int rounds) {
  Cells cells = {};
  for (auto& row : cells.cell) {
    for (Cell& cell : row) {
      cell = draws.Uniform(0.0, 1.0) < full_share ? Cell::kCylinder : Cell::kEmpty;
    }
  }
  for (int i = 0; i < rounds; ++i) cells = Smoothed(cells);
  return cells;
}

double DistanceToCell_m(Cell cell, const Point2& middle, double x_m, double y_m) {
  const double dx_m = std::abs(x_m - middle.x_m);
  const double dy_m = std::abs(y_m - middle.y_m);
  if (cell == Cell::kCylinder) return std::sqrt(dx_m * dx_m + dy_m * dy_m) - kRadius_m;
  const double out_x_m = std::max(dx_m - kRadius_m, 0.0);
  const double out_y_m = std::max(dy_m - kRadius_m, 0.0);
  return std::sqrt(out_x_m * out_x_m + out_y_m * out_y_m);
}

// Whether a disc with the radius of the half gap can get from the start to the goal: a flood fill
// over points 0.1 m apart that keep the half gap plus half a step from everything.
class WayThrough {
 public:
  explicit WayThrough(const Cells& cells) : free_(size_t{kRows} * kColumns, 1) {
    for (int row = 0; row < Field::kRows; ++row) {
      for (int column = 0; column < Field::kColumns; ++column) {
        if (cells[row][column] != Cell::kEmpty) Block(cells[row][column], MiddleOf(row, column));
      }
    }
  }

  bool exists() {
    std::vector<int> open;
    Visit(IndexOf({}), open);
    while (!open.empty()) {
      const int index = open.back();
      open.pop_back();
      if (index == IndexOf(kGoal)) return true;
      const int row = index / kColumns;
      const int column = index % kColumns;
      if (row > 0) Visit(index - kColumns, open);
      if (row < kRows - 1) Visit(index + kColumns, open);
      if (column > 0) Visit(index - 1, open);
      if (column < kColumns - 1) Visit(index + 1, open);
    }
    return false;
  }

 private:
  static constexpr double kStep_m = 0.1;
  // A point of the way is at most half a step from one of the points.
  static constexpr double kWanted_m = kThicketHalfGap_m + kStep_m / 2.0;
  static constexpr double kFirst_x_m = -1.0;
  static constexpr double kFirst_y_m = -(Field::kHalfWidth_m - kWanted_m);
  static constexpr int kColumns = 381;
  static constexpr int kRows = 116;  // the walls are kept away from by where the points end

  static int StepsTo(double from_m, double to_m) {
    return static_cast<int>(std::floor((to_m - from_m) / kStep_m + 0.5));
  }
  static int IndexOf(const Point2& place) {
    return StepsTo(kFirst_y_m, place.y_m) * kColumns + StepsTo(kFirst_x_m, place.x_m);
  }

  void Block(Cell cell, const Point2& middle) {
    constexpr int kReach = 16;  // steps: further than kWanted_m and a cell
    const int at_row = StepsTo(kFirst_y_m, middle.y_m);
    const int at_column = StepsTo(kFirst_x_m, middle.x_m);
    const int last_row = std::min(at_row + kReach, kRows - 1);
    const int last_column = std::min(at_column + kReach, kColumns - 1);
    for (int row = std::max(at_row - kReach, 0); row <= last_row; ++row) {
      for (int column = std::max(at_column - kReach, 0); column <= last_column; ++column) {
        const double x_m = kFirst_x_m + column * kStep_m;
        const double y_m = kFirst_y_m + row * kStep_m;
        if (DistanceToCell_m(cell, middle, x_m, y_m) < kWanted_m)
          FreeAt(row * kColumns + column) = 0;
      }
    }
  }

  uint8_t& FreeAt(int index) { return free_[static_cast<size_t>(index)]; }

  void Visit(int index, std::vector<int>& open) {
    if (FreeAt(index) == 0) return;
    FreeAt(index) = 0;
    open.push_back(index);
  }

  std::vector<uint8_t> free_;  // [kRows x kColumns]; 0 once it was visited
};

void Place(World& world, const Cells& cells, Draws& draws) {
  for (int row = 0; row < Field::kRows; ++row) {
    for (int column = 0; column < Field::kColumns; ++column) {
      const Point2 middle = MiddleOf(row, column);
      if (cells[row][column] == Cell::kEmpty) continue;
      const double height_m = draws.Uniform(0.8, 1.8);
      if (cells[row][column] == Cell::kCylinder) {
        world.AddCylinder(middle, kRadius_m, -0.5, height_m, kPost);
      } else {
        AddBoxOnGround(world, middle, 0.0, Field::kCell_m, Field::kCell_m, height_m, kThing);
      }
    }
  }
}

}  // namespace

void MakeThicket(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "A field of cylinders and boxes between two walls; from sparse to barely passable.";
  scenario.goal = kGoal;
  Draws draws(seed, 1);
  double full_share = draws.Uniform(0.05, 0.4);
  const auto rounds = static_cast<int>(draws.Uniform(1.0, 4.0));
  const double boxes = draws.Uniform(0.0, 0.5);
  Cells cells = Grown(draws, full_share, rounds);
  // An impassable field is drawn again, with less and less in it: an empty one is passable.
  while (!WayThrough(cells).exists()) {
    full_share *= 0.98;
    cells = Grown(draws, full_share, rounds);
  }
  for (int row = 0; row < Field::kRows; ++row) {
    for (int column = 0; column < Field::kColumns; ++column) {
      if (cells[row][column] != Cell::kCylinder) continue;
      if (draws.Uniform(0.0, 1.0) < boxes / 4.0) MakeBoxes(cells, row, column);
    }
  }
  Place(scenario.world, cells, draws);
  constexpr double kThick_m = 0.3;
  constexpr double kMiddle_m = Field::kHalfWidth_m + kThick_m / 2.0;
  for (const double side : {-1.0, 1.0}) {
    AddBoxOnGround(scenario.world, {(kBack_m + kEnd_m) / 2.0, side * kMiddle_m}, 0.0,
                   kEnd_m - kBack_m, kThick_m, 2.0, kWall);
  }
  AddBoxOnGround(scenario.world, {kBack_m, 0.0}, kPi / 2.0, 2.0 * kMiddle_m, kThick_m, 2.0, kWall);
}

}  // namespace hardpack::world
