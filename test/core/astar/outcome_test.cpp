// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "core/astar/astar.h"
#include "test/core/astar/reference_search.h"
#include "test/core/astar/sketch.h"

// Every outcome by name, and input from outside that is not what it should be.

namespace hardpack {
namespace {

class AstarOutcome : public ::testing::Test {
 protected:
  const AstarResult& SolveSketch(const Sketch& sketch, const AstarParams& params = {}) {
    const AstarResult& result = Solve(*search_, *sketch.map, sketch.start, sketch.goal, params);
    if (IsUsable(result.status)) {
      EXPECT_EQ(FaultOfPath(*sketch.map, *search_), "");
    } else {
      EXPECT_EQ(result.path_cells, 0);
    }
    return result;
  }

  const std::unique_ptr<AstarSearch> search_ = std::make_unique<AstarSearch>();
};

TEST_F(AstarOutcome, IsNotStartedBeforeBegin) {
  EXPECT_EQ(search_->result().status, Status::kNotStarted);
}

TEST_F(AstarOutcome, OkWhenTheGoalIsReached) {
  const AstarResult& result = SolveSketch(Draw({"S...G"}));
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.path_cells, 5);
  EXPECT_EQ(result.cost, 4 * 70);
  EXPECT_EQ(result.end, result.goal);
}

TEST_F(AstarOutcome, OkWithOneCellWhenTheStartIsTheGoal) {
  const Sketch sketch = Draw({"S.."});
  const AstarResult& result = Solve(*search_, *sketch.map, sketch.start, sketch.start);
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.path_cells, 1);
  EXPECT_EQ(result.cost, 0);
  EXPECT_EQ(result.end, sketch.start);
}

TEST_F(AstarOutcome, NoPathWhenTheGoalIsWalledOff) {
  const AstarResult& result = SolveSketch(Draw({
      "S.#..",
      "..#G.",
  }));
  EXPECT_EQ(result.status, Status::kNoPath);
}

TEST_F(AstarOutcome, HasReachedWhatIsOnItsSideOfAWall) {
  const Sketch sketch = Draw({
      "S.#..",
      "..#G.",
      "..###",
  });
  const AstarResult& result = SolveSketch(sketch);
  ASSERT_EQ(result.status, Status::kNoPath);
  EXPECT_TRUE(search_->HasReached(sketch.start));
  EXPECT_TRUE(search_->HasReached({sketch.start.x + 1, sketch.start.y}));
  EXPECT_FALSE(search_->HasReached({sketch.start.x + 2, sketch.start.y}));
  EXPECT_FALSE(search_->HasReached(sketch.goal));
  EXPECT_FALSE(search_->HasReached({sketch.start.x + 100000, sketch.start.y}));
  // From the other side, of which the first search has told nothing.
  static_cast<void>(Solve(*search_, *sketch.map, sketch.goal, sketch.start));
  EXPECT_TRUE(search_->HasReached(sketch.goal));
  EXPECT_FALSE(search_->HasReached(sketch.start));
}

TEST_F(AstarOutcome, NoPathThroughADiagonalGap) {
  EXPECT_EQ(SolveSketch(Draw({
                            "S.#.",
                            "..#.",
                            "##.G",
                        }))
                .status,
            Status::kNoPath);
}

TEST_F(AstarOutcome, GoalOutsideMapSearchesForTheNearestCell) {
  const auto map = UniformMap(false, {1000, -2000});
  const Cell start{1100, -1900};
  const AstarResult& result = Solve(*search_, *map, start, {1000 - 300, -2000 + 7});
  EXPECT_EQ(result.status, Status::kGoalOutsideMap);
  EXPECT_TRUE(result.goal_outside_map);
  EXPECT_EQ(result.goal, (Cell{1000, -1993}));
  EXPECT_EQ(result.end, result.goal);
  EXPECT_EQ(FaultOfPath(*map, *search_), "");
}

TEST_F(AstarOutcome, GoalIsMovedToTheVehiclesSide) {
  auto map = UniformMap(false);
  for (int y = 196; y <= 204; ++y) {
    for (int x = 196; x <= 204; ++x) SetLethal(*map, map->window.Index({x, y}));
  }
  // Free cells are 5 off on each side; one that is up to 5 further will do.
  const AstarResult& result = Solve(*search_, *map, {150, 200}, {200, 200});
  EXPECT_EQ(result.status, Status::kGoalMoved);
  EXPECT_TRUE(result.goal_moved);
  EXPECT_EQ(result.goal, (Cell{190, 200}));
  EXPECT_EQ(Solve(*search_, *map, {200, 250}, {200, 200}).goal, (Cell{200, 210}));
  // Where the vehicle stands is near enough.
  EXPECT_EQ(Solve(*search_, *map, {193, 200}, {200, 200}).goal, (Cell{193, 200}));
}

TEST_F(AstarOutcome, GoalIsMovedByEuclideanDistance) {
  // One cell is 2, 2 off along the diagonal, which is less than 3; one 8 off straight, which is 5
  // further than 3 and more than 5 further than the diagonal.
  auto map = UniformMap(true);
  map->flags[map->window.Index({200, 192})] = 0;
  map->flags[map->window.Index({202, 202})] = 0;
  Solve(*search_, *map, {200, 192}, {200, 200});
  EXPECT_EQ(search_->result().goal, (Cell{202, 202}));
  EXPECT_EQ(search_->result().status, Status::kNoPath);
  EXPECT_TRUE(search_->result().goal_moved);
  map->flags[map->window.Index({202, 202})] = Costmap::kLethal;
  map->flags[map->window.Index({200, 203})] = 0;
  Solve(*search_, *map, {200, 192}, {200, 200});
  EXPECT_EQ(search_->result().goal, (Cell{200, 192}));
}

TEST_F(AstarOutcome, GoalIsMovedToWhatWasObserved) {
  // What is behind the front of a box was not: the cell in front is 3 off, the one inside 1.
  auto map = UniformMap(true);
  map->flags[map->window.Index({201, 200})] = 0;
  map->flags[map->window.Index({197, 200})] = Costmap::kObserved;
  Solve(*search_, *map, {197, 200}, {200, 200});
  EXPECT_EQ(search_->result().goal, (Cell{197, 200}));
  EXPECT_EQ(search_->result().status, Status::kGoalMoved);
}

TEST_F(AstarOutcome, GoalOffTheMapIsMovedWhenItsNearestCellIsLethal) {
  const auto map = UniformMap(false);
  SetLethal(*map, map->window.Index({511, 511}));
  const AstarResult& result = Solve(*search_, *map, {500, 500}, {600, 700});
  EXPECT_EQ(result.status, Status::kGoalMoved);
  EXPECT_TRUE(result.goal_outside_map);
  EXPECT_EQ(result.goal, (Cell{507, 507}));
}

TEST_F(AstarOutcome, GoalInObstacleIsRefusedWhenTheParameterSaysSo) {
  Sketch sketch = Draw({"S..#."});
  sketch.goal = {103, 100};
  AstarParams params;
  params.move_goal_out_of_obstacle = 0;
  EXPECT_EQ(search_->Begin(*sketch.map, params, CellCenter(sketch.start), CellCenter(sketch.goal)),
            Status::kGoalInObstacle);
  EXPECT_EQ(search_->result().status, Status::kGoalInObstacle);
  EXPECT_FALSE(search_->result().goal_moved);
  EXPECT_EQ(search_->Step(*sketch.map, 1), Progress::kDone);
  EXPECT_EQ(search_->result().status, Status::kGoalInObstacle);
}

TEST_F(AstarOutcome, StartInObstacleIsLeftAlongFallingDepth) {
  // The short way to the goal, to the right, does not fall.
  const AstarResult& result = SolveSketch(Draw({
      "....###",
      ".4s99.G",
      ".###...",
      ".......",
  }));
  EXPECT_EQ(result.status, Status::kStartInObstacle);
  EXPECT_TRUE(result.start_in_obstacle);
  EXPECT_EQ(search_->Next(result.start), (Cell{101, 101}));
}

TEST_F(AstarOutcome, StartInObstacleTakesNoDiagonalPastDeeperCells) {
  const AstarResult& around = SolveSketch(Draw({
      "s9",
      "5G",
  }));
  EXPECT_EQ(around.path_cells, 3);
  const AstarResult& across = SolveSketch(Draw({
      "s4",
      "5G",
  }));
  EXPECT_EQ(across.path_cells, 2);
}

TEST_F(AstarOutcome, StartInObstacleNeverEntersAnotherObstacle) {
  EXPECT_EQ(SolveSketch(Draw({"s5.5G"})).status, Status::kNoPath);
}

TEST_F(AstarOutcome, StartEnclosedWhenNoFallingDepthLeadsOut) {
  EXPECT_EQ(SolveSketch(Draw({
                            "99999..",
                            "9s8889G",
                            "99999..",
                        }))
                .status,
            Status::kStartEnclosed);
}

TEST_F(AstarOutcome, StartEnclosedWhereTheDepthIsSaturated) {
  auto map = UniformMap(false);
  for (int y = 100; y < 200; ++y) {
    for (int x = 100; x < 200; ++x) SetLethal(*map, map->window.Index({x, y}), 255);
  }
  EXPECT_EQ(Solve(*search_, *map, {150, 150}, {300, 300}).status, Status::kStartEnclosed);
  EXPECT_TRUE(search_->result().start_in_obstacle);
}

TEST_F(AstarOutcome, StartEnclosedWhenEveryCellIsLethal) {
  const auto map = UniformMap(true);
  EXPECT_EQ(Solve(*search_, *map, {150, 150}, {300, 300}).status, Status::kStartEnclosed);
}

TEST_F(AstarOutcome, NoPathWhenLeavingTheObstacleIsNotEnough) {
  EXPECT_EQ(SolveSketch(Draw({"..s#G"})).status, Status::kNoPath);
}

TEST_F(AstarOutcome, StartAndGoalInOneObstacleCellLeavesIt) {
  Sketch sketch = Draw({"#s."});
  sketch.goal = sketch.start;
  const AstarResult& result = SolveSketch(sketch);
  EXPECT_EQ(result.status, Status::kStartInObstacle);
  EXPECT_TRUE(result.goal_moved);
  EXPECT_EQ(result.end, (Cell{102, 100}));
  EXPECT_EQ(result.path_cells, 2);
}

TEST_F(AstarOutcome, PartialPathWhenTheExpansionLimitIsHit) {
  AstarParams params;
  params.max_expansions = 5;
  const AstarResult& result = SolveSketch(Draw({"S.........G"}), params);
  EXPECT_EQ(result.status, Status::kPartialPath);
  EXPECT_TRUE(result.partial);
  EXPECT_EQ(result.expansions, 5);
  EXPECT_EQ(result.end, (Cell{104, 100}));
  EXPECT_EQ(result.path_cells, 5);
  EXPECT_EQ(result.cost, 4 * 70);
}

TEST_F(AstarOutcome, PartialPathGoesBackToTheBestCellOfACup) {
  // The best cell is the cup's bottom, seen long before the search goes round.
  AstarParams params;
  params.max_expansions = 22;
  const AstarResult& result = SolveSketch(Draw({
                                              "...........",
                                              ".#######...",
                                              ".......#...",
                                              "S......#..G",
                                              ".......#...",
                                              ".#######...",
                                              "...........",
                                          }),
                                          params);
  EXPECT_EQ(result.status, Status::kPartialPath);
  EXPECT_EQ(result.end, (Cell{106, 103}));
}

TEST_F(AstarOutcome, PartialPathEndsAtTheCheapestOfEquallyNearCells) {
  // Both arms of the bay are expanded to their ends, but not all of what is left of the start.
  AstarParams params;
  params.max_expansions = 6;
  const AstarResult& result = SolveSketch(Draw({
                                              ".a.####",
                                              ".S####G",
                                              "...####",
                                          }),
                                          params);
  EXPECT_EQ(result.status, Status::kPartialPath);
  EXPECT_EQ(result.end, (Cell{102, 102}));
}

// Two free cells that are as near to the goal and to the start: the same one whatever comes first.
TEST_F(AstarOutcome, AGoalIsMovedToTheFirstOfCellsThatAreAsNear) {
  Sketch sketch = Draw({"...", "S#.", "..."});
  SetLethal(*sketch.map, sketch.map->window.Index({101, 101}), 4);
  SetLethal(*sketch.map, sketch.map->window.Index({100, 101}), 4);
  const AstarResult& result = Solve(*search_, *sketch.map, {102, 101}, {101, 101});
  EXPECT_EQ(result.status, Status::kGoalMoved);
  EXPECT_EQ(result.goal, (Cell{102, 101}));
  SetLethal(*sketch.map, sketch.map->window.Index({102, 101}), 4);
  Solve(*search_, *sketch.map, {102, 101}, {101, 101});
  EXPECT_EQ(search_->result().goal, (Cell{102, 100}));  // and not (102, 102), as far from both
}

TEST_F(AstarOutcome, PartialPathOfOneCellWhenOnlyTheStartMayBeExpanded) {
  AstarParams params;
  params.max_expansions = 1;
  const AstarResult& result = SolveSketch(Draw({"S...G"}), params);
  EXPECT_EQ(result.status, Status::kPartialPath);
  EXPECT_EQ(result.path_cells, 1);
  EXPECT_EQ(result.end, result.start);
}

TEST_F(AstarOutcome, IsTheGravestAndTheFlagsSayAll) {
  auto map = UniformMap(false);
  SetLethal(*map, map->window.Index({10, 10}), 4);
  SetLethal(*map, map->window.Index({511, 10}), 1);
  AstarParams params;
  EXPECT_EQ(Solve(*search_, *map, {10, 10}, {600, 10}, params).status, Status::kStartInObstacle);
  params.max_expansions = 20;
  EXPECT_EQ(Solve(*search_, *map, {10, 10}, {600, 10}, params).status, Status::kPartialPath);
  const AstarResult& result = search_->result();
  EXPECT_TRUE(result.goal_outside_map);
  EXPECT_TRUE(result.goal_moved);
  EXPECT_TRUE(result.start_in_obstacle);
  EXPECT_TRUE(result.partial);
}

TEST_F(AstarOutcome, StartOutsideMapIsRefused) {
  const auto map = UniformMap(false);
  for (const Cell start : {Cell{-1, 5}, Cell{512, 5}, Cell{5, -1}, Cell{5, 512}}) {
    EXPECT_EQ(search_->Begin(*map, {}, CellCenter(start), {1.0f, 1.0f}), Status::kStartOutsideMap);
    EXPECT_EQ(search_->result().status, Status::kStartOutsideMap);
    EXPECT_EQ(search_->Step(*map, AstarSearch::kMaxUnits), Progress::kDone);
  }
}

TEST_F(AstarOutcome, NotFiniteIsRefused) {
  const auto map = UniformMap(false);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {std::nanf(""), kInf, -kInf}) {
    EXPECT_EQ(search_->Begin(*map, {}, {bad, 1.0f}, {2.0f, 2.0f}), Status::kNotFinite);
    EXPECT_EQ(search_->Begin(*map, {}, {1.0f, bad}, {2.0f, 2.0f}), Status::kNotFinite);
    EXPECT_EQ(search_->Begin(*map, {}, {1.0f, 1.0f}, {bad, 2.0f}), Status::kNotFinite);
    EXPECT_EQ(search_->Begin(*map, {}, {1.0f, 1.0f}, {2.0f, bad}), Status::kNotFinite);
    EXPECT_EQ(search_->result().status, Status::kNotFinite);
  }
}

TEST_F(AstarOutcome, PositionsFarAwayAreJudgedLikeOthers) {
  const auto map = UniformMap(false);
  constexpr float kHuge = std::numeric_limits<float>::max();
  EXPECT_EQ(search_->Begin(*map, {}, {kHuge, 1.0f}, {1.0f, 1.0f}), Status::kStartOutsideMap);
  EXPECT_EQ(search_->Begin(*map, {}, {1.0f, -kHuge}, {1.0f, 1.0f}), Status::kStartOutsideMap);
  ASSERT_EQ(search_->Begin(*map, {}, {1.0f, 1.0f}, {-kHuge, kHuge}), Status::kOk);
  RunToEnd(*search_, *map);
  EXPECT_EQ(search_->result().status, Status::kGoalOutsideMap);
  EXPECT_EQ(search_->result().goal, (Cell{0, 511}));
}

TEST_F(AstarOutcome, ParametersOutOfRangeAreRefused) {
  const auto map = UniformMap(false);
  AstarParams params;
  for (const int32_t bad : {INT32_MIN, -1, 0, kMapCells + 1, INT32_MAX}) {
    params.max_expansions = bad;
    EXPECT_EQ(search_->Begin(*map, params, {1.0f, 1.0f}, {2.0f, 2.0f}),
              Status::kParameterOutOfRange);
  }
  params.max_expansions = kMapCells;
  EXPECT_EQ(search_->Begin(*map, params, {1.0f, 1.0f}, {2.0f, 2.0f}), Status::kOk);
  for (const int32_t bad : {INT32_MIN, -1, 2}) {
    params.move_goal_out_of_obstacle = bad;
    EXPECT_EQ(search_->Begin(*map, params, {1.0f, 1.0f}, {2.0f, 2.0f}),
              Status::kParameterOutOfRange);
  }
}

TEST_F(AstarOutcome, CostsAboveTheLargestCountAsTheLargest) {
  auto map = UniformMap(true);
  for (int x = 0; x < 512; ++x) {
    map->flags[x] = 0;
    map->cost_q8[x] = 65535;
  }
  const AstarResult& result = Solve(*search_, *map, {0, 0}, {511, 0});
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.cost, 511 * 70 * 40);
}

TEST_F(AstarOutcome, NoUnitsDoNothing) {
  const Sketch sketch = Draw({"S...G"});
  EXPECT_EQ(search_->Step(*sketch.map, 10), Progress::kDone);
  ASSERT_EQ(search_->Begin(*sketch.map, {}, CellCenter(sketch.start), CellCenter(sketch.goal)),
            Status::kOk);
  EXPECT_EQ(search_->Step(*sketch.map, 0), Progress::kBusy);
  EXPECT_EQ(search_->Step(*sketch.map, INT32_MIN), Progress::kBusy);
  EXPECT_EQ(search_->Step(*sketch.map, INT32_MAX), Progress::kDone);
  EXPECT_EQ(search_->result().status, Status::kOk);
}

}  // namespace
}  // namespace hardpack
