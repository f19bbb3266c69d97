// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/costmap/costmap.h"
#include "core/segmentation/label_table.h"

// A labelled scan of a real OS1-64 on the vehicle of the paper (RELLIS-3D), and what a map should
// hold by it: from the points and their labels alone, without segmentation, mapper and grid.

namespace hardpack::rellis {

using Cells = std::vector<Cell>;

struct LabelledPoint {
  Vec3 point;  // sensor frame, which lies parallel to the vehicle's: its height drops out
  ReturnClass return_class;
};

// A file of the recording; it need not be there.
inline std::string RecordingFile(const std::string& name) {
  const char* folder = std::getenv("HARDPACK_DATA");
  return (folder == nullptr ? "" : std::string(folder) + "/rellis/") + "rellis_000104_" + name;
}
inline std::string LabelFile() {
  return RecordingFile("labelled.csv");
}

// Without what is ignored: the void, which is the label of the vehicle itself, and the sky. Empty
// when the recording is not there.
inline std::vector<LabelledPoint> LoadPoints() {
  constexpr LabelTable kTable = RellisLabelTable();
  std::ifstream file(LabelFile());
  std::vector<LabelledPoint> points;
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    Vec3 point;
    char comma = 0;
    fields >> point.x_m >> comma >> point.y_m >> comma >> point.z_m;
    const int label = std::stoi(line.substr(line.rfind(',') + 1));
    const ReturnClass return_class = kTable.class_of[label];
    if (return_class != ReturnClass::kIgnored) points.push_back({point, return_class});
  }
  return points;
}

// The ground of a return is the lowest return labelled as ground within 1.5 m; where there is none,
// nobody can tell.
class Truth {
 public:
  explicit Truth(std::vector<LabelledPoint> points) : points_(std::move(points)) {
    for (const LabelledPoint& item : points_) {
      if (item.return_class == ReturnClass::kGround) {
        ground_[CellOf(item.point)].push_back(item.point);
      }
    }
  }

  const std::vector<LabelledPoint>& points() const { return points_; }

  // Cells that hold a hard or person return between 0.5 and 2 m above the ground.
  Cells Obstacles() const {
    return CellsWithA([this](const LabelledPoint& item) {
      const float height_m = IsHard(item) ? item.point.z_m - GroundAt(item.point) : 0.0f;
      return height_m > 0.5f && height_m < 2.0f;
    });
  }

  // Cells of the returns from persons more than 0.5 m above the ground.
  Cells Persons() const {
    return CellsWithA([this](const LabelledPoint& item) {
      return item.return_class == ReturnClass::kPerson &&
             item.point.z_m - GroundAt(item.point) > 0.5f;
    });
  }

  // Cells that hold ground and nothing else.
  Cells OnlyGround() const {
    return GroundWithoutA(
        [](const LabelledPoint& item) { return item.return_class != ReturnClass::kGround; });
  }

  // Cells that hold ground and nothing more than 0.4 m above it: with the paper's threshold of
  // 0.5 m the way is free there, whatever the labels of the low returns.
  Cells DrivableGround() const {
    return GroundWithoutA(
        [this](const LabelledPoint& item) { return AboveOwnGround(item.point) > 0.4f; });
  }

  // Cells that hold ground and hard returns, and all of these more than 2.1 m above it.
  Cells Overhead() const {
    std::map<PlaneCell, bool> overhead;
    for (const LabelledPoint& item : points_) {
      const PlaneCell cell = CellOf(item.point);
      if (!IsHard(item) || ground_.count(cell) == 0) continue;
      const bool above = AboveOwnGround(item.point) > 2.1f;
      overhead[cell] = overhead.emplace(cell, true).first->second && above;
    }
    return ThoseThatAre(overhead);
  }

 private:
  using PlaneCell = std::pair<int32_t, int32_t>;
  using Predicate = std::function<bool(const LabelledPoint&)>;

  static bool IsHard(const LabelledPoint& item) {
    return item.return_class == ReturnClass::kHard || item.return_class == ReturnClass::kPerson;
  }

  static PlaneCell CellOf(const Vec3& point) {
    const Cell cell = CellAt({point.x_m, point.y_m});
    return {cell.x, cell.y};
  }

  static Cells ThoseThatAre(const std::map<PlaneCell, bool>& cells) {
    Cells list;
    for (const auto& [cell, is] : cells) {
      if (is) list.push_back({cell.first, cell.second});
    }
    return list;
  }

  Cells CellsWithA(const Predicate& counts) const {
    std::map<PlaneCell, bool> found;
    for (const LabelledPoint& item : points_) {
      if (counts(item)) found[CellOf(item.point)] = true;
    }
    return ThoseThatAre(found);
  }

  // Of the cells that hold ground.
  Cells GroundWithoutA(const Predicate& spoils) const {
    std::map<PlaneCell, bool> without;
    for (const LabelledPoint& item : points_) {
      const PlaneCell cell = CellOf(item.point);
      if (ground_.count(cell) == 0) continue;
      const bool good = !spoils(item);
      without[cell] = without.emplace(cell, true).first->second && good;
    }
    return ThoseThatAre(without);
  }

  // Above the lowest ground of its own cell, which there must be.
  float AboveOwnGround(const Vec3& point) const {
    float lowest_m = kNoGround_m;
    for (const Vec3& hit : ground_.at(CellOf(point))) lowest_m = std::min(lowest_m, hit.z_m);
    return point.z_m - lowest_m;
  }

  float GroundAt(const Vec3& point) const {
    constexpr float kAround_m = 1.5f;
    constexpr int kAround_cells = 8;
    const PlaneCell cell = CellOf(point);
    float lowest_m = kNoGround_m;
    for (int32_t x = cell.first - kAround_cells; x <= cell.first + kAround_cells; ++x) {
      const auto behind = ground_.upper_bound({x, cell.second + kAround_cells});
      for (auto here = ground_.lower_bound({x, cell.second - kAround_cells}); here != behind;
           ++here) {
        for (const Vec3& hit : here->second) {
          const float dx_m = hit.x_m - point.x_m;
          const float dy_m = hit.y_m - point.y_m;
          const bool near = dx_m * dx_m + dy_m * dy_m <= kAround_m * kAround_m;
          if (near) lowest_m = std::min(lowest_m, hit.z_m);
        }
      }
    }
    return lowest_m;
  }

  static constexpr float kNoGround_m = 1.0e9f;

  std::vector<LabelledPoint> points_;
  std::map<PlaneCell, std::vector<Vec3>> ground_;
};

// The share of the cells on the map that hold one of these flags.
inline double ShareFlagged(const Costmap& map, const Cells& cells, int flags) {
  int inside = 0;
  int flagged = 0;
  for (const Cell cell : cells) {
    if (!map.window.Contains(cell)) continue;
    ++inside;
    flagged += (map.flags[map.window.Index(cell)] & flags) != 0;
  }
  EXPECT_GE(inside, 20);
  return static_cast<double>(flagged) / inside;
}

}  // namespace hardpack::rellis
