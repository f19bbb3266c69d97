// SPDX-License-Identifier: Apache-2.0
// The obstacle rules on a real scan: an OS1-64 on the vehicle of the paper, labelled (RELLIS-3D).
#include <gtest/gtest.h>

#include <iostream>
#include <memory>
#include <vector>

#include "core/costmap/costmap.h"
#include "test/core/costmap/scene.h"
#include "test/rellis/truth.h"

namespace hardpack {
namespace {

using rellis::LabelledPoint;
using rellis::Truth;

class RellisScan : public ::testing::Test {
 protected:
  void SetUp() override {
    truth_ = std::make_unique<Truth>(rellis::LoadPoints());
    if (truth_->points().empty()) {
      GTEST_SKIP() << "HARDPACK_DATA holds no rellis/rellis_000104_labelled.csv";
    }
    for (const LabelledPoint& item : truth_->points()) {
      (void)scene_.heights().Insert(item.point, item.return_class);  // some are off the window
    }
  }

  // The share of the cells on the map that hold an obstacle of these flags.
  double ShareFlagged(const std::vector<Cell>& cells, ObstacleRule rule, int obstacles) {
    CostmapParams params;
    params.obstacle_rule = rule;
    return rellis::ShareFlagged(scene_.Build(params), cells, obstacles);
  }

  std::unique_ptr<Truth> truth_;
  Scene scene_;
};

TEST_F(RellisScan, LocalGroundFindsTheObstaclesThatOneCellCannotTell) {
  const std::vector<Cell> cells = truth_->Obstacles();
  const double in_cell = ShareFlagged(cells, ObstacleRule::kInCell, Costmap::kHard);
  const double local_ground = ShareFlagged(cells, ObstacleRule::kLocalGround, Costmap::kHard);
  std::cout << "cells with hard returns 0.5-2 m above ground: " << cells.size() << "; flagged: "
            << "in-cell rule " << in_cell << ", local ground " << local_ground << "\n";
  EXPECT_GE(local_ground, 0.92);
  EXPECT_LT(in_cell, local_ground - 0.2);
}

TEST_F(RellisScan, BothRulesLeaveTheGroundFree) {
  constexpr int kAny = Costmap::kHard | Costmap::kSoft;
  const struct {
    const char* name;
    std::vector<Cell> cells;
  } kinds[] = {{"only ground", truth_->OnlyGround()},
               {"ground and nothing above 0.4 m", truth_->DrivableGround()}};
  for (const auto& kind : kinds) {
    const double in_cell = ShareFlagged(kind.cells, ObstacleRule::kInCell, kAny);
    const double local_ground = ShareFlagged(kind.cells, ObstacleRule::kLocalGround, kAny);
    std::cout << "cells that hold " << kind.name << ": " << kind.cells.size() << "; flagged: "
              << "in-cell rule " << in_cell << ", local ground " << local_ground << "\n";
    EXPECT_LE(in_cell, 0.02);
    EXPECT_LE(local_ground, 0.02);
  }
}

TEST_F(RellisScan, LocalGroundLeavesFreeWhatHangsOverObservedGround) {
  const std::vector<Cell> cells = truth_->Overhead();
  const double in_cell = ShareFlagged(cells, ObstacleRule::kInCell, Costmap::kHard);
  const double local_ground = ShareFlagged(cells, ObstacleRule::kLocalGround, Costmap::kHard);
  std::cout << "cells with hard returns only above 2.1 m over their ground: " << cells.size()
            << "; flagged: in-cell rule " << in_cell << ", local ground " << local_ground << "\n";
  EXPECT_EQ(local_ground, 0.0);
  EXPECT_EQ(in_cell, 1.0);
}

}  // namespace
}  // namespace hardpack
