// SPDX-License-Identifier: Apache-2.0
// What the whole perception chain makes of a real scan: an OS1-64 on the vehicle of the paper,
// labelled (RELLIS-3D). The truth comes from the labelled points alone, without mapper and grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"
#include "core/segmentation/label_table.h"
#include "tools/capture/scan_loader.h"

namespace hardpack::capture {
namespace {

using PlaneCell = std::pair<int32_t, int32_t>;
using Cells = std::vector<Cell>;

struct LabelledPoint {
  Vec3 point;
  ReturnClass return_class;
};

std::string DataFile(const std::string& name) {
  const char* folder = std::getenv("HARDPACK_DATA");
  return (folder == nullptr ? "" : std::string(folder) + "/rellis/") + "rellis_000104_" + name;
}
std::string LabelFile() {
  return DataFile("labelled.csv");
}
std::string SensorFile(const std::string& ending) {
  return DataFile("os1-64_2048x10_legacy_reencoded") + ending;
}

PlaneCell CellOf(const Vec3& point) {
  const Cell cell = CellAt({point.x_m, point.y_m});
  return {cell.x, cell.y};
}

bool IsHard(ReturnClass return_class) {
  return return_class == ReturnClass::kHard || return_class == ReturnClass::kPerson;
}

// The sensor's frame lies parallel to the vehicle's, so its height over ground drops out. Void, the
// label of the vehicle itself, is left out. The ground of a return is the lowest return labelled as
// ground within 1.5 m; where there is none, nobody can tell.
class Truth {
 public:
  explicit Truth(const std::string& path) {
    constexpr LabelTable kTable = RellisLabelTable();
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);  // the header
    while (std::getline(file, line)) {
      std::istringstream fields(line);
      Vec3 point;
      char comma = 0;
      fields >> point.x_m >> comma >> point.y_m >> comma >> point.z_m;
      const int label = std::stoi(line.substr(line.rfind(',') + 1));
      const ReturnClass return_class = kTable.class_of[label];
      if (return_class == ReturnClass::kIgnored) continue;
      points_.push_back({point, return_class});
      if (return_class == ReturnClass::kGround) ground_[CellOf(point)].push_back(point);
    }
  }

  // Cells that hold a hard or person return between 0.5 and 2 m above the ground.
  Cells Obstacles() const {
    std::map<PlaneCell, bool> found;
    for (const LabelledPoint& item : points_) {
      if (!IsHard(item.return_class)) continue;
      const float height_m = item.point.z_m - GroundAt(item.point);
      if (height_m > 0.5f && height_m < 2.0f) found[CellOf(item.point)] = true;
    }
    return ThoseThatAre(found);
  }

  // Cells of the returns from persons more than 0.5 m above the ground.
  Cells Persons() const {
    std::map<PlaneCell, bool> found;
    for (const LabelledPoint& item : points_) {
      if (item.return_class != ReturnClass::kPerson) continue;
      if (item.point.z_m - GroundAt(item.point) > 0.5f) found[CellOf(item.point)] = true;
    }
    return ThoseThatAre(found);
  }

  // Cells that hold ground and nothing else.
  Cells OnlyGround() const {
    return CellsWithoutA(
        [](const LabelledPoint& item) { return item.return_class != ReturnClass::kGround; });
  }

  // Cells that hold ground and nothing more than 0.4 m above it: with the paper's threshold of
  // 0.5 m the way is free there, whatever the labels of the low returns.
  Cells DrivableGround() const {
    return CellsWithoutA([this](const LabelledPoint& item) {
      return item.point.z_m - LowestOf(ground_.at(CellOf(item.point))) > 0.4f;
    });
  }

 private:
  static Cells ThoseThatAre(const std::map<PlaneCell, bool>& cells) {
    Cells list;
    for (const auto& [cell, is] : cells) {
      if (is) list.push_back({cell.first, cell.second});
    }
    return list;
  }

  static float LowestOf(const std::vector<Vec3>& hits) {
    return std::min_element(hits.begin(), hits.end(),
                            [](const Vec3& a, const Vec3& b) { return a.z_m < b.z_m; })
        ->z_m;
  }

  // Of the cells that hold ground.
  Cells CellsWithoutA(const std::function<bool(const LabelledPoint&)>& spoils) const {
    std::map<PlaneCell, bool> without;
    for (const LabelledPoint& item : points_) {
      const PlaneCell cell = CellOf(item.point);
      if (ground_.count(cell) == 0) continue;
      const bool good = !spoils(item);
      without[cell] = without.emplace(cell, true).first->second && good;
    }
    return ThoseThatAre(without);
  }

  float GroundAt(const Vec3& point) const {
    constexpr float kAround_m = 1.5f;
    constexpr int kAround_cells = 8;
    const PlaneCell cell = CellOf(point);
    float lowest_m = 1.0e9f;
    for (int32_t y = cell.second - kAround_cells; y <= cell.second + kAround_cells; ++y) {
      for (int32_t x = cell.first - kAround_cells; x <= cell.first + kAround_cells; ++x) {
        const auto here = ground_.find({x, y});
        if (here == ground_.end()) continue;
        for (const Vec3& hit : here->second) {
          const float dx = hit.x_m - point.x_m;
          const float dy = hit.y_m - point.y_m;
          if (dx * dx + dy * dy <= kAround_m * kAround_m) lowest_m = std::min(lowest_m, hit.z_m);
        }
      }
    }
    return lowest_m;
  }

  std::vector<LabelledPoint> points_;
  std::map<PlaneCell, std::vector<Vec3>> ground_;
};

struct Variant {
  bool labels = true;
  ObstacleRule rule = ObstacleRule::kLocalGround;
  bool bridging = true;

  bool operator<(const Variant& other) const {
    return std::tie(labels, rule, bridging) < std::tie(other.labels, other.rule, other.bridging);
  }
};

// Shares of cells, 0 to 1.
struct Figures {
  double obstacles_hard = 0.0;
  double obstacles_seen = 0.0;  // hard or soft
  double only_ground_flagged = 0.0;
  double drivable_flagged = 0.0;
  int persons_missed = 0;   // cells neither hard nor beside a hard one
  double observed[3] = {};  // by distance from the vehicle
};
constexpr float kDistances_m[] = {5.0f, 12.0f, 20.0f, 30.0f};

std::unique_ptr<CostmapBuilder> BuildMap(const Variant& variant) {
  LidarScanRequest request;
  request.capture_path = SensorFile(".pcap");
  request.metadata_path = SensorFile(".json");
  if (variant.labels) request.labels_path = LabelFile();
  request.costmap.obstacle_rule = variant.rule;
  if (!variant.bridging) request.perception.segmentation.bridge_factor = 0.0f;
  const auto mapper = std::make_unique<Mapper>();
  LidarScanReport report;
  const ReadOutcome outcome = LoadLidarScan(request, *mapper, report);
  EXPECT_TRUE(outcome.ok()) << outcome.message;

  auto builder = std::make_unique<CostmapBuilder>();
  const uint32_t since = mapper->fold_count();
  EXPECT_EQ(builder->Begin(mapper->heights(), request.costmap), Status::kOk);
  while (builder->StepHeights(mapper->heights(), CostmapBuilder::kUnits) == Progress::kBusy) {
  }
  for (int slot = 0; slot < mapper->ring().slots(); ++slot) {
    mapper->MarkPending(slot, since, *builder);
  }
  while (builder->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
  }
  return builder;
}

double ShareFlagged(const Costmap& map, const Cells& cells, int flags) {
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

bool IsHardAround(const Costmap& map, Cell cell) {
  for (int32_t y = cell.y - 1; y <= cell.y + 1; ++y) {
    for (int32_t x = cell.x - 1; x <= cell.x + 1; ++x) {
      const Cell here = {x, y};
      if (map.window.Contains(here) && (map.flags[map.window.Index(here)] & Costmap::kHard) != 0) {
        return true;
      }
    }
  }
  return false;
}

// Of the cells whose centre is so far from the vehicle, which stands at the origin.
double ShareObserved(const Costmap& map, float from_m, float to_m) {
  int all = 0;
  int observed = 0;
  for (int i = 0; i < kMapCells; ++i) {
    const Vec2 centre = CellCenter(
        {map.window.origin.x + i % kMapSize_cells, map.window.origin.y + i / kMapSize_cells});
    const float distance2_m2 = centre.x_m * centre.x_m + centre.y_m * centre.y_m;
    if (distance2_m2 < from_m * from_m || distance2_m2 >= to_m * to_m) continue;
    ++all;
    observed += (map.flags[i] & Costmap::kObserved) != 0;
  }
  return static_cast<double>(observed) / all;
}

class RellisMap : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(LabelFile()) || !std::filesystem::exists(SensorFile(".pcap"))) {
      GTEST_SKIP() << "HARDPACK_DATA holds no rellis/rellis_000104_*";
    }
    if (truth_ == nullptr) truth_ = std::make_unique<Truth>(LabelFile());
  }

  static void TearDownTestSuite() {
    PrintTable();
    truth_.reset();
    figures_.clear();
  }

  // Each variant is run once.
  static const Figures& Of(const Variant& variant) {
    const auto known = figures_.find(variant);
    if (known != figures_.end()) return known->second;
    const auto builder = BuildMap(variant);
    const Costmap& map = builder->result();
    constexpr int kAny = Costmap::kHard | Costmap::kSoft;
    Figures figures;
    figures.obstacles_hard = ShareFlagged(map, truth_->Obstacles(), Costmap::kHard);
    figures.obstacles_seen = ShareFlagged(map, truth_->Obstacles(), kAny);
    figures.only_ground_flagged = ShareFlagged(map, truth_->OnlyGround(), kAny);
    figures.drivable_flagged = ShareFlagged(map, truth_->DrivableGround(), kAny);
    const Cells persons = truth_->Persons();
    EXPECT_GE(persons.size(), 5u);
    for (const Cell cell : persons) figures.persons_missed += IsHardAround(map, cell) ? 0 : 1;
    for (int i = 0; i < 3; ++i) {
      figures.observed[i] = ShareObserved(map, kDistances_m[i], kDistances_m[i + 1]);
    }
    return figures_[variant] = figures;
  }

  static void PrintTable() {
    if (figures_.empty()) return;
    std::printf(
        "cells: %zu with obstacles, %zu of ground alone, %zu of drivable ground, %zu of persons\n"
        "                                obstacles        ground flagged    persons  observed at\n"
        "labels  rule          bridging  hard    seen     alone   drivable  missed   5-12m  12-20m "
        " 20-30m\n",
        truth_->Obstacles().size(), truth_->OnlyGround().size(), truth_->DrivableGround().size(),
        truth_->Persons().size());
    for (const auto& [variant, row] : figures_) {
      std::printf(
          "%-6s  %-12s  %-8s  %5.1f%%  %5.1f%%  %6.2f%%  %7.2f%%  %6d  %5.1f%%  %5.1f%%  "
          "%5.1f%%\n",
          variant.labels ? "yes" : "no",
          variant.rule == ObstacleRule::kInCell ? "in cell" : "local ground",
          variant.bridging ? "yes" : "no", 100.0 * row.obstacles_hard, 100.0 * row.obstacles_seen,
          100.0 * row.only_ground_flagged, 100.0 * row.drivable_flagged, row.persons_missed,
          100.0 * row.observed[0], 100.0 * row.observed[1], 100.0 * row.observed[2]);
    }
  }

  static inline std::unique_ptr<Truth> truth_;
  static inline std::map<Variant, Figures> figures_;
};

constexpr ObstacleRule kInCell = ObstacleRule::kInCell;
constexpr ObstacleRule kLocalGround = ObstacleRule::kLocalGround;
constexpr ObstacleRule kRules[] = {kInCell, kLocalGround};

TEST_F(RellisMap, FindsTheObstaclesByTheirLabels) {
  EXPECT_GE(Of({.labels = true}).obstacles_hard, 0.92);
  EXPECT_GE(Of({.labels = true, .rule = kInCell}).obstacles_hard, 0.52);
}

// Much of what is labelled as a tree or a bush is soft by geometry, where it is low and thin.
TEST_F(RellisMap, FindsMostObstaclesByGeometryAlone) {
  EXPECT_GE(Of({.labels = false}).obstacles_hard, 0.66);
  EXPECT_GE(Of({.labels = false}).obstacles_seen, 0.74);
  EXPECT_GE(Of({.labels = false, .rule = kInCell}).obstacles_seen, 0.60);
}

TEST_F(RellisMap, LeavesTheGroundFree) {
  for (const bool labels : {false, true}) {
    for (const ObstacleRule rule : kRules) {
      const Figures figures = Of({.labels = labels, .rule = rule});
      EXPECT_LE(figures.only_ground_flagged, 0.005) << labels << static_cast<int>(rule);
      EXPECT_LE(figures.drivable_flagged, 0.005) << labels << static_cast<int>(rule);
    }
  }
}

TEST_F(RellisMap, MissesNoPerson) {
  for (const bool labels : {false, true}) {
    for (const ObstacleRule rule : kRules) {
      EXPECT_EQ(Of({.labels = labels, .rule = rule}).persons_missed, 0)
          << labels << static_cast<int>(rule);
    }
  }
}

TEST_F(RellisMap, ObservesMostOfTheGroundBetweenTheRings) {
  constexpr double kLeast[] = {0.74, 0.55, 0.27};
  for (const bool labels : {false, true}) {
    const Figures with = Of({.labels = labels});
    const Figures without = Of({.labels = labels, .bridging = false});
    for (int i = 0; i < 3; ++i) {
      EXPECT_GE(with.observed[i], kLeast[i]) << labels << i;
      EXPECT_GT(with.observed[i], without.observed[i]) << labels << i;
    }
  }
}

}  // namespace
}  // namespace hardpack::capture
