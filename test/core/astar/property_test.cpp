// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "core/astar/astar.h"
#include "test/core/astar/reference_search.h"
#include "test/core/astar/sketch.h"

namespace hardpack {
namespace {

#ifdef NDEBUG
constexpr int kProblems = 10000;
constexpr int kLargeMaps = 10;
#else
constexpr int kProblems = 1000;
constexpr int kLargeMaps = 2;
#endif

using Random = std::mt19937;

int Pick(Random& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}

// A random area of free and lethal cells with random costs and depths, in an otherwise lethal map.
struct RandomProblem {
  int left, bottom, width, height;
  Cell start, goal;

  Cell PickCell(Random& random) const {
    return {left + Pick(random, 0, width - 1), bottom + Pick(random, 0, height - 1)};
  }
};

// Sizes are small, so that a problem is cheap; areas at the map's borders and corners are frequent.
int PickOffset(Random& random, int size) {
  const int last = kMapSize_cells - size;
  const int kind = Pick(random, 0, 3);
  return kind == 0 ? 0 : kind == 1 ? last : Pick(random, 0, last);
}

RandomProblem MakeProblem(Random& random, Costmap& map) {
  RandomProblem problem{};
  problem.width = Pick(random, 1, 40);
  problem.height = Pick(random, 1, 40);
  problem.left = PickOffset(random, problem.width);
  problem.bottom = PickOffset(random, problem.height);
  const int lethal_percent = Pick(random, 0, 5) * 10;
  const int largest_cost_q8 = Pick(random, 0, 3) == 0 ? 0 : Pick(random, 0, kMaxCost_q8);
  const int largest_depth2 = Pick(random, 0, 1) == 0 ? 255 : Pick(random, 1, 4);
  const bool free_cells_have_depth = Pick(random, 0, 4) == 0;  // wrong, and of no consequence
  for (int y = problem.bottom; y < problem.bottom + problem.height; ++y) {
    for (int x = problem.left; x < problem.left + problem.width; ++x) {
      const int index = y * kMapSize_cells + x;
      const bool lethal = Pick(random, 1, 100) <= lethal_percent;
      map.flags[index] = lethal ? Costmap::kHard | Costmap::kLethal : 0;
      const bool has_depth = lethal || free_cells_have_depth;
      map.hard_depth2[index] =
          static_cast<uint8_t>(has_depth ? Pick(random, 1, largest_depth2) : 0);
      map.cost_q8[index] = static_cast<uint16_t>(Pick(random, 0, largest_cost_q8));
    }
  }
  problem.start = problem.PickCell(random);
  problem.goal = problem.PickCell(random);
  return problem;
}

void Erase(const RandomProblem& problem, Costmap& map) {
  for (int y = problem.bottom; y < problem.bottom + problem.height; ++y) {
    for (int x = problem.left; x < problem.left + problem.width; ++x) {
      const int index = y * kMapSize_cells + x;
      map.flags[index] = Costmap::kHard | Costmap::kLethal;
      map.hard_depth2[index] = 255;
      map.cost_q8[index] = 0;
    }
  }
}

std::unique_ptr<Costmap> LethalMap() {
  auto map = UniformMap(true);
  std::memset(map->hard_depth2, 255, sizeof(map->hard_depth2));
  return map;
}

// The free cell nearest to `from` of those within the squared limit of the goal, of equals the one
// of lowest index; (-1, -1) if there is none.
Cell NearestFree(const Costmap& map, const RandomProblem& problem, Cell from, double limit2) {
  Cell best{-1, -1};
  int best_distance2 = INT32_MAX;
  const auto squared = [](Cell a, Cell b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
  };
  for (int y = problem.bottom; y < problem.bottom + problem.height; ++y) {
    for (int x = problem.left; x < problem.left + problem.width; ++x) {
      if (map.Lethal(y * kMapSize_cells + x)) continue;
      const Cell cell{x, y};
      if (squared(cell, problem.goal) > limit2 || squared(cell, from) >= best_distance2) continue;
      best_distance2 = squared(cell, from);
      best = cell;
    }
  }
  return best;
}

Cell GoalToReach(const Costmap& map, const RandomProblem& problem) {
  const Cell nearest = NearestFree(map, problem, problem.goal, INFINITY);
  if (nearest == problem.goal || nearest.x < 0) return nearest;
  const double reach = std::hypot(nearest.x - problem.goal.x, nearest.y - problem.goal.y) + 5.0;
  return NearestFree(map, problem, problem.start, reach * reach);
}

void ExpectSameAsReference(const Costmap& map, const RandomProblem& problem,
                           ReferenceSearch& reference, const AstarSearch& search) {
  const AstarResult& result = search.result();
  const Cell goal = GoalToReach(map, problem);
  reference.Solve(problem.start.x, problem.start.y);
  EXPECT_EQ(result.start_in_obstacle, MapRules(map).Lethal(problem.start.x, problem.start.y));
  EXPECT_EQ(result.goal_moved, goal != problem.goal);
  if (!reference.left_obstacle()) {
    EXPECT_EQ(result.status, Status::kStartEnclosed);
    return;
  }
  EXPECT_EQ(result.goal, goal);
  if (reference.CostTo(goal.x, goal.y) == ReferenceSearch::kUnreached) {
    EXPECT_EQ(result.status, Status::kNoPath);
    return;
  }
  EXPECT_EQ(result.status, result.start_in_obstacle ? Status::kStartInObstacle
                           : result.goal_moved      ? Status::kGoalMoved
                                                    : Status::kOk);
  EXPECT_EQ(result.end, goal);
  EXPECT_EQ(result.cost, reference.CostTo(goal.x, goal.y));
  EXPECT_EQ(FaultOfPath(map, search), "");
}

TEST(AstarSearch, CostsWhatDijkstraFindsOnRandomMaps) {
  const auto map = LethalMap();
  std::map<Status, int> outcomes;
  const auto search = std::make_unique<AstarSearch>();
  ReferenceSearch reference(*map);
  for (int seed = 0; seed < kProblems; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<unsigned>(seed));
    const RandomProblem problem = MakeProblem(random, *map);
    Solve(*search, *map, problem.start, problem.goal);
    ExpectSameAsReference(*map, problem, reference, *search);
    ++outcomes[search->result().status];
    Erase(problem, *map);
    if (HasFailure()) break;
  }
  for (const Status status : {Status::kOk, Status::kGoalMoved, Status::kStartInObstacle,
                              Status::kNoPath, Status::kStartEnclosed}) {
    EXPECT_GT(outcomes[status], kProblems / 500) << StatusName(status);
  }
}

TEST(AstarSearch, CostsWhatDijkstraFindsOnWholeMaps) {
  // A thousand random boxes of some cost each, a quarter of them lethal, and rough ground on every
  // other map: costs so far that outgrow what a query begins with.
  constexpr int kGoals = 15;
  const auto search = std::make_unique<AstarSearch>();
  int reached = 0;
  for (int seed = 0; seed < kLargeMaps; ++seed) {
    Random random(static_cast<unsigned>(seed) + 6000000);
    const auto map = UniformMap(false);
    for (int box = 0; box < 1000; ++box) {
      const int left = Pick(random, 0, kMapSize_cells - 20);
      const int bottom = Pick(random, 0, kMapSize_cells - 20);
      const bool lethal = Pick(random, 0, 3) == 0;
      const int cost_q8 = Pick(random, 0, kMaxCost_q8);
      for (int cell = 0; cell < 20 * 20; ++cell) {
        const int index = (bottom + cell / 20) * kMapSize_cells + left + cell % 20;
        map->cost_q8[index] = static_cast<uint16_t>(cost_q8);
        if (lethal) SetLethal(*map, index, 255);
      }
    }
    if (seed % 2 == 0) {
      for (uint16_t& cost_q8 : map->cost_q8) {
        cost_q8 = static_cast<uint16_t>(cost_q8 / 2 + Pick(random, 0, kMaxCost_q8 / 2));
      }
    }
    const auto pick_free = [&] {
      int index = Pick(random, 0, kMapCells - 1);
      while (map->Lethal(index)) index = Pick(random, 0, kMapCells - 1);
      return map->window.FromIndex(index);
    };
    const Cell start = pick_free();
    ReferenceSearch reference(*map);
    reference.Solve(start.x, start.y);
    for (int query = 0; query < kGoals; ++query) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " query " + std::to_string(query));
      const Cell goal = pick_free();
      const AstarResult& result = Solve(*search, *map, start, goal);
      const int64_t cost = reference.CostTo(goal.x, goal.y);
      ASSERT_EQ(result.status, cost == ReferenceSearch::kUnreached ? Status::kNoPath : Status::kOk);
      if (result.status != Status::kOk) continue;
      ++reached;
      ASSERT_EQ(result.cost, cost);
      ASSERT_EQ(FaultOfPath(*map, *search), "");
    }
  }
  EXPECT_GT(reached, kLargeMaps * kGoals / 2);
}

TEST(AstarSearch, EndsAPartialPathAtTheBestCellExpanded) {
  const auto map = LethalMap();
  const auto search = std::make_unique<AstarSearch>();
  ReferenceSearch reference(*map);
  const auto heuristic = [](Cell a, Cell b) {
    const int dx = a.x < b.x ? b.x - a.x : a.x - b.x;
    const int dy = a.y < b.y ? b.y - a.y : a.y - b.y;
    return 70 * (dx < dy ? dy - dx : dx - dy) + 99 * (dx < dy ? dx : dy);
  };
  int partial_paths = 0;
  for (int seed = 0; seed < kProblems / 50; ++seed) {
    Random random(static_cast<unsigned>(seed) + 1000000);
    const RandomProblem problem = MakeProblem(random, *map);
    reference.Solve(problem.start.x, problem.start.y);
    int previous = INT32_MAX;
    for (int limit = 1; limit <= 60; ++limit) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " limit " + std::to_string(limit));
      AstarParams params;
      params.max_expansions = limit;
      const AstarResult& result = Solve(*search, *map, problem.start, problem.goal, params);
      EXPECT_LE(result.expansions, limit);
      if (!IsUsable(result.status)) break;
      EXPECT_EQ(FaultOfPath(*map, *search), "");
      EXPECT_EQ(result.cost, reference.CostTo(result.end.x, result.end.y));
      EXPECT_EQ(result.partial, result.status == Status::kPartialPath);
      if (!result.partial) break;
      ++partial_paths;
      EXPECT_EQ(result.expansions, limit);
      // More work never gives an end further off, and an end in the obstacle is the start.
      if (map->Lethal(map->window.Index(result.end))) {
        EXPECT_EQ(result.end, result.start);
      } else {
        EXPECT_LE(heuristic(result.end, result.goal), previous);
        previous = heuristic(result.end, result.goal);
      }
    }
    Erase(problem, *map);
    if (HasFailure()) break;
  }
  EXPECT_GT(partial_paths, 100);
}

void ExpectEqual(const AstarSearch& a, const AstarSearch& b) {
  EXPECT_EQ(a.result().status, b.result().status);
  EXPECT_EQ(a.result().cost, b.result().cost);
  EXPECT_EQ(a.result().expansions, b.result().expansions);
  EXPECT_EQ(a.result().path_cells, b.result().path_cells);
  if (!IsUsable(a.result().status) || !IsUsable(b.result().status)) return;
  EXPECT_EQ(PathOf(a), PathOf(b));
}

TEST(AstarSearch, GivesTheSamePathWhateverItDidBefore) {
  const auto map = LethalMap();
  const auto veteran = std::make_unique<AstarSearch>();
  for (int query = 0; query < 400; ++query) {  // more than two rounds of the epoch
    SCOPED_TRACE("seed " + std::to_string(query));
    Random random(static_cast<unsigned>(query) + 2000000);
    const RandomProblem problem = MakeProblem(random, *map);
    const auto fresh = std::make_unique<AstarSearch>();
    Solve(*veteran, *map, problem.start, problem.goal);
    Solve(*fresh, *map, problem.start, problem.goal);
    ExpectEqual(*veteran, *fresh);
    Erase(problem, *map);
    if (HasFailure()) break;
  }
}

TEST(AstarSearch, ForgetsAQueryThatWasGivenUp) {
  const auto map = LethalMap();
  const auto search = std::make_unique<AstarSearch>();
  for (int query = 0; query < 300; ++query) {
    SCOPED_TRACE("seed " + std::to_string(query));
    Random random(static_cast<unsigned>(query) + 3000000);
    const RandomProblem problem = MakeProblem(random, *map);
    const Vec2 start = CellCenter(problem.start);
    ASSERT_EQ(search->Begin(*map, {}, CellCenter(problem.goal), start), Status::kOk);
    static_cast<void>(search->Step(*map, Pick(random, 0, 1000)));
    Solve(*search, *map, problem.start, problem.goal);
    const auto fresh = std::make_unique<AstarSearch>();
    Solve(*fresh, *map, problem.start, problem.goal);
    ExpectEqual(*search, *fresh);
    Erase(problem, *map);
    if (HasFailure()) break;
  }
}

TEST(AstarSearch, GivesTheSameResultInStepsOfAnySize) {
  const auto map = LethalMap();
  const auto whole = std::make_unique<AstarSearch>();
  const auto sliced = std::make_unique<AstarSearch>();
  for (int query = 0; query < 200; ++query) {
    SCOPED_TRACE("seed " + std::to_string(query));
    Random random(static_cast<unsigned>(query) + 4000000);
    const RandomProblem problem = MakeProblem(random, *map);
    Solve(*whole, *map, problem.start, problem.goal);
    const int largest_step = query % 3 == 0 ? 1 : 50;
    const Status begun =
        sliced->Begin(*map, {}, CellCenter(problem.start), CellCenter(problem.goal));
    ASSERT_EQ(begun, Status::kOk);
    int steps = 0;
    while (sliced->Step(*map, Pick(random, 1, largest_step)) == Progress::kBusy) {
      EXPECT_EQ(sliced->result().status, Status::kNotStarted);
      ASSERT_LE(++steps, AstarSearch::kMaxUnits);
    }
    ExpectEqual(*whole, *sliced);
    Erase(problem, *map);
    if (HasFailure()) break;
  }
}

TEST(AstarSearch, EndsEvenIfTheMapIsChangedMeanwhile) {
  const auto map = UniformMap(false);
  const auto search = std::make_unique<AstarSearch>();
  for (int query = 0; query < 10; ++query) {
    SCOPED_TRACE("seed " + std::to_string(query));
    Random random(static_cast<unsigned>(query) + 5000000);
    ASSERT_EQ(search->Begin(*map, {}, {2.0f, 3.0f}, {90.0f, 80.0f}), Status::kOk);
    int units = 0;
    while (search->Step(*map, 500) == Progress::kBusy) {
      ASSERT_LE(units += 500, AstarSearch::kMaxUnits);
      for (int change = 0; change < 2000; ++change) {
        const int index = Pick(random, 0, kMapCells - 1);
        map->flags[index] = static_cast<uint8_t>(Pick(random, 0, 4) == 0 ? Costmap::kLethal : 0);
        map->hard_depth2[index] = static_cast<uint8_t>(Pick(random, 0, 255));
        map->cost_q8[index] = static_cast<uint16_t>(Pick(random, 0, 65535));
      }
    }
    const AstarResult& result = search->result();
    EXPECT_NE(result.status, Status::kNotStarted);
    if (IsUsable(result.status)) {
      EXPECT_EQ(PathOf(*search).size(), static_cast<size_t>(result.path_cells));
    }
  }
}

}  // namespace
}  // namespace hardpack
