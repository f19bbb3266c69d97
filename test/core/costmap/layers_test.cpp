// SPDX-License-Identifier: Apache-2.0
// Regions, distances and costs, against a reference that looks at every cell within reach.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "core/costmap/costmap.h"
#include "test/core/costmap/scene.h"

namespace hardpack {
namespace {

constexpr int kReach = 16;  // beyond it distances are saturated

// A rectangle of the map, corners included.
struct Area {
  int first_column;
  int first_row;
  int last_column;
  int last_row;

  Area Grown(int margin) const {
    return {std::max(first_column - margin, 0), std::max(first_row - margin, 0),
            std::min(last_column + margin, kMapSize_cells - 1),
            std::min(last_row + margin, kMapSize_cells - 1)};
  }
  bool Contains(int column, int row) const {
    return column >= first_column && column <= last_column && row >= first_row && row <= last_row;
  }
  template <typename Visit>
  void ForEach(Visit visit) const {
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column) visit(column, row);
    }
  }
};

constexpr Area kWholeMap = {0, 0, kMapSize_cells - 1, kMapSize_cells - 1};

using Plane = std::vector<uint8_t>;  // [kMapCells]

// Squared distance to the nearest cell of the map whose value in the plane is `value`.
int Distance2(const Plane& plane, int value, int column, int row) {
  int nearest2 = kMaxDistance2_cells2;
  const Area reach = Area{column, row, column, row}.Grown(kReach);
  for (int y = reach.first_row; y <= reach.last_row; ++y) {
    const uint8_t* cells = plane.data() + IndexOf(0, y);
    for (int x = reach.first_column; x <= reach.last_column; ++x) {
      if (cells[x] != value) continue;
      nearest2 = std::min(nearest2, (x - column) * (x - column) + (y - row) * (y - row));
    }
  }
  return nearest2;
}

struct Layer {
  Plane cells = Plane(kMapCells);   // 1: an obstacle
  Plane region = Plane(kMapCells);  // 1: inside the dilated region

  void Dilate(const Area& area, double radius_m) {
    area.ForEach([&](int column, int row) {
      const double distance_m = 0.2 * std::sqrt(Distance2(cells, 1, column, row));
      region[static_cast<size_t>(IndexOf(column, row))] = distance_m <= radius_m + 1.0e-6;
    });
  }

  double Cost(int column, int row, double edge_cost, double slope_per_m, double radius_m,
              double halo_m) const {
    const bool inside = region[static_cast<size_t>(IndexOf(column, row))] == 1;
    const int distance2 = Distance2(region, inside ? 0 : 1, column, row);
    const double s_m = 0.2 * (std::sqrt(distance2) - 0.5);
    if (inside) return edge_cost + slope_per_m * std::min(s_m, radius_m);
    return s_m < halo_m ? edge_cost * (1.0 - s_m / halo_m) * (1.0 - s_m / halo_m) : 0.0;
  }
};

// Compares a map built from `flags` [kMapCells], which are all in `area`, with the reference.
void ExpectEqualsReference(const Costmap& map, const Plane& flags, const Area& area,
                           const CostmapParams& params) {
  Layer hard;
  Layer soft;
  for (size_t i = 0; i < flags.size(); ++i) {
    hard.cells[i] = (flags[i] & Costmap::kHard) != 0;
    soft.cells[i] = flags[i] == Costmap::kSoft;
  }
  const double radius_m = static_cast<double>(params.planning_radius_m);
  const double halo_m = static_cast<double>(params.halo_m);
  hard.Dilate(area.Grown(2 * kReach), radius_m);
  soft.Dilate(area.Grown(2 * kReach), radius_m);

  int wrong = 0;
  area.Grown(2 * kReach).ForEach([&](int column, int row) {
    const int index = IndexOf(column, row);
    const size_t i = static_cast<size_t>(index);
    const bool lethal = hard.region[i] == 1;
    const double cost = hard.Cost(column, row, static_cast<double>(params.hard_edge_cost),
                                  static_cast<double>(params.hard_slope_per_m), radius_m, halo_m) +
                        soft.Cost(column, row, static_cast<double>(params.soft_edge_cost),
                                  static_cast<double>(params.soft_slope_per_m), radius_m, halo_m);
    const bool same = map.hard_distance2[i] == Distance2(hard.cells, 1, column, row) &&
                      map.Lethal(index) == lethal &&
                      ((map.flags[i] & Costmap::kSoftRegion) != 0) == (soft.region[i] == 1) &&
                      map.hard_depth2[i] == (lethal ? Distance2(hard.region, 0, column, row) : 0) &&
                      std::abs(map.cost_q8[i] - kCostOne_q8 * cost) <= 1.01;
    if (!same && ++wrong == 1) ADD_FAILURE() << "first at column " << column << ", row " << row;
  });
  EXPECT_EQ(wrong, 0);

  int not_empty = 0;
  kWholeMap.ForEach([&](int column, int row) {
    if (area.Grown(2 * kReach).Contains(column, row)) return;
    const int index = IndexOf(column, row);
    not_empty += map.cost_q8[index] != 0 || map.flags[index] != Costmap::kObserved ||
                 map.hard_depth2[index] != 0 || map.hard_distance2[index] != kMaxDistance2_cells2;
  });
  EXPECT_EQ(not_empty, 0);
}

const Costmap& BuildFrom(Scene& scene, const Plane& flags, const CostmapParams& params) {
  return scene.BuildCells(params, [&](int column, int row) {
    return flags[static_cast<size_t>(IndexOf(column, row))];
  });
}

TEST(CostmapLayers, EqualTheReferenceOnRandomScenes) {
  Scene scene;
  for (uint32_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<uint32_t>(n)); };
    constexpr int kSide = 14;
    // Every other one in a corner of the map, where the border counts.
    const int column =
        seed % 2 == 0 ? below(2) * (kMapSize_cells - kSide) : below(kMapSize_cells - kSide);
    const int row =
        seed % 2 == 0 ? below(2) * (kMapSize_cells - kSide) : below(kMapSize_cells - kSide);
    const Area area = {column, row, column + kSide - 1, row + kSide - 1};
    const int one_in = 1 << below(9);  // every cell ... a few
    Plane flags(kMapCells);
    area.ForEach([&](int x, int y) {
      if (below(one_in) != 0) return;
      flags[static_cast<size_t>(IndexOf(x, y))] = below(2) == 0 ? Costmap::kHard : Costmap::kSoft;
    });
    CostmapParams params;
    if (seed > 4) {
      params.planning_radius_m = 0.01f * static_cast<float>(below(200));
      params.halo_m = 0.01f * static_cast<float>(below(300));
      params.hard_slope_per_m = 0.1f * static_cast<float>(below(100));
    }
    ExpectEqualsReference(BuildFrom(scene, flags, params), flags, area, params);
    if (HasFailure()) return;
  }
}

TEST(CostmapLayers, EqualTheReferenceAtTheWidestRadiusAndHalo) {
  Scene scene;
  CostmapParams params;
  params.planning_radius_m = kMaxPlanningRadius_m;
  params.halo_m = kMaxHalo_m;
  params.hard_slope_per_m = 5.0f;
  params.soft_slope_per_m = 2.0f;
  const Area area = {200, 300, 212, 312};
  Plane flags(kMapCells);
  flags[static_cast<size_t>(IndexOf(206, 306))] = Costmap::kHard;
  flags[static_cast<size_t>(IndexOf(210, 302))] = Costmap::kSoft;
  ExpectEqualsReference(BuildFrom(scene, flags, params), flags, area, params);
}

//   #...#
//   .....     one cell in each corner: the regions are cut off by the border and have no way out
//   #...#     through it
TEST(CostmapLayers, EqualTheReferenceInTheCorners) {
  Scene scene;
  const CostmapParams params;
  Plane flags(kMapCells);
  constexpr int kLast = kMapSize_cells - 1;
  for (const int column : {0, kLast}) {
    for (const int row : {0, kLast}) {
      flags[static_cast<size_t>(IndexOf(column, row))] = Costmap::kHard;
    }
  }
  const Costmap& map = BuildFrom(scene, flags, params);
  for (const int column : {0, kLast}) {
    for (const int row : {0, kLast}) {
      Plane one(kMapCells);
      one[static_cast<size_t>(IndexOf(column, row))] = Costmap::kHard;
      Layer hard;
      hard.cells = one;
      const Area near = Area{column, row, column, row}.Grown(20);
      hard.Dilate(near.Grown(kReach), static_cast<double>(params.planning_radius_m));
      near.ForEach([&](int x, int y) {
        const int index = IndexOf(x, y);
        EXPECT_EQ(map.hard_distance2[index], Distance2(one, 1, x, y));
        EXPECT_EQ(map.hard_depth2[index], map.Lethal(index) ? Distance2(hard.region, 0, x, y) : 0);
      });
    }
  }
  // The way out of the corner leads to the nearest cells more than 0.94 m away, as (3, 4).
  EXPECT_EQ(map.hard_depth2[0], 25);
}

TEST(CostmapLayers, AreEmptyOnAnEmptyMap) {
  Scene scene;
  const Costmap& map = BuildFrom(scene, Plane(kMapCells), {});
  for (int index = 0; index < kMapCells; ++index) {
    ASSERT_EQ(map.cost_q8[index], 0);
    ASSERT_EQ(map.flags[index], Costmap::kObserved);
    ASSERT_EQ(map.hard_depth2[index], 0);
    ASSERT_EQ(map.hard_distance2[index], kMaxDistance2_cells2);
  }
}

TEST(CostmapLayers, SaturateWhereThereIsNoWayOut) {
  Scene scene;
  const CostmapParams params;
  const Costmap& map = BuildFrom(scene, Plane(kMapCells, Costmap::kHard), params);
  const float deepest = params.hard_edge_cost + params.hard_slope_per_m * params.planning_radius_m;
  for (int index = 0; index < kMapCells; ++index) {
    ASSERT_NEAR(map.cost_q8[index], kCostOne_q8 * deepest, 0.51f);
    ASSERT_TRUE(map.Lethal(index));
    ASSERT_EQ(map.hard_distance2[index], 0);
    ASSERT_EQ(map.hard_depth2[index], kMaxDistance2_cells2);
  }
}

// # . # .         # . . . #
// . # . #   and   # . . . #   with no dilation at all: edges everywhere, in both directions
// # . # .         # . . . #
TEST(CostmapLayers, MeasurePatternsExactly) {
  Scene scene;
  CostmapParams params;
  params.planning_radius_m = 0.0f;
  const Costmap& board = scene.BuildCells(
      params, [](int column, int row) { return (column + row) % 2 == 0 ? Costmap::kHard : 0; });
  kWholeMap.ForEach([&](int column, int row) {
    const bool hard = (column + row) % 2 == 0;
    const int index = IndexOf(column, row);
    ASSERT_EQ(board.hard_distance2[index], hard ? 0 : 1);
    ASSERT_EQ(board.hard_depth2[index], hard ? 1 : 0);
  });
  constexpr int kPeriod = 40;
  constexpr int kLastStripe = (kMapSize_cells - 1) / kPeriod * kPeriod;
  for (const bool upright : {true, false}) {
    const Costmap& stripes = scene.BuildCells(params, [&](int column, int row) {
      return (upright ? column : row) % kPeriod == 0 ? Costmap::kHard : 0;
    });
    kWholeMap.ForEach([&](int column, int row) {
      const int place = upright ? column : row;
      const int behind = place % kPeriod;
      const int ahead = place > kLastStripe ? behind : kPeriod - behind;  // after the last, none
      const int distance = std::min(behind, ahead);
      ASSERT_EQ(stripes.hard_distance2[IndexOf(column, row)],
                std::min(distance * distance, kMaxDistance2_cells2))
          << "column " << column << ", row " << row;
    });
  }
}

// A wall over the left part of the map, so that costs depend on the column alone.
//
//   ######|
//   ######|........      -> column
//   ######|
constexpr int kWallEnd = 200;

const Costmap& BuildWall(Scene& scene, uint8_t kind, const CostmapParams& params) {
  return scene.BuildCells(
      params, [kind](int column, int /*row*/) { return column <= kWallEnd ? kind : 0; });
}

// Costs along the row of a wall: index 0 is half a cell beyond the region's edge.
struct Profile {
  std::vector<double> inside;
  std::vector<double> outside;
};

Profile ProfileOf(const Costmap& map, Costmap::Flag region) {
  constexpr int kRow = 256;
  int edge = kWallEnd;  // the last column of the region
  while ((map.flags[IndexOf(edge + 1, kRow)] & region) != 0) ++edge;
  Profile profile;
  for (int i = 0; i < 20; ++i) {
    profile.inside.push_back(map.cost_q8[IndexOf(edge - i, kRow)]);
    profile.outside.push_back(map.cost_q8[IndexOf(edge + 1 + i, kRow)]);
  }
  return profile;
}

TEST(CostmapLayers, MeetAtTheEdgeWithoutAStep) {
  Scene scene;
  const CostmapParams params;
  const struct {
    uint8_t kind;
    Costmap::Flag region;
    float edge_cost;
  } layers[] = {{Costmap::kHard, Costmap::kLethal, params.hard_edge_cost},
                {Costmap::kSoft, Costmap::kSoftRegion, params.soft_edge_cost}};
  for (const auto& layer : layers) {
    const Profile profile = ProfileOf(BuildWall(scene, layer.kind, params), layer.region);
    const double edge_q8 = kCostOne_q8 * static_cast<double>(layer.edge_cost);
    // Inside the cost is linear, outside its root is: taken on to the edge, half a cell away, both
    // come to the same.
    const double from_inside = 1.5 * profile.inside[0] - 0.5 * profile.inside[1];
    const double root = 1.5 * std::sqrt(profile.outside[0]) - 0.5 * std::sqrt(profile.outside[1]);
    EXPECT_NEAR(from_inside, edge_q8, 1.0);
    EXPECT_NEAR(root * root, edge_q8, 2.0);
  }
}

TEST(CostmapLayers, FallConvexlyOutsideAndRiseToTheRadiusInside) {
  Scene scene;
  const CostmapParams params;
  const Profile profile = ProfileOf(BuildWall(scene, Costmap::kHard, params), Costmap::kLethal);
  const int halo_cells = static_cast<int>(params.halo_m / kCellSize_m + 0.5f);
  for (size_t i = 0; i + 2 < profile.outside.size(); ++i) {
    if (static_cast<int>(i) < halo_cells) {
      EXPECT_LT(profile.outside[i + 1], profile.outside[i]) << i;
    } else {
      EXPECT_EQ(profile.outside[i], 0.0) << i;
    }
    const double bend = profile.outside[i] - 2.0 * profile.outside[i + 1] + profile.outside[i + 2];
    EXPECT_GE(bend, -2.0) << i;  // two roundings
  }
  for (size_t i = 0; i + 1 < profile.inside.size(); ++i) {
    const double depth_m = (static_cast<double>(i) + 0.5) * 0.2;
    if (depth_m < static_cast<double>(params.planning_radius_m)) {
      EXPECT_GT(profile.inside[i + 1], profile.inside[i]) << i;
    } else {
      EXPECT_EQ(profile.inside[i + 1], profile.inside[i]) << i;
    }
  }
}

// From every lethal cell steps to neighbours of smaller depth lead out, and each costs less.
TEST(CostmapLayers, LeadOutOfTheLethalRegion) {
  Scene scene;
  const CostmapParams params;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const uint32_t one_in = 20u << seed;
    const Costmap& map = scene.BuildCells(params, [&](int /*column*/, int /*row*/) {
      return random() % one_in == 0 ? Costmap::kHard : 0;
    });
    const double radius_cells = static_cast<double>(params.planning_radius_m) * 5.0;
    int wrong = 0;
    kWholeMap.ForEach([&](int column, int row) {
      const int index = IndexOf(column, row);
      const int depth2 = map.hard_depth2[index];
      if (!map.Lethal(index) || depth2 == kMaxDistance2_cells2) return;
      bool leads_out = false;
      Area{column, row, column, row}.Grown(1).ForEach([&](int x, int y) {
        const int next = IndexOf(x, y);
        const bool cheaper = std::sqrt(map.hard_depth2[next]) - 0.5 >= radius_cells ||
                             map.cost_q8[next] < map.cost_q8[index];
        leads_out = leads_out || (map.hard_depth2[next] < depth2 && cheaper);
      });
      wrong += !leads_out;
    });
    EXPECT_EQ(wrong, 0);
  }
}

TEST(CostmapLayers, AddUp) {
  Scene scene;
  const CostmapParams params;
  const auto hard = [](int column, int row) { return column % 37 == 0 && row % 29 == 0; };
  const auto soft = [&](int column, int row) {
    return column % 31 == 0 && row % 23 == 0 && !hard(column, row);
  };
  const auto copy = [](const Costmap& map) {
    return std::vector<int>(map.cost_q8, map.cost_q8 + kMapCells);
  };
  const std::vector<int> only_hard = copy(scene.BuildCells(
      params, [&](int column, int row) { return hard(column, row) ? Costmap::kHard : 0; }));
  const std::vector<int> only_soft = copy(scene.BuildCells(
      params, [&](int column, int row) { return soft(column, row) ? Costmap::kSoft : 0; }));
  const std::vector<int> both = copy(scene.BuildCells(params, [&](int column, int row) {
    return hard(column, row) ? Costmap::kHard : soft(column, row) ? Costmap::kSoft : 0;
  }));
  for (size_t i = 0; i < both.size(); ++i) ASSERT_EQ(both[i], only_hard[i] + only_soft[i]);
  EXPECT_LE(*std::max_element(both.begin(), both.end()), kMaxCost_q8);
  EXPECT_GT(*std::max_element(both.begin(), both.end()),
            *std::max_element(only_hard.begin(), only_hard.end()));
}

// Every other cell's ground was not observed; an obstacle is always observed.
TEST(CostmapLayers, AddTheCostOfTheUnknown) {
  Scene scene;
  CostmapParams params;
  params.unknown_cost = 2.5f;
  CostmapBuilder& builder = scene.builder();
  const auto unknown = [](int index) { return index % 2 == 1; };
  const auto build = [&](bool all_observed) {
    EXPECT_EQ(builder.BeginCells(GridWindow::CenteredAt({}), params), Status::kOk);
    for (int index = 0; index < kMapCells; ++index) {
      if (unknown(index) && !all_observed) builder.SetCell(index, 0);
      if (index % 997 == 0) builder.SetCell(index, Costmap::kHard);
      if (index % 1009 == 0) builder.SetCell(index, Costmap::kSoft);
    }
    EXPECT_EQ(builder.StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
    const Costmap& map = builder.result();
    return std::vector<int>(map.cost_q8, map.cost_q8 + kMapCells);
  };
  const std::vector<int> observed = build(true);
  const std::vector<int> partly = build(false);
  for (int index = 0; index < kMapCells; ++index) {
    const size_t i = static_cast<size_t>(index);
    const bool obstacle = index % 997 == 0 || index % 1009 == 0;
    ASSERT_EQ(partly[i] - observed[i], unknown(index) && !obstacle ? 640 : 0) << index;
  }
}

}  // namespace
}  // namespace hardpack
