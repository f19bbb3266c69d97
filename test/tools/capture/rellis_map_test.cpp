// SPDX-License-Identifier: Apache-2.0
// What the whole perception chain makes of a real scan: an OS1-64 on the vehicle of the paper,
// labelled (RELLIS-3D). The truth comes from the labelled points alone, without mapper and grid.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tuple>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"
#include "test/rellis/truth.h"
#include "tools/capture/scan_loader.h"

namespace hardpack::capture {
namespace {

using rellis::Cells;
using rellis::LabelFile;
using rellis::ShareFlagged;
using rellis::Truth;

std::string SensorFile(const std::string& ending) {
  return rellis::RecordingFile("os1-64_2048x10_legacy_reencoded" + ending);
}

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
  request.perception.mount.self_min_x_m = -2.7f;  // the recorded vehicle carries things behind it
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
    if (truth_ == nullptr) truth_ = std::make_unique<Truth>(rellis::LoadPoints());
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
