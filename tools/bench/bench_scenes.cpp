// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_scenes.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"

namespace hardpack::command {
namespace {

constexpr int kSquare_cells = 24;
constexpr int kSquares = kMapSize_cells / kSquare_cells;
constexpr uint8_t kFreeCell = Costmap::kObserved;
constexpr uint8_t kHardCell = Costmap::kHard | Costmap::kObserved;
constexpr uint8_t kSoftCell = Costmap::kSoft | Costmap::kObserved;

// Near two corners: 61 m apart, some 220 points of a straight path.
constexpr BenchQuery kCornerToCorner = {.start_m = {-21.4f, -21.4f}, .goal_m = {21.8f, 21.8f}};

// The middle of a cell, counted from the map's lower left corner.
Vec2 Place(int x, int y) {
  const GridWindow window = GridWindow::CenteredAt({});
  return CellCenter({window.origin.x + x, window.origin.y + y});
}

// A map under construction; cells beyond its edge are ignored.
class Sketch {
 public:
  explicit Sketch(uint32_t seed)
      : flags_(static_cast<size_t>(kMapCells), kFreeCell), engine_(seed) {}

  int Below(int limit) { return static_cast<int>(engine_() % static_cast<uint32_t>(limit)); }

  void Fill(int x, int y, int width, int height, uint8_t flags) {
    for (int row = std::max(y, 0); row < std::min(y + height, kMapSize_cells); ++row) {
      for (int column = std::max(x, 0); column < std::min(x + width, kMapSize_cells); ++column) {
        flags_[static_cast<size_t>(row * kMapSize_cells + column)] = flags;
      }
    }
  }

  // Room to stand at both ends of the query.
  void ClearEnds(const BenchQuery& query) {
    constexpr int kRoom_cells = 12;
    const GridWindow window = GridWindow::CenteredAt({});
    for (const Vec2& place : {query.start_m, query.goal_m}) {
      const int index = window.Index(CellAt(place));
      Fill(index % kMapSize_cells - kRoom_cells, index / kMapSize_cells - kRoom_cells,
           2 * kRoom_cells, 2 * kRoom_cells, kFreeCell);
    }
  }

  // With that query first, then others between random places far apart.
  BenchScene Finish(const std::string& name, const BenchQuery& query = kCornerToCorner) {
    constexpr size_t kQueries = 25;
    constexpr int kFar_cells = 200;
    BenchScene scene = {.name = name, .flags = flags_, .queries = {query}};
    while (scene.queries.size() < kQueries) {
      const std::array<int, 4> at = {Below(kMapSize_cells), Below(kMapSize_cells),
                                     Below(kMapSize_cells), Below(kMapSize_cells)};
      if (std::abs(at[0] - at[2]) + std::abs(at[1] - at[3]) < kFar_cells) continue;
      scene.queries.push_back({.start_m = Place(at[0], at[1]), .goal_m = Place(at[2], at[3])});
    }
    return scene;
  }

 private:
  std::vector<uint8_t> flags_;
  std::mt19937 engine_;
};

// That share of the squares is a hard box.
BenchScene Boxes(int percent, uint32_t seed) {
  Sketch sketch(seed);
  for (int square = 0; square < kSquares * kSquares; ++square) {
    if (sketch.Below(100) >= percent) continue;
    sketch.Fill(square % kSquares * kSquare_cells, square / kSquares * kSquare_cells, kSquare_cells,
                kSquare_cells, kHardCell);
  }
  sketch.ClearEnds(kCornerToCorner);
  return sketch.Finish("random_" + std::to_string(percent));
}

// That share of the cells is hard, each by itself.
BenchScene Cells(int percent, uint32_t seed) {
  Sketch sketch(seed);
  for (int cell = 0; cell < kMapCells; ++cell) {
    if (sketch.Below(100) >= percent) continue;
    sketch.Fill(cell % kMapSize_cells, cell / kMapSize_cells, 1, 1, kHardCell);
  }
  sketch.ClearEnds(kCornerToCorner);
  return sketch.Finish("cells_" + std::to_string(percent));
}

BenchScene Forest(uint32_t seed) {
  Sketch sketch(seed);
  constexpr int kMap_m2 = 10486;
  for (int bush = 0; bush < kMap_m2 / 80; ++bush) {
    sketch.Fill(sketch.Below(kMapSize_cells), sketch.Below(kMapSize_cells), 5, 5, kSoftCell);
  }
  for (int trunk = 0; trunk < kMap_m2 / 40; ++trunk) {
    sketch.Fill(sketch.Below(kMapSize_cells), sketch.Below(kMapSize_cells), 2, 2, kHardCell);
  }
  sketch.ClearEnds(kCornerToCorner);
  return sketch.Finish("forest");
}

// Depth-first: from the newest square that has a neighbour not yet reached, break a wall to one.
BenchScene Maze(uint32_t seed) {
  Sketch sketch(seed);
  constexpr int kWall_cells = 2;
  sketch.Fill(0, 0, kMapSize_cells, kMapSize_cells, kHardCell);
  std::vector<bool> reached(static_cast<size_t>(kSquares * kSquares), false);
  std::vector<int> trail = {0};
  // The wall between two squares belongs to the one with the smaller coordinates.
  const auto open = [&sketch, &reached](int square, int wall_x, int wall_y) {
    reached[static_cast<size_t>(square)] = true;
    sketch.Fill(square % kSquares * kSquare_cells, square / kSquares * kSquare_cells,
                kSquare_cells - kWall_cells + wall_x * kWall_cells,
                kSquare_cells - kWall_cells + wall_y * kWall_cells, kFreeCell);
  };
  open(0, 0, 0);
  constexpr std::array<std::array<int, 2>, 4> kSteps = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  while (!trail.empty()) {
    const int here = trail.back();
    const int first = sketch.Below(4);
    bool moved = false;
    for (int turn = 0; turn < 4 && !moved; ++turn) {
      const auto& [dx, dy] = kSteps[static_cast<size_t>((first + turn) % 4)];
      const int x = here % kSquares + dx;
      const int y = here / kSquares + dy;
      if (x < 0 || y < 0 || x >= kSquares || y >= kSquares) continue;
      const int next = y * kSquares + x;
      if (reached[static_cast<size_t>(next)]) continue;
      open(next, 0, 0);
      open(std::min(here, next), std::abs(dx), std::abs(dy));
      trail.push_back(next);
      moved = true;
    }
    if (!moved) trail.pop_back();
  }
  sketch.ClearEnds(kCornerToCorner);
  return sketch.Finish("maze");
}

//   +----------------+
//   | goal           |
//   +-------------   +
//   |                |
//   +   -------------+
//   | start          |
//   +----------------+
BenchScene Comb(uint32_t seed) {
  Sketch sketch(seed);
  constexpr int kWay_cells = 7;
  constexpr int kPitch_cells = kWay_cells + 1;
  for (int tooth = 1; tooth < kMapSize_cells / kPitch_cells; ++tooth) {
    const int gap_x = tooth % 2 == 1 ? kMapSize_cells - kWay_cells : 0;
    sketch.Fill(0, tooth * kPitch_cells - 1, kMapSize_cells, 1, kHardCell);
    sketch.Fill(gap_x, tooth * kPitch_cells - 1, kWay_cells, 1, kFreeCell);
  }
  constexpr int kMiddle_cells = kWay_cells / 2;
  return sketch.Finish("comb",
                       {.start_m = Place(kMiddle_cells, kMiddle_cells),
                        .goal_m = Place(kMiddle_cells, kMapSize_cells - kMiddle_cells - 1)});
}

//   +-------------+
//   | +---------+ |
//   | | +---+   | |
//   | |   goal| | |
//   | +-------+ | |
//   |           | |
//   +---------- + |      (the outermost wall's lower side; the start is below it, to the left)
BenchScene Spiral(uint32_t seed) {
  Sketch sketch(seed);
  constexpr int kPitch_cells = 32;
  constexpr int kWall_cells = 3;
  constexpr int kMiddle_cells = kMapSize_cells / 2;
  for (int low = kPitch_cells; low < kMiddle_cells; low += kPitch_cells) {
    const int high = kMapSize_cells - low;
    sketch.Fill(low - kPitch_cells, low, high - low + kPitch_cells, kWall_cells, kHardCell);
    sketch.Fill(high, low, kWall_cells, high - low, kHardCell);
    sketch.Fill(low, high, high - low + kWall_cells, kWall_cells, kHardCell);
    sketch.Fill(low, low + kPitch_cells, kWall_cells, high - low - kPitch_cells, kHardCell);
  }
  return sketch.Finish("spiral", {.start_m = Place(kPitch_cells / 2, kPitch_cells / 2),
                                  .goal_m = Place(kMiddle_cells, kMiddle_cells)});
}

//   +---------+
//   | start   |   goal     and no side on the left: all of the cup is searched first
//   +---------+
BenchScene Cup(uint32_t seed) {
  Sketch sketch(seed);
  constexpr int kWall_cells = 3;
  constexpr int kLow_cells = 56;
  constexpr int kSide_cells = 400;
  sketch.Fill(kLow_cells, kLow_cells, kSide_cells, kWall_cells, kHardCell);
  sketch.Fill(kLow_cells, kLow_cells + kSide_cells, kSide_cells, kWall_cells, kHardCell);
  sketch.Fill(kLow_cells + kSide_cells, kLow_cells, kWall_cells, kSide_cells + kWall_cells,
              kHardCell);
  constexpr int kMiddle_cells = kMapSize_cells / 2;
  return sketch.Finish("cup", {.start_m = Place(kMiddle_cells, kMiddle_cells),
                               .goal_m = Place(kMapSize_cells - kLow_cells / 2, kMiddle_cells)});
}

// One hard cell, in the corner: as far from everything as a cell can be.
BenchScene Corner(uint32_t seed) {
  Sketch sketch(seed);
  sketch.Fill(0, 0, 1, 1, kHardCell);
  return sketch.Finish("corner");
}

BenchScene Full(uint32_t seed) {
  Sketch sketch(seed);
  sketch.Fill(0, 0, kMapSize_cells, kMapSize_cells, kHardCell);
  return sketch.Finish("full");
}

}  // namespace

std::vector<SceneMaker> BuiltInScenes() {
  return {{"random_10", [] { return Boxes(10, 11); }},
          {"random_25", [] { return Boxes(25, 12); }},
          {"random_40", [] { return Boxes(40, 13); }},
          {"cells_10", [] { return Cells(10, 17); }},
          {"cells_40", [] { return Cells(40, 18); }},
          {"forest", [] { return Forest(14); }},
          {"maze", [] { return Maze(15); }},
          {"comb", [] { return Comb(19); }},
          {"spiral", [] { return Spiral(20); }},
          {"cup", [] { return Cup(21); }},
          {"corner", [] { return Corner(22); }},
          {"open", [] { return Sketch(16).Finish("open"); }},
          {"full", [] { return Full(23); }}};
}

}  // namespace hardpack::command
