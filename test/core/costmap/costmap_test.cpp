// SPDX-License-Identifier: Apache-2.0
// Parameters, resuming, sampling. Obstacle rules and layers have their own files.
#include "core/costmap/costmap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>

#include "test/core/costmap/scene.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// Random returns of every class in a square of the map.
void Scatter(Scene& scene, uint32_t seed) {
  std::mt19937 random(seed);
  for (int i = 0; i < 3000; ++i) {
    const int column = 200 + static_cast<int>(random() % 80);
    const int row = 200 + static_cast<int>(random() % 80);
    const float z_m = 0.01f * static_cast<float>(random() % 300);
    scene.Add(column, row, z_m, static_cast<ReturnClass>(random() % 5));
  }
}

bool Same(const Costmap& a, const Costmap& b) {
  return a.window == b.window && std::memcmp(a.cost_q8, b.cost_q8, sizeof a.cost_q8) == 0 &&
         std::memcmp(a.flags, b.flags, sizeof a.flags) == 0 &&
         std::memcmp(a.hard_distance2, b.hard_distance2, sizeof a.hard_distance2) == 0 &&
         std::memcmp(a.hard_depth2, b.hard_depth2, sizeof a.hard_depth2) == 0;
}

TEST(CostmapParams, TakesTheDefaultsAndTheExtremes) {
  EXPECT_EQ(CheckCostmapParams({}), Status::kOk);
  CostmapParams params;
  params.obstacle_rule = ObstacleRule::kInCell;
  params.ground_window_cells = 1;
  params.planning_radius_m = 0.0f;
  params.halo_m = 0.0f;
  params.obstacle_height_m = 0.0f;
  params.hard_edge_cost = 39.0f;
  params.soft_edge_cost = 0.0f;
  params.soft_slope_per_m = 0.0f;
  params.unknown_cost = 0.0f;
  EXPECT_EQ(CheckCostmapParams(params), Status::kOk);
  params = {};
  params.ground_window_cells = kMaxGroundWindow_cells;
  params.planning_radius_m = kMaxPlanningRadius_m;
  params.halo_m = kMaxHalo_m;
  params.hard_edge_cost = 7.0f;
  params.hard_slope_per_m = 7.0f;
  params.soft_slope_per_m = 3.0f;
  params.unknown_cost = 0.5f;  // 7 + 21 + 1.5 + 9 + 0.5 = 39
  params.near_unknown_cost = 39.0f;
  EXPECT_EQ(CheckCostmapParams(params), Status::kOk);
}

TEST(CostmapParams, RefusesWhatTheBuildCannotDo) {
  using Change = std::function<void(CostmapParams&)>;
  const Change changes[] = {
      [](CostmapParams& p) { p.obstacle_rule = static_cast<ObstacleRule>(2); },
      [](CostmapParams& p) { p.obstacle_rule = static_cast<ObstacleRule>(-1); },
      [](CostmapParams& p) { p.obstacle_height_m = -0.1f; },
      [](CostmapParams& p) { p.obstacle_height_m = 0.6f; },  // above growth
      [](CostmapParams& p) { p.growth_height_m = 2.0f; },    // not below the clearance
      [](CostmapParams& p) { p.growth_height_m = 0.1f; },
      [](CostmapParams& p) { p.clearance_height_m = 0.5f; },
      [](CostmapParams& p) { p.clearance_height_m = 400.0f; },
      [](CostmapParams& p) { p.ground_window_cells = 14; },
      [](CostmapParams& p) { p.ground_window_cells = -1; },
      [](CostmapParams& p) { p.ground_window_cells = 33; },
      [](CostmapParams& p) { p.ground_window_cells = INT32_MAX; },
      [](CostmapParams& p) { p.planning_radius_m = -0.1f; },
      [](CostmapParams& p) { p.planning_radius_m = 3.01f; },
      [](CostmapParams& p) { p.halo_m = -0.1f; },
      [](CostmapParams& p) { p.halo_m = 3.01f; },
      [](CostmapParams& p) { p.hard_edge_cost = -0.1f; },
      [](CostmapParams& p) { p.soft_edge_cost = -0.1f; },
      [](CostmapParams& p) { p.hard_slope_per_m = -0.1f; },
      [](CostmapParams& p) { p.soft_slope_per_m = -0.1f; },
      [](CostmapParams& p) { p.unknown_cost = -0.1f; },
      [](CostmapParams& p) { p.near_unknown_cost = -0.1f; },
      [](CostmapParams& p) { p.hard_edge_cost = 22.5f; },  // 22.5 + 11.28 + 4.32 + 1 > 39
      [](CostmapParams& p) { p.unknown_cost = 21.5f; },    // 2 + 11.28 + 4.32 + 21.5 > 39
      [](CostmapParams& p) { p.near_unknown_cost = 39.5f; },
      [](CostmapParams& p) { p.near_unknown_cost = 3.0e38f; },
      [](CostmapParams& p) { p.unknown_cost = 3.0e38f; },
      [](CostmapParams& p) { p.hard_slope_per_m = 3.0e38f; },
      [](CostmapParams& p) { p.soft_slope_per_m = 3.0e38f; },
  };
  int number = 0;
  for (const Change& change : changes) {
    CostmapParams params;
    change(params);
    EXPECT_EQ(CheckCostmapParams(params), Status::kParameterOutOfRange) << "change " << number;
    ++number;
  }
}

TEST(CostmapParams, RefusesNumbersThatAreNotFinite) {
  constexpr float CostmapParams::*kNumbers[] = {&CostmapParams::obstacle_height_m,
                                                &CostmapParams::clearance_height_m,
                                                &CostmapParams::growth_height_m,
                                                &CostmapParams::planning_radius_m,
                                                &CostmapParams::halo_m,
                                                &CostmapParams::hard_edge_cost,
                                                &CostmapParams::hard_slope_per_m,
                                                &CostmapParams::soft_edge_cost,
                                                &CostmapParams::soft_slope_per_m,
                                                &CostmapParams::unknown_cost,
                                                &CostmapParams::near_unknown_cost};
  for (float CostmapParams::*number : kNumbers) {
    for (const float bad : {kNaN, kInfinity, -kInfinity}) {
      CostmapParams params;
      params.*number = bad;
      EXPECT_EQ(CheckCostmapParams(params), Status::kParameterOutOfRange);
      params.planning_radius_m = number == &CostmapParams::planning_radius_m ? bad : 0.0f;
      EXPECT_EQ(CheckCostmapParams(params), Status::kParameterOutOfRange);
    }
  }
}

// Found by fuzzing: at distance 0, where no cell is, it was divided by.
TEST(CostmapBuilder, TakesAHaloOfNextToNothing) {
  Scene none;
  Scene next_to;
  CostmapParams params;
  params.halo_m = 0.0f;
  CostmapParams tiny = params;
  tiny.halo_m = 1.0e-40f;
  for (Scene* scene : {&none, &next_to}) {
    ASSERT_EQ(
        scene->builder().BeginCells(GridWindow::CenteredAt({}), scene == &none ? params : tiny),
        Status::kOk);
    scene->builder().SetCell(100 * kMapSize_cells + 100, Costmap::kHard | Costmap::kObserved);
    ASSERT_EQ(scene->builder().StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
  }
  EXPECT_TRUE(Same(none.builder().result(), next_to.builder().result()));
}

TEST(CostmapBuilder, HasNothingToDoBeforeItBegins) {
  Scene scene;
  EXPECT_EQ(scene.builder().Step(scene.heights(), 1), Progress::kDone);
}

TEST(CostmapBuilder, ChangesNothingWhenParametersAreRefused) {
  Scene scene;
  Scatter(scene, 1);
  const auto before = std::make_unique<Costmap>(scene.Build());
  CostmapParams bad;
  bad.halo_m = kNaN;
  ASSERT_EQ(scene.heights().Recenter({30.0f, 0.0f}), Status::kOk);
  EXPECT_EQ(scene.builder().Begin(scene.heights(), bad), Status::kParameterOutOfRange);
  EXPECT_EQ(scene.builder().BeginCells({}, bad), Status::kParameterOutOfRange);
  EXPECT_EQ(scene.builder().Step(scene.heights(), 1), Progress::kDone);
  EXPECT_TRUE(Same(scene.builder().result(), *before));
}

TEST(CostmapBuilder, GivesTheSameMapInAnySteps) {
  Scene scene;
  Scatter(scene, 2);
  const auto at_once = std::make_unique<Costmap>(scene.Build());
  CostmapBuilder& builder = scene.builder();
  std::mt19937 random(3);
  for (const int most : {1, 700}) {
    ASSERT_EQ(builder.Begin(scene.heights(), {}), Status::kOk);
    int units = 0;
    Progress progress = Progress::kBusy;
    while (progress == Progress::kBusy) {
      ASSERT_LT(units, CostmapBuilder::kUnits);
      const int step = 1 + static_cast<int>(random() % static_cast<uint32_t>(most));
      progress = builder.Step(scene.heights(), step);
      units += step;
    }
    EXPECT_GE(units, CostmapBuilder::kUnits);
    EXPECT_TRUE(Same(builder.result(), *at_once));
  }
}

TEST(CostmapBuilder, GivesTheSameMapInHalves) {
  Scene scene;
  Scatter(scene, 12);
  const auto at_once = std::make_unique<Costmap>(scene.Build());
  CostmapBuilder& builder = scene.builder();
  std::mt19937 random(13);
  for (const int most : {1, 700, 1 << 20}) {
    const auto units = [&] { return 1 + static_cast<int>(random() % static_cast<uint32_t>(most)); };
    ASSERT_EQ(builder.Begin(scene.heights(), {}), Status::kOk);
    while (builder.StepHeights(scene.heights(), units()) == Progress::kBusy) continue;
    EXPECT_EQ(builder.StepHeights(scene.heights(), INT32_MAX), Progress::kDone);
    // The heights are not needed any more.
    ASSERT_EQ(scene.heights().Reset({0.0f, 0.0f}), Status::kOk);
    while (builder.StepCells(units()) == Progress::kBusy) continue;
    EXPECT_TRUE(Same(builder.result(), *at_once));
    Scatter(scene, 12);
  }
}

TEST(CostmapBuilder, DoesNothingForNoUnits) {
  Scene scene;
  ASSERT_EQ(scene.builder().Begin(scene.heights(), {}), Status::kOk);
  EXPECT_EQ(scene.builder().Step(scene.heights(), 0), Progress::kBusy);
  EXPECT_EQ(scene.builder().Step(scene.heights(), -5), Progress::kBusy);
  EXPECT_EQ(scene.builder().Step(scene.heights(), CostmapBuilder::kUnits - 1), Progress::kBusy);
  EXPECT_EQ(scene.builder().Step(scene.heights(), INT32_MAX), Progress::kDone);
}

TEST(CostmapBuilder, ForgetsTheMapBefore) {
  Scene scene;
  const auto empty = std::make_unique<Costmap>(scene.Build());
  Scatter(scene, 4);
  ASSERT_FALSE(Same(scene.Build(), *empty));
  ASSERT_EQ(scene.heights().Reset({0.0f, 0.0f}), Status::kOk);
  EXPECT_TRUE(Same(scene.Build(), *empty));
  Scatter(scene, 5);
  (void)scene.Build();
  CostmapBuilder& builder = scene.builder();
  ASSERT_EQ(builder.BeginCells(empty->window, {}), Status::kOk);
  for (int index = 0; index < kMapCells; ++index) builder.SetCell(index, 0);
  ASSERT_EQ(builder.StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
  EXPECT_TRUE(Same(builder.result(), *empty));
}

// SR-PLN08
TEST(CostmapBuilder, ForgetsWhatWasRefused) {
  Scene scene;
  Scatter(scene, 6);
  const auto before = std::make_unique<Costmap>(scene.Build());
  CostmapBuilder& builder = scene.builder();
  builder.ForgetRefused();
  EXPECT_TRUE(Same(builder.result(), *before));
  const Cell first = before->window.origin;
  // Overlapping, and across two edges of the map.
  const Cell places[CostmapBuilder::kMaxRefused] = {{first.x + 240, first.y + 240},
                                                    {first.x + 244, first.y + 243},
                                                    first,
                                                    {first.x + 511, first.y + 230}};
  for (int round = 0; round < 2; ++round) {
    int radius_cells = CostmapBuilder::kMaxRefused_cells;
    for (const Cell& place : places) builder.Refuse(place, radius_cells--);
    for (const Cell& place : places) {
      EXPECT_TRUE(builder.result().Lethal(before->window.Index(place)));
    }
    builder.ForgetRefused();
    EXPECT_TRUE(Same(builder.result(), *before));
  }
}

TEST(CostmapBuilder, TakesCellsThatAreNotSetAsFreeAndObserved) {
  Scene scene;
  Scatter(scene, 11);
  (void)scene.Build();
  CostmapBuilder& builder = scene.builder();
  ASSERT_EQ(builder.BeginCells(GridWindow::CenteredAt({}), {}), Status::kOk);
  ASSERT_EQ(builder.StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
  for (int index = 0; index < kMapCells; ++index) {
    ASSERT_EQ(builder.result().flags[index], Costmap::kObserved);
    ASSERT_EQ(builder.result().cost_q8[index], 0);
  }
}

TEST(CostmapBuilder, GivesTheSameMapFromItsOwnFlags) {
  Scene scene;
  Scatter(scene, 6);
  CostmapParams params;
  params.max_grade = 0.0f;  // flags tell nothing of the terrain
  const auto from_heights = std::make_unique<Costmap>(scene.Build(params));
  CostmapBuilder& builder = scene.builder();
  ASSERT_EQ(builder.BeginCells(from_heights->window, params), Status::kOk);
  for (int index = 0; index < kMapCells; ++index) {
    builder.SetCell(index, from_heights->flags[index]);  // the regions among them are ignored
  }
  ASSERT_EQ(builder.StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
  EXPECT_TRUE(Same(builder.result(), *from_heights));
}

TEST(CostmapBuilder, MakesGivenCellsConsistent) {
  Scene scene;
  CostmapParams params;
  params.planning_radius_m = 0.0f;
  constexpr int kHardCell = Costmap::kHard | Costmap::kObserved | Costmap::kLethal;
  const struct {
    int given;
    int expected;
  } cases[] = {{0, 0},
               {Costmap::kObserved, Costmap::kObserved},
               {Costmap::kSoft, Costmap::kSoft | Costmap::kObserved | Costmap::kSoftRegion},
               {Costmap::kPerson, kHardCell | Costmap::kPerson},
               {Costmap::kHard | Costmap::kSoft, kHardCell},
               {Costmap::kLethal | Costmap::kSoftRegion, 0},
               {0xff, kHardCell | Costmap::kPerson}};
  CostmapBuilder& builder = scene.builder();
  ASSERT_EQ(builder.BeginCells(GridWindow::CenteredAt({}), params), Status::kOk);
  int index = 0;
  for (const auto& item : cases) builder.SetCell(index++, static_cast<uint8_t>(item.given));
  ASSERT_EQ(builder.StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
  index = 0;
  for (const auto& item : cases) {
    EXPECT_EQ(builder.result().flags[index], item.expected) << "case " << index;
    ++index;
  }
}

// From a classed cell (column) and what is marked (row) to what the cell is.
TEST(CostmapBuilder, AddsMarksToClassedCells) {
  Scene scene;
  CostmapParams params;
  params.planning_radius_m = 0.0f;
  constexpr int kObserved = Costmap::kObserved;
  constexpr int kHard = Costmap::kHard | kObserved;
  constexpr int kSoft = Costmap::kSoft | kObserved;
  constexpr int kPerson = Costmap::kPerson | kHard;
  const ReturnClass filed[] = {ReturnClass::kIgnored, ReturnClass::kGround, ReturnClass::kSoft,
                               ReturnClass::kHard, ReturnClass::kPerson};
  const struct {
    int marked;
    int expected[5];
  } rows[] = {{0, {0, kObserved, kSoft, kHard, kPerson}},
              {Costmap::kObserved, {0, kObserved, kSoft, kHard, kPerson}},
              {Costmap::kLethal, {0, kObserved, kSoft, kHard, kPerson}},
              {Costmap::kSoft, {kSoft, kSoft, kSoft, kHard, kPerson}},
              {Costmap::kHard, {kHard, kHard, kHard, kHard, kPerson}},
              {Costmap::kHard | Costmap::kSoft, {kHard, kHard, kHard, kHard, kPerson}},
              {Costmap::kPerson, {kPerson, kPerson, kPerson, kPerson, kPerson}},
              {0xff, {kPerson, kPerson, kPerson, kPerson, kPerson}}};
  constexpr int kSpacing = 40;
  const int n_rows = static_cast<int>(std::size(rows));
  for (int row = 0; row < n_rows; ++row) {
    for (int i = 0; i < 5; ++i) {
      scene.Add(kSpacing * i, kSpacing * row, filed[i] == ReturnClass::kGround ? 0.0f : 1.0f,
                filed[i]);
      scene.Add(kSpacing * i + 1, kSpacing * row, 0.0f, ReturnClass::kGround);
    }
  }
  CostmapBuilder& builder = scene.builder();
  ASSERT_EQ(builder.Begin(scene.heights(), params), Status::kOk);
  ASSERT_EQ(builder.StepHeights(scene.heights(), CostmapBuilder::kHeightUnits), Progress::kDone);
  for (int row = 0; row < n_rows; ++row) {
    for (int i = 0; i < 5; ++i) {
      builder.Mark(IndexOf(kSpacing * i, kSpacing * row), static_cast<uint8_t>(rows[row].marked));
    }
  }
  ASSERT_EQ(builder.StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
  constexpr int kRegions = Costmap::kLethal | Costmap::kSoftRegion;
  for (int row = 0; row < n_rows; ++row) {
    for (int i = 0; i < 5; ++i) {
      const int index = IndexOf(kSpacing * i, kSpacing * row);
      const int flags = builder.result().flags[index];
      EXPECT_EQ(flags & ~kRegions, rows[row].expected[i]) << "row " << row << ", column " << i;
      EXPECT_EQ((flags & Costmap::kLethal) != 0, (flags & Costmap::kHard) != 0);
      EXPECT_EQ((flags & Costmap::kSoftRegion) != 0, (flags & Costmap::kSoft) != 0);
    }
  }
}

TEST(CostmapBuilder, TakesMarksOnlyBetweenItsHalves) {
  Scene scene;
  CostmapBuilder& builder = scene.builder();
  EXPECT_DEATH(builder.Mark(0, Costmap::kHard), "");  // nothing was begun
  ASSERT_EQ(builder.BeginCells({}, {}), Status::kOk);
  EXPECT_DEATH(builder.Mark(0, Costmap::kHard), "");  // SetCell is for these
  ASSERT_EQ(builder.Begin(scene.heights(), {}), Status::kOk);
  ASSERT_EQ(builder.StepHeights(scene.heights(), CostmapBuilder::kHeightUnits - 1),
            Progress::kBusy);
  EXPECT_DEATH(builder.Mark(0, Costmap::kHard), "");
  EXPECT_DEATH((void)builder.StepCells(1), "");
  ASSERT_EQ(builder.StepHeights(scene.heights(), 1), Progress::kDone);
  EXPECT_DEATH(builder.Mark(-1, Costmap::kHard), "");
  EXPECT_DEATH(builder.Mark(kMapCells, Costmap::kHard), "");
  EXPECT_DEATH(builder.SetCell(0, Costmap::kHard), "");
  builder.Mark(0, Costmap::kHard);
  ASSERT_EQ(builder.StepCells(1), Progress::kBusy);
  EXPECT_DEATH(builder.Mark(0, Costmap::kHard), "");
}

// The window is the grid's at Begin. A cell that has left the grid by the time its row is read is
// empty; one that has not is where it was.
TEST(CostmapBuilder, BuildsOnWhileTheGridRolls) {
  Scene scene;
  constexpr int kRow = 100;
  for (const int column : {20, 60, 300}) scene.Add(column, kRow, 1.0f, ReturnClass::kHard);
  const GridWindow window = scene.heights().window();
  ASSERT_EQ(scene.builder().Begin(scene.heights(), {}), Status::kOk);
  ASSERT_EQ(scene.heights().Recenter({40.5f * kCellSize_m, 0.1f}), Status::kOk);
  ASSERT_EQ(scene.heights().window().origin.x, window.origin.x + 40);
  ASSERT_EQ(scene.builder().Step(scene.heights(), CostmapBuilder::kUnits), Progress::kDone);
  const Costmap& map = scene.builder().result();
  EXPECT_EQ(map.window, window);
  EXPECT_EQ(map.flags[IndexOf(20, kRow)], 0);
  EXPECT_NE(map.flags[IndexOf(60, kRow)] & Costmap::kHard, 0);
  EXPECT_NE(map.flags[IndexOf(300, kRow)] & Costmap::kHard, 0);
}

// Ground and returns of a row are read at different times, and still fit together.
TEST(CostmapBuilder, TakesNoNoticeOfAJumpOfAllHeightsInTheMiddle) {
  Scene scene;
  Scatter(scene, 9);
  const auto at_once = std::make_unique<Costmap>(scene.Build());
  ASSERT_EQ(scene.builder().Begin(scene.heights(), {}), Status::kOk);
  float dz_m = 0.7f;
  while (scene.builder().Step(scene.heights(), 5) == Progress::kBusy) {
    ASSERT_EQ(scene.heights().ShiftHeights(dz_m), Status::kOk);
    dz_m = -dz_m;
  }
  EXPECT_TRUE(Same(scene.builder().result(), *at_once));
}

TEST(CostmapBuilder, SurvivesAGridThatChangesInTheMiddle) {
  Scene scene;
  Scatter(scene, 7);
  std::mt19937 random(8);
  ASSERT_EQ(scene.builder().Begin(scene.heights(), {}), Status::kOk);
  while (scene.builder().Step(scene.heights(), 97) == Progress::kBusy) {
    const float x_m = 0.1f * static_cast<float>(random() % 2000) - 100.0f;
    ASSERT_EQ(scene.heights().Recenter({x_m, -x_m}), Status::kOk);
    scene.Add(static_cast<int>(random() % 512), static_cast<int>(random() % 512), 500.0f,
              ReturnClass::kHard);
  }
  for (int index = 0; index < kMapCells; ++index) {
    ASSERT_LE(scene.builder().result().cost_q8[index], kMaxCost_q8);
  }
}

TEST(CostmapBuilder, WorksAtTheEndsOfThePlane) {
  for (const float x_m : {-3.0e38f, 3.0e38f}) {
    Scene scene;
    ASSERT_EQ(scene.heights().Reset({x_m, -x_m}), Status::kOk);
    const Costmap& map = scene.Build();
    EXPECT_EQ(map.window, scene.heights().window());
    EXPECT_EQ(map.CostAt(x_m, -x_m), CostmapParams{}.unknown_cost);
  }
}

// The plain definition, in double: between the four centres around the point, all clamped.
double BilinearCost(const Costmap& map, double x_m, double y_m) {
  const auto clamp = [](double value) { return std::min(std::max(value, 0.0), 511.0); };
  const double u = clamp(x_m / 0.2 - map.window.origin.x - 0.5);
  const double v = clamp(y_m / 0.2 - map.window.origin.y - 0.5);
  double cost = 0.0;
  for (int row = 0; row < kMapSize_cells; ++row) {
    const double along = 1.0 - std::abs(v - row);
    if (along <= 0.0) continue;
    for (int column = 0; column < kMapSize_cells; ++column) {
      const double across = 1.0 - std::abs(u - column);
      if (across > 0.0) cost += along * across * map.cost_q8[IndexOf(column, row)] / 256.0;
    }
  }
  return cost;
}

class CostAt : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(scene_.heights().Reset({123.0f, -77.0f}), Status::kOk);
    Scatter(scene_, 9);
    scene_.Add(0, 0, 1.0f, ReturnClass::kHard);
    scene_.Add(511, 300, 1.0f, ReturnClass::kHard);
    map_ = &scene_.Build();
  }
  Scene scene_;
  const Costmap* map_ = nullptr;
};

TEST_F(CostAt, IsTheCellsCostAtItsCenter) {
  for (int index = 0; index < kMapCells; index += 7) {
    const Vec2 center = CellCenter(map_->window.FromIndex(index));
    ASSERT_NEAR(map_->CostAt(center.x_m, center.y_m), map_->cost_q8[index] / 256.0f, 1.0e-3f);
  }
}

TEST_F(CostAt, IsBilinearBetweenCenters) {
  std::mt19937 random(10);
  std::uniform_real_distribution<float> near(-14.0f, 14.0f);
  std::uniform_real_distribution<float> anywhere(-60.0f, 60.0f);
  for (int i = 0; i < 4000; ++i) {
    const float x_m = 123.0f + (i % 2 == 0 ? near(random) : anywhere(random));
    const float y_m = -77.0f + (i % 2 == 0 ? near(random) : anywhere(random));
    ASSERT_NEAR(map_->CostAt(x_m, y_m),
                BilinearCost(*map_, static_cast<double>(x_m), static_cast<double>(y_m)), 5.0e-3)
        << x_m << ", " << y_m;
  }
}

TEST_F(CostAt, TakesTheNearestCellOffTheWindow) {
  const float corner = static_cast<float>(map_->cost_q8[0]) / 256.0f;
  const float right = static_cast<float>(map_->cost_q8[IndexOf(511, 300)]) / 256.0f;
  const Vec2 in_row = CellCenter({0, map_->window.origin.y + 300});
  ASSERT_GT(corner, 0.0f);
  ASSERT_GT(right, 0.0f);
  for (const float far_m : {400.0f, 1.0e6f, 3.0e38f, kInfinity}) {
    EXPECT_EQ(map_->CostAt(-far_m, -far_m), corner);
    EXPECT_NEAR(map_->CostAt(far_m, in_row.y_m), right, 1.0e-3f);
  }
}

TEST_F(CostAt, GivesANumberForNaN) {
  EXPECT_EQ(map_->CostAt(kNaN, kNaN), static_cast<float>(map_->cost_q8[0]) / 256.0f);
  EXPECT_TRUE(map_->CostAt(kNaN, 0.0f) >= 0.0f);
  EXPECT_TRUE(map_->CostAt(0.0f, kNaN) >= 0.0f);
}

}  // namespace
}  // namespace hardpack
