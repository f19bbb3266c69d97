// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/near_unknown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include "core/costmap/costmap.h"

// NearUnknown against its definition, cell by cell; and what a built map charges for it.

namespace hardpack {
namespace {

constexpr GridWindow kWindow = {{-256, 1000}};

class Random {
 public:
  explicit Random(uint32_t seed) : numbers_(seed) {}
  int Between(int low, int high) {
    return low + static_cast<int>(numbers_() % static_cast<uint32_t>(high - low + 1));
  }

 private:
  std::mt19937 numbers_;
};

Vec2 At(int column, int row) {
  return CellCenter({kWindow.origin.x + column, kWindow.origin.y + row});
}

// A map whose unknown cells, few or many, and distances to hard ones are drawn at random.
struct RandomCells {
  std::vector<uint8_t> flags = std::vector<uint8_t>(kMapCells, Costmap::kObserved);
  std::vector<uint8_t> hard_distance2 = std::vector<uint8_t>(kMapCells, kMaxDistance2_cells2);

  RandomCells(Random& random, int permille) {
    for (uint8_t& cell : flags) {
      if (random.Between(0, 999) < permille) cell = 0;
    }
    for (uint8_t& distance2 : hard_distance2) {
      if (random.Between(0, 1) == 0) distance2 = static_cast<uint8_t>(random.Between(0, 255));
    }
  }
  bool IsUnknownBesideHard(int column, int row) const {
    if (column < 0 || row < 0 || column >= kMapSize_cells || row >= kMapSize_cells) return false;
    const size_t cell = static_cast<size_t>(row * kMapSize_cells + column);
    return (flags[cell] & Costmap::kObserved) == 0 && hard_distance2[cell] < kMaxDistance2_cells2;
  }
  void Look(NearUnknown& near) const {
    for (int row = 0; row < kMapSize_cells; ++row) {
      const size_t begin = static_cast<size_t>(row) * kMapSize_cells;
      near.Look(&flags[begin], &hard_distance2[begin], row);
    }
  }
};

// Squared lengths in cells, as the header says: counted from the lidar's cell, and between cells.
struct Reference {
  const RandomCells& cells;
  int lidar_column;
  int lidar_row;
  double reach2;
  double width2;

  bool IsNearUnknown(int column, int row) const {
    const double dx = column - lidar_column;
    const double dy = row - lidar_row;
    return cells.IsUnknownBesideHard(column, row) && dx * dx + dy * dy <= reach2;
  }
  bool IsDear(int column, int row) const {
    for (int dy = -NearUnknown::kMostWidth_cells; dy <= NearUnknown::kMostWidth_cells; ++dy) {
      for (int dx = -NearUnknown::kMostWidth_cells; dx <= NearUnknown::kMostWidth_cells; ++dx) {
        if (dx * dx + dy * dy <= width2 && IsNearUnknown(column + dx, row + dy)) return true;
      }
    }
    return false;
  }
};

int DifferencesAround(Random& random, int lidar_column, int lidar_row) {
  constexpr uint16_t kBefore_q8 = 300;
  constexpr uint16_t kCost_q8 = 2304;
  constexpr int kAround = 45;
  const RandomCells cells(random, random.Between(0, 2) == 0 ? 500 : 4);
  // Never a whole number of cells, where rounding would decide.
  const double reach = random.Between(0, 40) + 0.3;
  const double width = random.Between(0, 6) + 0.3;
  auto near = std::make_unique<NearUnknown>();
  near->Begin(kWindow, {At(lidar_column, lidar_row), static_cast<float>(reach * 0.2),
                        static_cast<float>(width * 0.2)});
  std::vector<uint16_t> costs(kMapCells, kBefore_q8);
  const auto begin = [](int row) { return static_cast<size_t>(row) * kMapSize_cells; };
  cells.Look(*near);
  for (int row = 0; row < kMapSize_cells; ++row) near->AddCost(row, kCost_q8, &costs[begin(row)]);
  const double most_reach = std::min(reach, double{NearUnknown::kMostReach_cells});
  const double most_width = std::min(width, double{NearUnknown::kMostWidth_cells});
  const Reference reference = {cells, lidar_column, lidar_row, most_reach * most_reach,
                               most_width * most_width};
  int wrong = 0;
  for (int row = 0; row < kMapSize_cells; ++row) {
    for (int column = 0; column < kMapSize_cells; ++column) {
      const bool is_around =
          std::abs(column - lidar_column) < kAround && std::abs(row - lidar_row) < kAround;
      const bool is_dear = is_around && reference.IsDear(column, row);
      const int want = is_dear ? kBefore_q8 + kCost_q8 : kBefore_q8;
      if (costs[begin(row) + static_cast<size_t>(column)] != want) ++wrong;
    }
  }
  return wrong;
}

TEST(NearUnknown, IsWhatItsDefinitionSaysOnRandomMaps) {
  Random random(20260);
  for (int k = 0; k < 60; ++k) {
    const int column = random.Between(0, kMapSize_cells - 1);
    const int row = random.Between(0, kMapSize_cells - 1);
    EXPECT_EQ(DifferencesAround(random, column, row), 0) << column << ", " << row;
  }
}

TEST(NearUnknown, IsRightInTheCornersOfTheMap) {
  Random random(4);
  for (const int column : {0, 1, 30, 33, 256, 480, 511}) {
    for (const int row : {0, 2, 31, 481, 510, 511}) {
      EXPECT_EQ(DifferencesAround(random, column, row), 0) << column << ", " << row;
    }
  }
}

TEST(NearUnknown, IsNothingForALidarThatIsNotKnownOrOffTheMap) {
  Random random(5);
  const RandomCells cells(random, 500);
  const NearUnknownParams cases[] = {
      {},
      {At(100, 100), 0.0f, 0.7f},
      {At(-1, 100), 5.0f, 0.7f},
      {At(100, 512), 5.0f, 0.7f},
      {{3.0e38f, -3.0e38f}, 3.0e38f, 3.0e38f},
  };
  auto near = std::make_unique<NearUnknown>();
  for (const NearUnknownParams& params : cases) {
    near->Begin(kWindow, params);
    uint16_t costs[kMapSize_cells] = {};
    cells.Look(*near);
    for (int row = 0; row < kMapSize_cells; ++row) near->AddCost(row, 256, costs);
    for (const uint16_t cost : costs) ASSERT_EQ(cost, 0);
  }
}

// Unknown right of column 300, where it is hard in one place if that is asked for.
const Costmap& HalfSeen(CostmapBuilder& builder, const CostmapParams& params, bool has_post,
                        const NearUnknownParams& near) {
  EXPECT_EQ(builder.BeginCells(kWindow, params), Status::kOk);
  builder.SetLidar(near);
  for (int row = 0; row < kMapSize_cells; ++row) {
    for (int column = 301; column < kMapSize_cells; ++column) {
      builder.SetCell(row * kMapSize_cells + column, 0);
    }
  }
  if (has_post) builder.SetCell(250 * kMapSize_cells + 312, Costmap::kHard);
  EXPECT_EQ(builder.StepCells(CostmapBuilder::kUnits), Progress::kDone);
  return builder.result();
}

float CostOf(const Costmap& map, int column, int row) {
  return static_cast<float>(map.cost_q8[row * kMapSize_cells + column]) / 256.0f;
}

TEST(NearUnknown, IsChargedBesideTheOtherCostsAndOnlyNearTheLidarAndHardThings) {
  auto builder = std::make_unique<CostmapBuilder>();
  CostmapParams params;
  params.halo_m = 0.0f;  // the post's costs end with its region, 0.94 m
  const NearUnknownParams near = {At(290, 250), 5.0f, 0.69f};
  const Costmap& map = HalfSeen(*builder, params, true, near);
  EXPECT_EQ(CostOf(map, 303, 250), params.unknown_cost + params.near_unknown_cost);
  EXPECT_EQ(CostOf(map, 299, 250), params.near_unknown_cost);  // 0.4 m beside it
  EXPECT_EQ(CostOf(map, 296, 250), 0.0f);                      // 1 m
  EXPECT_EQ(CostOf(map, 320, 250), params.unknown_cost);       // 6 m from the lidar
  EXPECT_EQ(CostOf(map, 303, 272), params.unknown_cost);       // 4.8 m from the post
  const Costmap& elsewhere = HalfSeen(*builder, params, true, {});
  EXPECT_EQ(CostOf(elsewhere, 303, 250), params.unknown_cost);
  EXPECT_EQ(CostOf(elsewhere, 299, 250), 0.0f);
}

// Beside a ditch nothing makes it worth driving along its edge.
TEST(NearUnknown, CostsNoMoreThanElsewhereWhereNothingHardCastsAShadow) {
  auto builder = std::make_unique<CostmapBuilder>();
  const CostmapParams params;
  const Costmap& map = HalfSeen(*builder, params, false, {At(290, 250), 5.0f, 0.69f});
  for (int column = 280; column < 330; ++column) {
    ASSERT_EQ(CostOf(map, column, 250), column > 300 ? params.unknown_cost : 0.0f) << column;
  }
}

}  // namespace
}  // namespace hardpack
