// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/boost_astar.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <random>

#include "core/astar/astar.h"
#include "test/core/astar/reference_search.h"
#include "test/tools/bench/peers/random_map.h"

namespace hardpack::peers {
namespace {

Cell RandomFreeCell(const Costmap& map, std::mt19937& random) {
  int index = 0;
  do {
    index = static_cast<int>(random() % kMapCells);
  } while (map.Lethal(index));
  return map.window.FromIndex(index);
}

// The cost of a cell path by the rules' own definition, every step judged.
int64_t CostAlong(const Costmap& map, const std::vector<Cell>& cells) {
  const MapRules rules(map);
  int64_t cost = 0;
  for (size_t i = 1; i < cells.size(); ++i) {
    const int x = cells[i - 1].x - map.window.origin.x;
    const int y = cells[i - 1].y - map.window.origin.y;
    const int dx = cells[i].x - cells[i - 1].x;
    const int dy = cells[i].y - cells[i - 1].y;
    EXPECT_TRUE(std::abs(dx) <= 1 && std::abs(dy) <= 1 && (dx != 0 || dy != 0));
    EXPECT_TRUE(rules.MayStep(x, y, dx, dy)) << "out of " << x << ", " << y;
    cost += rules.StepCost(x + dx, y + dy, dx != 0 && dy != 0);
  }
  return cost;
}

TEST(BoostAstar, FindsPathsOfTheSameCostAsAstarSearch) {
  BoostAstar boost;
  const auto search = std::make_unique<AstarSearch>();
  int reached = 0;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    const std::unique_ptr<Costmap> map = RandomMap(seed, static_cast<int>(100 * seed));
    std::mt19937 random(seed);
    for (int query = 0; query < 12; ++query) {
      const Cell start = RandomFreeCell(*map, random);
      const Cell goal = RandomFreeCell(*map, random);
      ASSERT_EQ(search->Begin(*map, AstarParams{}, CellCenter(start), CellCenter(goal)),
                Status::kOk);
      ASSERT_EQ(search->Step(*map, AstarSearch::kMaxUnits), Progress::kDone);
      const BoostAstarResult found = boost.Search(*map, start, goal);
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", query " << query);
      ASSERT_EQ(found.reached, IsUsable(search->result().status));
      if (!found.reached) continue;
      ++reached;
      EXPECT_EQ(found.cost, search->result().cost);
      EXPECT_EQ(found.cells.front(), start);
      EXPECT_EQ(found.cells.back(), goal);
      EXPECT_EQ(CostAlong(*map, found.cells), found.cost);
      EXPECT_GE(found.expansions, static_cast<int32_t>(found.cells.size()));
    }
  }
  EXPECT_GT(reached, 12);
}

//   . . # # #
//   . S # G #      the way to G is past corners alone
//   . . # # #
TEST(BoostAstar, CutsNoCorner) {
  const auto map = std::make_unique<Costmap>();
  const int goal = 300 * kMapSize_cells + 300;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 || dy == 0) map->flags[goal + dy * kMapSize_cells + dx] = Costmap::kLethal;
    }
  }
  map->flags[goal] = 0;
  BoostAstar boost;
  const Cell start = map->window.FromIndex(goal - 2);
  EXPECT_FALSE(boost.Search(*map, start, map->window.FromIndex(goal)).reached);
  map->flags[goal - 1] = 0;
  const BoostAstarResult open = boost.Search(*map, start, map->window.FromIndex(goal));
  ASSERT_TRUE(open.reached);
  EXPECT_EQ(open.cost, 2 * kStraightLength);
  EXPECT_EQ(open.cells.size(), 3u);
}

TEST(BoostAstar, KeepsToTheMapsBorders) {
  const auto map = std::make_unique<Costmap>();
  BoostAstar boost;
  const Cell first = map->window.FromIndex(0);
  const Cell last = map->window.FromIndex(kMapCells - 1);
  EXPECT_EQ(boost.Search(*map, first, last).cost, int64_t{kMapSize_cells - 1} * kDiagonalLength);
  const Cell right = map->window.FromIndex(kMapSize_cells - 1);
  EXPECT_EQ(boost.Search(*map, first, right).cost, int64_t{kMapSize_cells - 1} * kStraightLength);
  EXPECT_EQ(boost.Search(*map, last, last).cells.size(), 1u);
}

TEST(BoostAstar, DoesNotSearchFromOrToWhatIsNoFreeCell) {
  const auto map = std::make_unique<Costmap>();
  map->flags[5] = Costmap::kLethal;
  BoostAstar boost;
  const Cell free = map->window.FromIndex(0);
  const Cell lethal = map->window.FromIndex(5);
  const Cell outside = {map->window.origin.x - 1, map->window.origin.y};
  EXPECT_FALSE(boost.Search(*map, lethal, free).reached);
  EXPECT_FALSE(boost.Search(*map, free, lethal).reached);
  EXPECT_FALSE(boost.Search(*map, outside, free).reached);
  EXPECT_FALSE(boost.Search(*map, free, outside).reached);
}

}  // namespace
}  // namespace hardpack::peers
