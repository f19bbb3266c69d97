// SPDX-License-Identifier: Apache-2.0
// The obstacle rules on a real scan: an OS1-64 on the vehicle of the paper, labelled (RELLIS-3D).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/costmap/costmap.h"
#include "test/core/costmap/scene.h"

namespace hardpack {
namespace {

// The ontology's classes, split as in docs/sensors.md.
ReturnClass ClassOf(int label) {
  switch (label) {
    case 17:
      return ReturnClass::kPerson;
    case 4:
    case 5:
    case 6:
    case 8:
    case 9:
    case 12:
    case 15:
    case 18:
    case 27:
    case 34:
      return ReturnClass::kHard;
    case 19:
    case 31:
    case 33:
      return ReturnClass::kSoft;
    case 1:
    case 3:
    case 10:
    case 23:
      return ReturnClass::kGround;
    default:
      return ReturnClass::kIgnored;
  }
}

struct LabelledPoint {
  Vec3 point;
  ReturnClass return_class;
};

// Empty when the recording is not there.
std::vector<LabelledPoint> LoadScan() {
  const char* folder = std::getenv("HARDPACK_DATA");
  if (folder == nullptr) return {};
  std::ifstream file(std::string(folder) + "/rellis/rellis_000104_labelled.csv");
  std::vector<LabelledPoint> points;
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    Vec3 point;
    char comma = 0;
    fields >> point.x_m >> comma >> point.y_m >> comma >> point.z_m;
    points.push_back({point, ClassOf(std::stoi(line.substr(line.rfind(',') + 1)))});
  }
  return points;
}

using PlaneCell = std::pair<int32_t, int32_t>;

// Cells that hold a hard return between 0.5 and 2 m above the ground around them. That is the
// lowest return labelled as ground within 1.5 m of the return itself: found from the points,
// without the grid. Where there is none, nobody can tell.
std::vector<Cell> CellsWithObstacles(const std::vector<LabelledPoint>& points) {
  std::map<PlaneCell, std::vector<Vec3>> ground;
  for (const LabelledPoint& item : points) {
    const Cell cell = CellAt({item.point.x_m, item.point.y_m});
    if (item.return_class == ReturnClass::kGround) ground[{cell.x, cell.y}].push_back(item.point);
  }
  std::map<PlaneCell, bool> found;
  for (const LabelledPoint& item : points) {
    if (item.return_class != ReturnClass::kHard && item.return_class != ReturnClass::kPerson) {
      continue;
    }
    const Cell cell = CellAt({item.point.x_m, item.point.y_m});
    constexpr int kAround = 8;  // 1.5 m
    float lowest_m = 1.0e9f;
    for (int32_t y = cell.y - kAround; y <= cell.y + kAround; ++y) {
      for (int32_t x = cell.x - kAround; x <= cell.x + kAround; ++x) {
        const auto here = ground.find({x, y});
        if (here == ground.end()) continue;
        for (const Vec3& hit : here->second) {
          const float dx = hit.x_m - item.point.x_m;
          const float dy = hit.y_m - item.point.y_m;
          if (dx * dx + dy * dy <= 1.5f * 1.5f) lowest_m = std::min(lowest_m, hit.z_m);
        }
      }
    }
    const float height_m = item.point.z_m - lowest_m;
    if (height_m > 0.5f && height_m < 2.0f) found[{cell.x, cell.y}] = true;
  }
  std::vector<Cell> cells;
  for (const auto& entry : found) cells.push_back({entry.first.first, entry.first.second});
  return cells;
}

class RellisScan : public testing::Test {
 protected:
  void SetUp() override {
    points_ = LoadScan();
    if (points_.empty()) GTEST_SKIP() << "HARDPACK_DATA holds no rellis/rellis_000104_labelled.csv";
    for (const LabelledPoint& item : points_) {
      (void)scene_.heights().Insert(item.point, item.return_class);  // some are off the window
    }
  }

  double ShareFlagged(const std::vector<Cell>& cells, ObstacleRule rule) {
    CostmapParams params;
    params.obstacle_rule = rule;
    const Costmap& map = scene_.Build(params);
    int inside = 0;
    int flagged = 0;
    for (const Cell cell : cells) {
      if (!map.window.Contains(cell)) continue;
      ++inside;
      flagged += (map.flags[map.window.Index(cell)] & Costmap::kHard) != 0;
    }
    EXPECT_GT(inside, 500);
    return static_cast<double>(flagged) / inside;
  }

  std::vector<LabelledPoint> points_;
  Scene scene_;
};

TEST_F(RellisScan, LocalGroundFindsTheObstaclesThatOneCellCannotTell) {
  const std::vector<Cell> cells = CellsWithObstacles(points_);
  const double in_cell = ShareFlagged(cells, ObstacleRule::kInCell);
  const double local_ground = ShareFlagged(cells, ObstacleRule::kLocalGround);
  std::cout << "cells with hard returns 0.5-2 m above ground: " << cells.size() << "; flagged: "
            << "in-cell rule " << in_cell << ", local ground " << local_ground << "\n";
  EXPECT_GE(local_ground, 0.9);
  EXPECT_LT(in_cell, local_ground - 0.2);
}

TEST_F(RellisScan, LocalGroundLeavesOverhangAndLowReturnsFree) {
  const Costmap& map = scene_.Build();
  int hard_cells = 0;
  int flagged = 0;
  for (int index = 0; index < kMapCells; ++index) {
    const HeightGrid::CellHeights heights = scene_.heights().At(map.window.FromIndex(index));
    hard_cells += heights.highest_hard_cm != HeightGrid::kNone;
    flagged += (map.flags[index] & Costmap::kHard) != 0;
  }
  std::cout << "cells with hard returns: " << hard_cells << ", flagged: " << flagged << "\n";
  EXPECT_LT(flagged, hard_cells * 3 / 4);
  EXPECT_GT(flagged, hard_cells / 4);
}

}  // namespace
}  // namespace hardpack
