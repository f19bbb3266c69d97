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

bool IsHard(ReturnClass return_class) {
  return return_class == ReturnClass::kHard || return_class == ReturnClass::kPerson;
}

// The truth about the cells, from the labelled points and without the grid. The ground of a return
// is the lowest return labelled as ground within 1.5 m; where there is none, nobody can tell.
class Truth {
 public:
  explicit Truth(const std::vector<LabelledPoint>& points) : points_(points) {
    for (const LabelledPoint& item : points) {
      if (item.return_class == ReturnClass::kGround) ground_[CellOf(item)].push_back(item.point);
    }
  }

  // Cells that hold a hard return between 0.5 and 2 m above the ground.
  std::vector<Cell> Obstacles() const {
    std::map<PlaneCell, bool> found;
    for (const LabelledPoint& item : points_) {
      if (!IsHard(item.return_class)) continue;
      const float height_m = item.point.z_m - GroundAt(item);
      if (height_m > 0.5f && height_m < 2.0f) found[CellOf(item)] = true;
    }
    return CellsOf(found);
  }

  // Cells that hold ground and, among returns that are not ignored, nothing else.
  std::vector<Cell> OnlyGround() const {
    std::map<PlaneCell, bool> only;
    for (const LabelledPoint& item : points_) {
      if (item.return_class == ReturnClass::kIgnored) continue;
      const bool ground = item.return_class == ReturnClass::kGround;
      only[CellOf(item)] = ground && only.emplace(CellOf(item), true).first->second;
    }
    return CellsOf(only);
  }

  // Cells that hold ground and nothing more than 0.4 m above it: with the paper's threshold of
  // 0.5 m the way is free there, whatever the labels of the low returns.
  std::vector<Cell> DrivableGround() const {
    std::map<PlaneCell, bool> low;
    for (const LabelledPoint& item : points_) {
      if (item.return_class == ReturnClass::kIgnored || ground_.count(CellOf(item)) == 0) continue;
      const bool high = item.point.z_m - OwnGround(CellOf(item)) > 0.4f;
      low[CellOf(item)] = !high && low.emplace(CellOf(item), true).first->second;
    }
    return CellsOf(low);
  }

  // Cells that hold ground and hard returns, and all of these more than 2.1 m above it.
  std::vector<Cell> Overhead() const {
    std::map<PlaneCell, bool> overhead;
    for (const LabelledPoint& item : points_) {
      if (!IsHard(item.return_class) || ground_.count(CellOf(item)) == 0) continue;
      const bool above = item.point.z_m - OwnGround(CellOf(item)) > 2.1f;
      overhead[CellOf(item)] = above && overhead.emplace(CellOf(item), true).first->second;
    }
    return CellsOf(overhead);
  }

 private:
  static PlaneCell CellOf(const LabelledPoint& item) {
    const Cell cell = CellAt({item.point.x_m, item.point.y_m});
    return {cell.x, cell.y};
  }

  static std::vector<Cell> CellsOf(const std::map<PlaneCell, bool>& cells) {
    std::vector<Cell> list;
    for (const auto& entry : cells) {
      if (entry.second) list.push_back({entry.first.first, entry.first.second});
    }
    return list;
  }

  float OwnGround(PlaneCell cell) const {
    float lowest_m = 1.0e9f;
    for (const Vec3& hit : ground_.at(cell)) lowest_m = std::min(lowest_m, hit.z_m);
    return lowest_m;
  }

  float GroundAt(const LabelledPoint& item) const {
    const PlaneCell cell = CellOf(item);
    constexpr int kAround = 8;  // 1.5 m
    float lowest_m = 1.0e9f;
    for (int32_t y = cell.second - kAround; y <= cell.second + kAround; ++y) {
      for (int32_t x = cell.first - kAround; x <= cell.first + kAround; ++x) {
        const auto here = ground_.find({x, y});
        if (here == ground_.end()) continue;
        for (const Vec3& hit : here->second) {
          const float dx = hit.x_m - item.point.x_m;
          const float dy = hit.y_m - item.point.y_m;
          if (dx * dx + dy * dy <= 1.5f * 1.5f) lowest_m = std::min(lowest_m, hit.z_m);
        }
      }
    }
    return lowest_m;
  }

  const std::vector<LabelledPoint>& points_;
  std::map<PlaneCell, std::vector<Vec3>> ground_;
};

class RellisScan : public testing::Test {
 protected:
  void SetUp() override {
    points_ = LoadScan();
    if (points_.empty()) GTEST_SKIP() << "HARDPACK_DATA holds no rellis/rellis_000104_labelled.csv";
    for (const LabelledPoint& item : points_) {
      (void)scene_.heights().Insert(item.point, item.return_class);  // some are off the window
    }
  }

  // The share of the cells on the map that hold an obstacle of these flags.
  double ShareFlagged(const std::vector<Cell>& cells, ObstacleRule rule, int obstacles) {
    CostmapParams params;
    params.obstacle_rule = rule;
    const Costmap& map = scene_.Build(params);
    int inside = 0;
    int flagged = 0;
    for (const Cell cell : cells) {
      if (!map.window.Contains(cell)) continue;
      ++inside;
      flagged += (map.flags[map.window.Index(cell)] & obstacles) != 0;
    }
    EXPECT_GE(inside, 20);
    return static_cast<double>(flagged) / inside;
  }

  std::vector<LabelledPoint> points_;
  Scene scene_;
};

TEST_F(RellisScan, LocalGroundFindsTheObstaclesThatOneCellCannotTell) {
  const std::vector<Cell> cells = Truth(points_).Obstacles();
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
  } kinds[] = {{"only ground", Truth(points_).OnlyGround()},
               {"ground and nothing above 0.4 m", Truth(points_).DrivableGround()}};
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
  const std::vector<Cell> cells = Truth(points_).Overhead();
  const double in_cell = ShareFlagged(cells, ObstacleRule::kInCell, Costmap::kHard);
  const double local_ground = ShareFlagged(cells, ObstacleRule::kLocalGround, Costmap::kHard);
  std::cout << "cells with hard returns only above 2.1 m over their ground: " << cells.size()
            << "; flagged: in-cell rule " << in_cell << ", local ground " << local_ground << "\n";
  EXPECT_EQ(local_ground, 0.0);
  EXPECT_EQ(in_cell, 1.0);
}

}  // namespace
}  // namespace hardpack
