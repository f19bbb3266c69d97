// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>

#include "core/astar/astar.h"
#include "test/core/astar/reference_search.h"
#include "test/core/astar/sketch.h"

// What paths look like on maps that can be drawn, and on large ones that are hard for a search.

namespace hardpack {
namespace {

class AstarPath : public ::testing::Test {
 protected:
  // Solves and compares with Dijkstra.
  const AstarResult& SolveAndCheck(const Costmap& map, Cell start, Cell goal) {
    const AstarResult& result = Solve(*search_, map, start, goal);
    EXPECT_EQ(result.status, Status::kOk);
    if (result.status != Status::kOk) return result;
    EXPECT_EQ(FaultOfPath(map, *search_), "");
    ReferenceSearch reference(map);
    reference.Solve(start.x - map.window.origin.x, start.y - map.window.origin.y);
    EXPECT_EQ(result.cost,
              reference.CostTo(goal.x - map.window.origin.x, goal.y - map.window.origin.y));
    return result;
  }
  const AstarResult& SolveAndCheck(const Sketch& sketch) {
    return SolveAndCheck(*sketch.map, sketch.start, sketch.goal);
  }

  const std::unique_ptr<AstarSearch> search_ = std::make_unique<AstarSearch>();
};

TEST_F(AstarPath, GoesStraightAndDiagonalOverFreeGround) {
  const auto map = UniformMap(false, {-256, -256});
  const AstarResult& result = SolveAndCheck(*map, {-200, -100}, {120, 60});
  EXPECT_EQ(result.path_cells, 321);
  EXPECT_EQ(result.cost, 160 * 99 + 160 * 70);
}

TEST_F(AstarPath, JoinsOppositeCornersOfTheMap) {
  const auto map = UniformMap(false);
  for (const auto& [start, goal] :
       {std::pair{Cell{0, 0}, Cell{511, 511}}, std::pair{Cell{511, 0}, Cell{0, 511}},
        std::pair{Cell{0, 511}, Cell{0, 0}}, std::pair{Cell{511, 511}, Cell{511, 0}}}) {
    SolveAndCheck(*map, start, goal);
  }
}

TEST_F(AstarPath, GoesAroundACornerWithoutCuttingIt) {
  const AstarResult& result = SolveAndCheck(Draw({
      "S#.",
      "..G",
  }));
  EXPECT_EQ(result.cost, 3 * 70);
}

TEST_F(AstarPath, MakesADetourAroundCost) {
  // 'h' costs 8 on top of 1: through it is 70 + 9 * 70, around it 2 * 99.
  const AstarResult& result = SolveAndCheck(Draw({
      "ShG",
      "...",
  }));
  EXPECT_EQ(search_->Next(result.start), (Cell{101, 101}));
  EXPECT_EQ(result.cost, 2 * 99);
}

TEST_F(AstarPath, PaysForTheCellEnteredAlone) {
  EXPECT_EQ(SolveAndCheck(Draw({"Sc."
                                "G"}))
                .cost,
            4 * 70 + 70 + 70);
  Sketch sketch = Draw({"SG"});
  sketch.map->cost_q8[sketch.map->window.Index(sketch.start)] = 1000;
  EXPECT_EQ(SolveAndCheck(sketch).cost, 70);
}

TEST_F(AstarPath, LeavesACup) {
  SolveAndCheck(Draw({
      "...........",
      ".#######...",
      ".......#...",
      ".....S.#..G",
      ".......#...",
      ".#######...",
      "...........",
  }));
}

TEST_F(AstarPath, FindsNoWayOverACheckerboard) {
  auto map = UniformMap(false);
  for (int index = 0; index < kMapCells; ++index) {
    if ((index + index / kMapSize_cells) % 2 == 1) SetLethal(*map, index);
  }
  EXPECT_EQ(Solve(*search_, *map, {0, 0}, {2, 2}).status, Status::kNoPath);
}

// Walls every `gap` columns, each open at one end, in turn: the longest way there is.
std::unique_ptr<Costmap> Comb(int gap) {
  auto map = UniformMap(false);
  for (int x = gap; x < kMapSize_cells; x += gap + 1) {
    const bool open_below = (x / (gap + 1)) % 2 == 0;
    for (int y = 0; y < kMapSize_cells; ++y) {
      const bool open = open_below ? y < gap : y >= kMapSize_cells - gap;
      if (!open) SetLethal(*map, y * kMapSize_cells + x);
    }
  }
  return map;
}

TEST_F(AstarPath, WindsThroughACombOfOneCell) {
  const auto map = Comb(1);
  const AstarResult& result = SolveAndCheck(*map, {0, 0}, {510, 0});
  EXPECT_GT(result.path_cells, 130000);
}

TEST_F(AstarPath, WindsThroughAWideCombOfTheLargestCosts) {
  const auto map = Comb(7);
  for (int index = 0; index < kMapCells; ++index) {
    map->cost_q8[index] = static_cast<uint16_t>(index % 3 == 0 ? kMaxCost_q8 : 0);
  }
  SolveAndCheck(*map, {0, 0}, {505, 255});
}

TEST_F(AstarPath, KeepsCountOfTheDearestCosts) {
  // Far beyond the 25 bits that a cell keeps of its cost, in one call and in steps; the query after
  // it is not disturbed.
  const auto map = Comb(1);
  for (uint16_t& cost_q8 : map->cost_q8) cost_q8 = kMaxCost_q8;
  EXPECT_GT(SolveAndCheck(*map, {0, 0}, {510, 0}).cost, int64_t{130000} * 70 * 40);
  const std::vector<Cell> path = PathOf(*search_);
  ASSERT_EQ(search_->Begin(*map, {}, CellCenter({0, 0}), CellCenter({510, 0})), Status::kOk);
  int units = 0;
  while (search_->Step(*map, 777) == Progress::kBusy) {
    ASSERT_LE(units += 777, AstarSearch::kMaxUnits);
  }
  EXPECT_EQ(PathOf(*search_), path);
  SolveAndCheck(*map, {2, 100}, {6, 400});
}

TEST_F(AstarPath, KeepsCountOfDearCostsToAGoalThatWasMoved) {
  // Both the search for a free goal and the move of the labels go through the map row by row.
  const auto map = Comb(1);
  for (uint16_t& cost_q8 : map->cost_q8) cost_q8 = kMaxCost_q8;
  const AstarResult& result = Solve(*search_, *map, {0, 0}, {47, 200});
  ASSERT_EQ(result.status, Status::kGoalMoved);
  EXPECT_EQ(FaultOfPath(*map, *search_), "");
  ReferenceSearch reference(*map);
  reference.Solve(0, 0);
  EXPECT_EQ(result.cost, reference.CostTo(result.goal.x, result.goal.y));
  EXPECT_GT(result.cost, int64_t{10000} * 70 * 40);
}

TEST_F(AstarPath, IsNotDisturbedByADearQueryGivenUpAnywhere) {
  const auto map = Comb(1);
  for (uint16_t& cost_q8 : map->cost_q8) cost_q8 = kMaxCost_q8;
  for (const int units : {1, 511, 513, 600, 800, 1100, 1200, 5000, 13000}) {
    SCOPED_TRACE("given up after " + std::to_string(units));
    ASSERT_EQ(search_->Begin(*map, {}, CellCenter({0, 0}), CellCenter({510, 0})), Status::kOk);
    ASSERT_EQ(search_->Step(*map, units), Progress::kBusy);
    SolveAndCheck(*map, {2, 100}, {4, 40});
  }
}

TEST_F(AstarPath, ReachesTheMiddleOfASpiral) {
  // A corridor of one cell along the border, turning inwards after every wall:
  //   ........
  //   #######.
  //   .....#.
  //   .###.#.   ...
  auto map = UniformMap(true);
  int x = 0;
  int y = 0;
  int length = kMapSize_cells - 1;
  constexpr int kDx[4] = {1, 0, -1, 0};
  constexpr int kDy[4] = {0, 1, 0, -1};
  map->flags[0] = 0;
  for (int side = 0; length > 1; ++side) {
    for (int i = 0; i < length; ++i) {
      x += kDx[side % 4];
      y += kDy[side % 4];
      map->flags[y * kMapSize_cells + x] = 0;
    }
    if (side >= 2 && side % 2 == 0) length -= 2;
  }
  const AstarResult& result = SolveAndCheck(*map, {0, 0}, {x, y});
  EXPECT_GT(result.path_cells, 100000);
}

TEST_F(AstarPath, ThroughDearGroundCostsTheMost) {
  auto map = UniformMap(false);
  for (uint16_t& cost_q8 : map->cost_q8) cost_q8 = kMaxCost_q8;
  EXPECT_EQ(SolveAndCheck(*map, {0, 0}, {511, 511}).cost, 511 * kMaxEdgeCost);
}

TEST_F(AstarPath, DoesNotDependOnWhereTheWindowLies) {
  const std::vector<std::string> drawing = {
      "S..#.....",
      ".#...##..",
      "...#....G",
      ".##..#...",
  };
  const Sketch here = Draw(drawing);
  Sketch there = Draw(drawing);
  const Cell offset{-70000, 123456};
  there.map->window.origin = offset;
  Solve(*search_, *here.map, here.start, here.goal);
  const std::vector<Cell> path_here = PathOf(*search_);
  // Near enough to 0 for float to tell cells apart.
  Solve(*search_, *there.map, {here.start.x + offset.x, here.start.y + offset.y},
        {here.goal.x + offset.x, here.goal.y + offset.y});
  const std::vector<Cell> path_there = PathOf(*search_);
  ASSERT_EQ(path_here.size(), path_there.size());
  for (size_t i = 0; i < path_here.size(); ++i) {
    EXPECT_EQ(path_there[i].x, path_here[i].x + offset.x);
    EXPECT_EQ(path_there[i].y, path_here[i].y + offset.y);
  }
}

TEST_F(AstarPath, KeepsTheFirstOfEquallyCheapParents) {
  // The lower row was reached before the upper one (towards -y) at the start, so the upper one goes
  // first, as far as the corner; there the lower one was reached last. Both then reach the goal,
  // which is dear, at the same cost: it keeps the lower one.
  Sketch sketch = Draw({
      ".....",
      "S###h",
      ".....",
  });
  sketch.goal = {104, 101};
  SolveAndCheck(sketch);
  EXPECT_EQ(PathOf(*search_)[1], (Cell{100, 102}));
}

TEST_F(AstarPath, IsTheSameEachTimeWhereManyAreEquallyGood) {
  // A wall right across a symmetric map: over and under it cost the same.
  auto map = UniformMap(false);
  for (int y = 100; y <= 412; ++y) SetLethal(*map, map->window.Index({256, y}));
  const Cell start{100, 256};
  const Cell goal{412, 256};
  SolveAndCheck(*map, start, goal);
  const std::vector<Cell> first = PathOf(*search_);
  for (int repetition = 0; repetition < 10; ++repetition) {
    Solve(*search_, *map, goal, start);
    Solve(*search_, *map, start, goal);
    EXPECT_EQ(PathOf(*search_), first);
  }
}

}  // namespace
}  // namespace hardpack
