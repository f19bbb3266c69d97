// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/astar/astar.h"
#include "core/base/grid.h"
#include "core/costmap/costmap.h"

// Maps drawn in text, for the tests of the search.

namespace hardpack {

// 512 x 512 cells at `origin`, all of one kind: free and of no cost, or lethal and of no depth.
inline std::unique_ptr<Costmap> UniformMap(bool lethal, Cell origin = {0, 0}) {
  auto map = std::make_unique<Costmap>();
  map->window.origin = origin;
  std::memset(map->flags, lethal ? Costmap::kHard | Costmap::kLethal : 0, sizeof(map->flags));
  return map;
}

inline void SetLethal(Costmap& map, int index, int depth2 = 0) {
  map.flags[index] = Costmap::kHard | Costmap::kLethal;
  map.hard_depth2[index] = static_cast<uint8_t>(depth2);
}

// A drawing in an otherwise lethal map, its upper left character at cell (corner.x, corner.y) and
// its rows towards +y. '.' free; '#' lethal, depth 255; '1' to '9' lethal of that depth; 'S' and
// 'G' free (start and goal); 's' start in a lethal cell of depth 9; 'a' to 'h' free, of cost 1
// to 8.
struct Sketch {
  std::unique_ptr<Costmap> map;
  Cell start;
  Cell goal;
};

inline Sketch Draw(const std::vector<std::string>& rows, Cell corner = {100, 100}) {
  Sketch sketch{UniformMap(true), corner, corner};
  std::memset(sketch.map->hard_depth2, 255, sizeof(sketch.map->hard_depth2));
  for (size_t row = 0; row < rows.size(); ++row) {
    for (size_t column = 0; column < rows[row].size(); ++column) {
      const Cell cell{corner.x + static_cast<int>(column), corner.y + static_cast<int>(row)};
      const int index = sketch.map->window.Index(cell);
      const char c = rows[row][column];
      if (c == 'S' || c == 's') sketch.start = cell;
      if (c == 'G') sketch.goal = cell;
      if (c == '#') continue;
      if (c >= '1' && c <= '9') {
        SetLethal(*sketch.map, index, c - '0');
      } else if (c == 's') {
        SetLethal(*sketch.map, index, 9);
      } else {
        sketch.map->flags[index] = 0;
        sketch.map->hard_depth2[index] = 0;
        if (c >= 'a' && c <= 'h') {
          sketch.map->cost_q8[index] = static_cast<uint16_t>((c - 'a' + 1) * kCostOne_q8);
        }
      }
    }
  }
  return sketch;
}

inline void RunToEnd(AstarSearch& search, const Costmap& map) {
  ASSERT_EQ(search.Step(map, AstarSearch::kMaxUnits), Progress::kDone);
}

// One whole query between the centres of two cells.
inline const AstarResult& Solve(AstarSearch& search, const Costmap& map, Cell start, Cell goal,
                                const AstarParams& params = {}) {
  if (search.Begin(map, params, CellCenter(start), CellCenter(goal)) == Status::kOk) {
    RunToEnd(search, map);
  }
  return search.result();
}

// The cells of a usable path, start to end.
inline std::vector<Cell> PathOf(const AstarSearch& search) {
  std::vector<Cell> cells{search.result().start};
  while (cells.back() != search.result().end && cells.size() < kMapCells) {
    cells.push_back(search.Next(cells.back()));
  }
  return cells;
}

}  // namespace hardpack
