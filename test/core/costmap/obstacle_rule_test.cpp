// SPDX-License-Identifier: Apache-2.0
// Which cells become obstacles: each line of the rule's table, scenes, and a plain reference on
// random returns. Heights are in metres; where nothing else is said, the ground is level, at 0.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/costmap/costmap.h"
#include "test/core/costmap/scene.h"

namespace hardpack {
namespace {

constexpr int kObstacleFlags = Costmap::kHard | Costmap::kSoft | Costmap::kPerson;

constexpr ReturnClass kGround = ReturnClass::kGround;
constexpr ReturnClass kSoft = ReturnClass::kSoft;
constexpr ReturnClass kHard = ReturnClass::kHard;
constexpr ReturnClass kPerson = ReturnClass::kPerson;

struct Return {
  ReturnClass return_class;
  float z_m;
};

constexpr int kNowhere = -1;

// A cell that holds `returns`, with a ground return in the cell ground_at columns away.
struct Case {
  std::vector<Return> returns;
  int ground_at;
  int expected;  // kHard, kSoft, kPerson
};

// Judges all cases in one map, each out of the reach of the others.
void Judge(const std::vector<Case>& cases, const CostmapParams& params = {}) {
  constexpr int kSpacing = 40;
  constexpr int kInRow = kMapSize_cells / kSpacing;
  const auto column_of = [](int i) { return kSpacing / 2 + kSpacing * (i % kInRow); };
  const auto row_of = [](int i) { return kSpacing / 2 + kSpacing * (i / kInRow); };
  Scene scene;
  const int n = static_cast<int>(cases.size());
  for (int i = 0; i < n; ++i) {
    const Case& item = cases[static_cast<size_t>(i)];
    for (const Return& hit : item.returns) {
      scene.Add(column_of(i), row_of(i), hit.z_m, hit.return_class);
    }
    if (item.ground_at != kNowhere) {
      scene.Add(column_of(i) + item.ground_at, row_of(i), 0.0f, kGround);
    }
  }
  const Costmap& map = scene.Build(params);
  for (int i = 0; i < n; ++i) {
    EXPECT_EQ(map.flags[IndexOf(column_of(i), row_of(i))] & kObstacleFlags,
              cases[static_cast<size_t>(i)].expected)
        << "case " << i;
  }
}

CostmapParams InCell() {
  CostmapParams params;
  params.obstacle_rule = ObstacleRule::kInCell;
  return params;
}

//   z 1.0   x        one ring of the lidar on a post: one return, the ground beside it
//   z 0.0 ....  ....
// SR-PER01
TEST(LocalGroundRule, SeesAnObstacleThatOneRingHits) {
  Judge({{{{kHard, 1.0f}}, 1, Costmap::kHard}});
  Judge({{{{kHard, 1.0f}}, 1, 0}}, InCell());
}

// SR-PER03
TEST(LocalGroundRule, LetsPassWhatHangsAboveTheClearance) {
  Judge({{{{kHard, 2.5f}, {kHard, 4.0f}}, 1, 0},
         {{{kHard, 2.5f}, {kGround, 0.0f}}, 1, 0},
         {{{kPerson, 2.5f}}, 1, 0}});  // up a ladder, or on a bridge
}

//   z 4    xxx
//   z 3   xxxxx     low and high returns in one cell: what lies between is not known
//   z 0.3   x
// SR-PER02
TEST(LocalGroundRule, TakesATrunkUnderItsCrownAsHard) {
  Judge({{{{kHard, 0.3f}, {kHard, 4.0f}}, 1, Costmap::kHard}});
}

TEST(LocalGroundRule, LetsPassWhatIsLow) {
  Judge({{{{kHard, 0.4f}}, 1, 0},
         {{{kSoft, 0.4f}}, 1, 0},
         {{{kGround, 0.4f}}, 1, 0},    // grass is classed as ground ...
         {{{kGround, 1.4f}}, 1, 0}});  // ... and ground is never an obstacle
}

TEST(LocalGroundRule, TellsSoftFromHard) {
  Judge({{{{kSoft, 0.9f}}, 1, Costmap::kSoft},
         {{{kSoft, 0.9f}, {kSoft, 0.1f}}, 1, Costmap::kSoft},
         {{{kSoft, 0.9f}, {kHard, 1.1f}}, 1, Costmap::kHard},    // a trunk in a bush
         {{{kSoft, 0.9f}, {kHard, 0.3f}}, 1, Costmap::kSoft},    // a root in a bush
         {{{kSoft, 0.9f}, {kHard, 3.0f}}, 1, Costmap::kSoft}});  // a bush under a crown
}

// SR-PER10
TEST(LocalGroundRule, TakesAPersonAsHardAtAnyHeightBelowTheClearance) {
  Judge({{{{kPerson, 1.6f}}, 1, Costmap::kHard | Costmap::kPerson},
         {{{kPerson, 0.2f}}, 1, Costmap::kHard | Costmap::kPerson},
         {{{kPerson, 0.2f}, {kHard, 0.1f}}, 1, Costmap::kHard | Costmap::kPerson}});
}

// SR-PER01
TEST(LocalGroundRule, TakesAHardReturnAsAnObstacleWhereNoGroundIsNear) {
  Judge({{{{kHard, 0.2f}}, kNowhere, Costmap::kHard},
         {{{kHard, 0.2f}}, 7, 0},               // ground in the square's last column
         {{{kHard, 0.2f}}, 8, Costmap::kHard},  // one beyond
         {{{kHard, 4.0f}}, kNowhere, Costmap::kHard},
         {{{kSoft, 0.9f}}, kNowhere, 0},
         {{{kSoft, 0.9f}, {kHard, 1.0f}}, kNowhere, Costmap::kHard},
         // Nothing is overhead where no ground is near, not even above a bush ...
         {{{kSoft, 0.9f}, {kHard, 3.0f}}, kNowhere, Costmap::kHard},
         // ... nor above ground that is further away than two cells.
         {{{kHard, 4.0f}}, 2, 0},
         {{{kHard, 4.0f}}, 3, Costmap::kHard}});
}

// SR-PER01
TEST(LocalGroundRule, HoldsItsThresholds) {
  // Just at a threshold is not above it.
  Judge({{{{kHard, 0.50f}}, 1, 0},
         {{{kHard, 0.51f}}, 1, Costmap::kHard},
         {{{kSoft, 0.50f}}, 1, 0},
         {{{kSoft, 0.51f}}, 1, Costmap::kSoft},
         {{{kHard, 2.00f}}, 1, Costmap::kHard},
         {{{kHard, 2.01f}}, 1, 0}});
  CostmapParams params;
  params.growth_height_m = 0.2f;
  params.clearance_height_m = 1.0f;
  params.ground_window_cells = 3;
  Judge({{{{kHard, 0.3f}}, 1, Costmap::kHard},
         {{{kHard, 1.1f}}, 1, 0},
         {{{kSoft, 0.3f}}, 1, Costmap::kSoft},
         {{{kSoft, 0.3f}}, 2, Costmap::kSoft},  // out of the square, but near
         {{{kSoft, 0.3f}}, 3, 0}},              // out of both
        params);
}

TEST(LocalGroundRule, WorksAtTheEndsOfTheHeightsRange) {
  // The difference of two saturated heights does not fit their type.
  Judge({{{{kHard, 1.0e6f}, {kSoft, 1.0e6f}, {kGround, -1.0e6f}}, 1, Costmap::kSoft},
         {{{kHard, 1.0e6f}, {kHard, -1.0e6f}, {kGround, -1.0e6f}}, 1, Costmap::kHard}});
}

TEST(InCellRule, MeasuresFromTheCellsLowestReturn) {
  Judge({{{{kHard, 1.0f}, {kHard, 0.4f}}, kNowhere, Costmap::kHard},
         {{{kHard, 1.0f}, {kHard, 0.6f}}, kNowhere, 0},
         {{{kHard, 1.0f}, {kGround, 0.1f}}, kNowhere, Costmap::kHard},
         {{{kSoft, 1.0f}, {kGround, 0.1f}}, kNowhere, Costmap::kSoft},
         {{{kSoft, 1.0f}, {kHard, 0.1f}}, kNowhere, Costmap::kSoft},
         {{{kHard, 6.0f}, {kHard, 4.0f}}, 1, Costmap::kHard},  // nothing is overhead
         {{{kPerson, 0.2f}}, 1, Costmap::kHard | Costmap::kPerson}},
        InCell());
}

constexpr float kSteep = 0.4663077f;  // tan 25 degrees

// A square of ground that rises by `slope` along x, where no cells are missing.
class Field {
 public:
  static constexpr int kColumn = 200;
  static constexpr int kRow = 300;
  static constexpr int kLength = 41;

  static float GroundAt(int column, float slope) {
    return slope * kCellSize_m * static_cast<float>(column - kColumn);
  }

  template <typename Missing>
  Field(Scene& scene, float slope, Missing missing) {
    for (int column = kColumn; column < kColumn + kLength; ++column) {
      for (int row = kRow; row < kRow + kLength; ++row) {
        if (!missing(column, row)) scene.Add(column, row, GroundAt(column, slope), kGround);
      }
    }
  }
};

constexpr auto kNothingMissing = [](int /*column*/, int /*row*/) { return false; };

//   ____      ____
//       \    /        no beam comes back from the ditch
//        ~~~~
TEST(LocalGroundRule, LeavesADitchUnknownAtItsCost) {
  Scene scene;
  const auto ditch = [](int column) { return column >= 215 && column < 222; };
  const Field field(scene, 0.0f, [&](int column, int /*row*/) { return ditch(column); });
  CostmapParams params;
  params.unknown_cost = 1.5f;
  const Costmap& map = scene.Build(params);
  for (int column = Field::kColumn; column < Field::kColumn + Field::kLength; ++column) {
    const int index = IndexOf(column, Field::kRow + 20);
    EXPECT_EQ(map.flags[index], ditch(column) ? 0 : Costmap::kObserved) << column;
    EXPECT_EQ(map.cost_q8[index], ditch(column) ? 384 : 0) << column;
  }
}

// As far as it is up to the heights above the ground: the grade costs what it costs.
TEST(LocalGroundRule, LeavesASteepSlopeFree) {
  Scene scene;
  const Field field(scene, kSteep, kNothingMissing);
  CostmapParams params;
  params.grade_cost = 0.0f;
  const Costmap& map = scene.Build(params);
  for (int column = Field::kColumn; column < Field::kColumn + Field::kLength; ++column) {
    EXPECT_EQ(map.flags[IndexOf(column, Field::kRow + 20)], Costmap::kObserved) << column;
    EXPECT_EQ(map.cost_q8[IndexOf(column, Field::kRow + 20)], 0) << column;
  }
}

//            x      height_m above the ground, on a slope of 25 degrees; the square's lowest ground
//         . '       lies seven cells below it, 0.65 m lower
//      . '
// The flags of the cell that holds one hard return; ground_here: and ground.
int FlagsOnSlope(float height_m, bool ground_here) {
  Scene scene;
  constexpr int kAt = Field::kColumn + 20;
  constexpr int kInRow = Field::kRow + 20;
  const Field field(scene, kSteep, [&](int column, int row) {
    return !ground_here && column == kAt && row == kInRow;
  });
  scene.Add(kAt, kInRow, Field::GroundAt(kAt, kSteep) + height_m, kHard);
  return scene.Build().flags[IndexOf(kAt, kInRow)] & kObstacleFlags;
}

TEST(LocalGroundRule, HoldsAReturnOnASlopeAgainstTheGroundUnderIt) {
  EXPECT_EQ(FlagsOnSlope(0.4f, true), 0);
  EXPECT_EQ(FlagsOnSlope(0.7f, true), Costmap::kHard);
  // The ground beside it is up to two cells lower, 0.19 m.
  EXPECT_EQ(FlagsOnSlope(0.3f, false), 0);
  EXPECT_EQ(FlagsOnSlope(0.4f, false), Costmap::kHard);
}

TEST(LocalGroundRule, TellsABranchOnASlopeFromOneOverhead) {
  EXPECT_EQ(FlagsOnSlope(1.9f, true), Costmap::kHard);
  EXPECT_EQ(FlagsOnSlope(2.5f, true), 0);
  EXPECT_EQ(FlagsOnSlope(1.8f, false), Costmap::kHard);
  EXPECT_EQ(FlagsOnSlope(2.5f, false), 0);
}

//            ______   height_m
//           |         its face: hard returns all the way up
//   ________|
// Without the terrain, which knows the ledge by itself (terrain_test.cpp).
TEST(LocalGroundRule, SeesAKerbThatIsTooHigh) {
  CostmapParams params;
  params.max_grade = 0.0f;
  for (const float height_m : {0.4f, 0.6f}) {
    Scene scene;
    constexpr int kFace = Field::kColumn + 20;
    const Field field(scene, 0.0f, [](int column, int /*row*/) { return column >= kFace; });
    for (int row = Field::kRow; row < Field::kRow + Field::kLength; ++row) {
      for (int i = 1; i <= 4; ++i) {
        scene.Add(kFace, row, 0.25f * height_m * static_cast<float>(i), kHard);
      }
      for (int column = kFace + 1; column < kFace + 10; ++column) {
        scene.Add(column, row, height_m, kGround);
      }
    }
    const Costmap& map = scene.Build(params);
    for (int column = Field::kColumn; column < kFace + 10; ++column) {
      const bool hard = column == kFace && height_m > 0.5f;
      EXPECT_EQ(map.flags[IndexOf(column, Field::kRow + 20)] & kObstacleFlags,
                hard ? Costmap::kHard : 0)
          << height_m << " m, column " << column;
    }
  }
}

// Every return of a scene, by cell.
class ReturnList {
 public:
  static constexpr int kSide = 30;

  std::vector<Return>& At(int column, int row) {
    return cells_[static_cast<size_t>(row * kSide + column)];
  }

  int Flags(int column, int row, const CostmapParams& params) {
    const bool in_cell = params.obstacle_rule == ObstacleRule::kInCell;
    const int half = in_cell ? 0 : params.ground_window_cells / 2;
    float ground_m = LowestAround(column, row, half, false);
    const bool ground_seen = in_cell || LowestAround(column, row, half, true) < kNone_m;
    float near_m = kNone_m;
    if (!in_cell) {
      const float own_m = LowestAround(column, row, 0, true);
      near_m = own_m < kNone_m ? own_m : LowestAround(column, row, 2, true);
      if (near_m < kNone_m) ground_m = near_m;
    }
    bool any_hard = false, overhead = near_m < kNone_m;
    bool high = false, high_soft = false, person = false;
    for (const Return& item : At(column, row)) {
      const bool above = item.z_m - ground_m > params.growth_height_m + 0.005f;
      if (item.return_class == kSoft) high_soft = high_soft || above;
      if (item.return_class != kHard && item.return_class != kPerson) continue;
      any_hard = true;
      overhead = overhead && item.z_m - near_m > params.clearance_height_m + 0.005f;
      high = high || above;
      person = person || item.return_class == kPerson;
    }
    const bool hard = any_hard && !overhead && (high || person || !ground_seen);
    const int obstacle = hard ? Costmap::kHard : high_soft ? Costmap::kSoft : 0;
    const bool observed = obstacle != 0 || HasGround(column, row);
    return obstacle | (hard && person ? Costmap::kPerson : 0) | (observed ? Costmap::kObserved : 0);
  }

 private:
  static constexpr float kNone_m = 1.0e9f;

  bool HasGround(int column, int row) {
    const std::vector<Return>& here = At(column, row);
    return std::any_of(here.begin(), here.end(),
                       [](const Return& item) { return item.return_class == kGround; });
  }

  // The lowest return of the cells at most `half` away; with_ground: of those that hold ground.
  float LowestAround(int column, int row, int half, bool with_ground) {
    float lowest_m = kNone_m;
    for (int y = std::max(row - half, 0); y <= std::min(row + half, kSide - 1); ++y) {
      for (int x = std::max(column - half, 0); x <= std::min(column + half, kSide - 1); ++x) {
        if (with_ground && !HasGround(x, y)) continue;
        for (const Return& item : At(x, y)) lowest_m = std::min(lowest_m, item.z_m);
      }
    }
    return lowest_m;
  }

  std::vector<Return> cells_[kSide * kSide];
};

// SR-PER01
TEST(ObstacleRules, EqualAPlainReferenceOnRandomReturns) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    Scene scene;
    ReturnList list;
    // In a corner of the map, where the square is cut off; the rest of the map is empty.
    const int returns = 50 << (random() % 7);
    const uint32_t no_ground = random() % 2;  // then few see any
    for (int i = 0; i < returns; ++i) {
      const int column = static_cast<int>(random() % ReturnList::kSide);
      const int row = static_cast<int>(random() % ReturnList::kSide);
      const float z_m = 0.01f * static_cast<float>(random() % 300);
      auto kind = static_cast<ReturnClass>(1 + random() % 4);
      if (kind == kGround && no_ground == 1 && random() % 32 != 0) kind = kHard;
      scene.Add(column, row, z_m, kind);
      list.At(column, row).push_back({kind, z_m});
    }
    CostmapParams params;
    params.max_grade = 0.0f;
    params.ground_window_cells = 1 + 2 * static_cast<int>(random() % 16);
    for (const ObstacleRule rule : {ObstacleRule::kInCell, ObstacleRule::kLocalGround}) {
      params.obstacle_rule = rule;
      const Costmap& map = scene.Build(params);
      constexpr int kKept = kObstacleFlags | Costmap::kObserved;
      for (int row = 0; row < ReturnList::kSide; ++row) {
        for (int column = 0; column < ReturnList::kSide; ++column) {
          ASSERT_EQ(map.flags[IndexOf(column, row)] & kKept, list.Flags(column, row, params))
              << "column " << column << ", row " << row;
        }
      }
    }
  }
}

}  // namespace
}  // namespace hardpack
