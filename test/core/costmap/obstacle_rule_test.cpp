// SPDX-License-Identifier: Apache-2.0
// Which cells become obstacles: each line of the rule's table, and a plain reference on random
// returns. Heights are in metres; the ground is level, at 0.
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
TEST(LocalGroundRule, SeesAnObstacleThatOneRingHits) {
  Judge({{{{kHard, 1.0f}}, 1, Costmap::kHard}});
  Judge({{{{kHard, 1.0f}}, 1, 0}}, InCell());
}

TEST(LocalGroundRule, LetsPassWhatHangsAboveTheClearance) {
  Judge({{{{kHard, 2.5f}, {kHard, 4.0f}}, 1, 0},
         {{{kHard, 2.5f}, {kGround, 0.0f}}, 1, 0},
         {{{kPerson, 2.5f}}, 1, 0}});  // up a ladder, or on a bridge
}

//   z 4    xxx
//   z 3   xxxxx     low and high returns in one cell: what lies between is not known
//   z 0.3   x
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

TEST(LocalGroundRule, TakesAPersonAsHardAtAnyHeightBelowTheClearance) {
  Judge({{{{kPerson, 1.6f}}, 1, Costmap::kHard | Costmap::kPerson},
         {{{kPerson, 0.2f}}, 1, Costmap::kHard | Costmap::kPerson},
         {{{kPerson, 0.2f}, {kHard, 0.1f}}, 1, Costmap::kHard | Costmap::kPerson}});
}

TEST(LocalGroundRule, TakesAHardReturnAsAnObstacleWhereNoGroundIsNear) {
  Judge({{{{kHard, 0.2f}}, kNowhere, Costmap::kHard},
         {{{kHard, 0.2f}}, 7, 0},               // ground in the square's last column
         {{{kHard, 0.2f}}, 8, Costmap::kHard},  // one beyond
         {{{kHard, 4.0f}}, kNowhere, Costmap::kHard},
         {{{kSoft, 0.9f}}, kNowhere, 0},
         {{{kSoft, 0.9f}, {kHard, 1.0f}}, kNowhere, Costmap::kHard},
         // A bush is not the ground but lies above it: more than the clearance over it is overhead.
         {{{kSoft, 0.9f}, {kHard, 3.0f}}, kNowhere, 0}});
}

TEST(LocalGroundRule, HoldsItsThresholds) {
  // Just at a threshold is not above it.
  Judge({{{{kHard, 0.50f}}, 1, 0},
         {{{kHard, 0.51f}}, 1, Costmap::kHard},
         {{{kSoft, 0.50f}}, 1, 0},
         {{{kSoft, 0.51f}}, 1, Costmap::kSoft},
         {{{kHard, 2.00f}}, 1, Costmap::kHard},
         {{{kHard, 2.01f}}, 1, 0}});
  CostmapParams params;
  params.obstacle_height_m = 0.2f;
  params.clearance_height_m = 1.0f;
  params.ground_window_cells = 3;
  Judge({{{{kHard, 0.3f}}, 1, Costmap::kHard},
         {{{kHard, 1.1f}}, 1, 0},
         {{{kSoft, 0.3f}}, 1, Costmap::kSoft},
         {{{kSoft, 0.3f}}, 2, 0}},  // the ground is out of the square
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
    float ground_m = 1.0e9f;
    bool ground_seen = in_cell;
    for (int y = std::max(row - half, 0); y <= std::min(row + half, kSide - 1); ++y) {
      for (int x = std::max(column - half, 0); x <= std::min(column + half, kSide - 1); ++x) {
        for (const Return& item : At(x, y)) {
          ground_m = std::min(ground_m, item.z_m);
          ground_seen = ground_seen || item.return_class == kGround;
        }
      }
    }
    bool any_hard = false, all_overhead = !in_cell, high = false, high_soft = false, person = false;
    for (const Return& item : At(column, row)) {
      const float height_m = item.z_m - ground_m;
      const bool above = height_m > params.obstacle_height_m + 0.005f;
      if (item.return_class == kSoft) high_soft = high_soft || above;
      if (item.return_class != kHard && item.return_class != kPerson) continue;
      any_hard = true;
      all_overhead = all_overhead && height_m > params.clearance_height_m + 0.005f;
      high = high || above;
      person = person || item.return_class == kPerson;
    }
    const bool hard = any_hard && !all_overhead && (high || person || !ground_seen);
    return (hard        ? Costmap::kHard
            : high_soft ? Costmap::kSoft
                        : 0) |
           (hard && person ? Costmap::kPerson : 0) |
           (At(column, row).empty() ? 0 : Costmap::kObserved);
  }

 private:
  std::vector<Return> cells_[kSide * kSide];
};

TEST(ObstacleRules, EqualAPlainReferenceOnRandomReturns) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
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
