// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_acceptance.h"

#include <gtest/gtest.h>

namespace hardpack::command {
namespace {

BenchRow Row(const char* stage, const char* scene, double median_us) {
  BenchRow row;
  row.stage = stage;
  row.scene = scene;
  row.median_us = median_us;
  row.worst_us = median_us;
  row.points = 200;
  return row;
}

Acceptance Promise(const std::vector<BenchRow>& rows, const std::string& words) {
  for (const Acceptance& acceptance : JudgeRows(rows, true)) {
    if (acceptance.promise.find(words) != std::string::npos) return acceptance;
  }
  ADD_FAILURE() << "no promise about " << words;
  return {};
}

std::vector<BenchRow> CostmapsBesideOpencv(double slowest_ratio) {
  std::vector<BenchRow> rows;
  for (const char* scene : {"random_10", "random_40", "cells_10", "cells_40", "rellis"}) {
    rows.push_back(Row("costmap", scene, 100.0));
    rows.back().peers = {{.name = "opencv", .ratio = 9.0}};
  }
  rows.back().peers[0].ratio = slowest_ratio;
  return rows;
}

TEST(BenchAcceptance, HoldsTheCostmapAgainstOpencvOnEachNamedMap) {
  EXPECT_EQ(Promise(CostmapsBesideOpencv(8.1), "OpenCV").met, true);
  EXPECT_EQ(Promise(CostmapsBesideOpencv(7.9), "OpenCV").met, false);
  auto rows = CostmapsBesideOpencv(9.0);
  rows.erase(rows.begin());
  EXPECT_EQ(Promise(rows, "OpenCV").met, std::nullopt);
  EXPECT_NE(Promise(rows, "OpenCV").measured.find("random_10"), std::string::npos);
}

TEST(BenchAcceptance, HoldsTheWorstCostmapAgainstTheMedianOfAllMaps) {
  std::vector<BenchRow> rows = {Row("costmap", "a", 100.0), Row("costmap", "b", 110.0),
                                Row("costmap", "c", 120.0)};
  rows[0].worst_us = 329.0;
  EXPECT_EQ(Promise(rows, "worst").met, true);
  rows[0].worst_us = 331.0;
  EXPECT_EQ(Promise(rows, "worst").met, false);
}

TEST(BenchAcceptance, HoldsTheSearchAgainstBoostOnEveryMap) {
  std::vector<BenchRow> rows = {Row("astar", "a", 100.0), Row("astar", "b", 100.0)};
  rows[0].peers = {{.name = "boost", .ratio = 10.0}};
  rows[1].peers = {{.name = "boost", .ratio = 5.01}};
  EXPECT_EQ(Promise(rows, "Boost").met, true);
  rows[1].peers[0].ratio = 4.99;
  EXPECT_EQ(Promise(rows, "Boost").met, false);
}

TEST(BenchAcceptance, TakesTheMedianMapsTimeOfAnExpansion) {
  std::vector<BenchRow> rows(3);
  for (size_t i = 0; i < 3; ++i) {
    rows[i].stage = "astar";
    rows[i].ns_per_expansion = 50.0 + 9.0 * static_cast<double>(i);
  }
  EXPECT_EQ(Promise(rows, "expansion").met, true);  // 59
  rows[1].ns_per_expansion = 61.0;
  EXPECT_EQ(Promise(rows, "expansion").met, false);
}

TEST(BenchAcceptance, HoldsTheOptimizerAgainstTheMethodWithTheBetterPath) {
  std::vector<BenchRow> rows = {Row("optimizer", "a", 100.0)};
  rows[0].peers = {{.name = "quick", .path_cost = 2.0, .ratio = 2.0},
                   {.name = "good", .path_cost = 1.0, .ratio = 41.0}};
  EXPECT_EQ(Promise(rows, "Ceres").met, true);
  rows[0].peers[0].path_cost = 0.5;
  EXPECT_EQ(Promise(rows, "Ceres").met, false);
  rows[0].points = 90;  // not the length that is promised for
  EXPECT_EQ(Promise(rows, "Ceres").met, std::nullopt);
}

TEST(BenchAcceptance, HoldsEverySpeedProfileAgainstItsTime) {
  EXPECT_EQ(Promise({Row("speed", "a", 1.9)}, "speed").met, true);
  EXPECT_EQ(Promise({Row("speed", "a", 1.0), Row("speed", "b", 2.1)}, "speed").met, false);
}

TEST(BenchAcceptance, TakesTheReplanOfTheRecordedMap) {
  EXPECT_EQ(Promise({Row("replan", "open", 1.0)}, "replan").met, std::nullopt);
  EXPECT_EQ(Promise({Row("replan", "rellis", 7999.0)}, "replan").met, true);
  EXPECT_EQ(Promise({Row("replan", "rellis", 8001.0)}, "replan").met, false);
}

TEST(BenchAcceptance, CountsTheAllocationsOfAllRows) {
  std::vector<BenchRow> rows = {Row("speed", "a", 1.0), Row("check", "a", 1.0)};
  EXPECT_EQ(Promise(rows, "heap").met, true);
  EXPECT_EQ(JudgeRows(rows, false).back().met, std::nullopt);
  rows[1].allocations = 1;
  EXPECT_EQ(Promise(rows, "heap").met, false);
}

}  // namespace
}  // namespace hardpack::command
