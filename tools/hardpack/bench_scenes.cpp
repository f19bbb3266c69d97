// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/bench_scenes.h"

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
constexpr Vec2 kStart = {-21.4f, -21.4f};
constexpr Vec2 kGoal = {21.8f, 21.8f};

// A map under construction; cells beyond its edge are left alone.
class Sketch {
 public:
  explicit Sketch(uint32_t seed)
      : flags_(static_cast<size_t>(kMapCells), uint8_t{Costmap::kObserved}), engine_(seed) {}

  int Below(int limit) { return static_cast<int>(engine_() % static_cast<uint32_t>(limit)); }

  void Fill(int x, int y, int width, int height, uint8_t flags) {
    for (int row = std::max(y, 0); row < std::min(y + height, kMapSize_cells); ++row) {
      for (int column = std::max(x, 0); column < std::min(x + width, kMapSize_cells); ++column) {
        flags_[static_cast<size_t>(row * kMapSize_cells + column)] = flags;
      }
    }
  }

  // Room to stand at the start and at the goal.
  BenchScene Finish(const std::string& name) {
    constexpr int kRoom_cells = 12;
    const GridWindow window = GridWindow::CenteredAt({});
    for (const Vec2& place : {kStart, kGoal}) {
      const int index = window.Index(CellAt(place));
      Fill(index % kMapSize_cells - kRoom_cells, index / kMapSize_cells - kRoom_cells,
           2 * kRoom_cells, 2 * kRoom_cells, Costmap::kObserved);
    }
    return {name, flags_, kStart, kGoal};
  }

 private:
  std::vector<uint8_t> flags_;
  std::mt19937 engine_;
};

constexpr uint8_t kHardCell = Costmap::kHard | Costmap::kObserved;
constexpr uint8_t kSoftCell = Costmap::kSoft | Costmap::kObserved;

BenchScene Random(int percent, uint32_t seed) {
  Sketch sketch(seed);
  for (int square = 0; square < kSquares * kSquares; ++square) {
    if (sketch.Below(100) >= percent) continue;
    sketch.Fill(square % kSquares * kSquare_cells, square / kSquares * kSquare_cells, kSquare_cells,
                kSquare_cells, kHardCell);
  }
  return sketch.Finish("random_" + std::to_string(percent));
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
                kSquare_cells - kWall_cells + wall_y * kWall_cells, Costmap::kObserved);
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
  return sketch.Finish("maze");
}

}  // namespace

std::vector<BenchScene> MakeBenchScenes() {
  return {Random(10, 11), Random(25, 12), Random(40, 13),
          Forest(14),     Maze(15),       Sketch(16).Finish("open")};
}

}  // namespace hardpack::command
