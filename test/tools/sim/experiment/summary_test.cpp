// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/summary.h"

#include <gtest/gtest.h>

namespace hardpack::experiment {
namespace {

RunResult RunOf(uint64_t seed, bool success, double time_s, double driven_m) {
  RunResult result;
  result.world = "gap";
  result.planner = "optimizer";
  result.tracker = "full";
  result.vehicle = "warthog_paper";
  result.seed = seed;
  result.success = success;
  result.outcome = success ? Outcome::kReached : Outcome::kContact;
  result.time_s = time_s;
  result.driven_m = driven_m;
  result.clearance_m = success ? 0.4 : 0.0;
  return result;
}

// Wilson's interval by hand, n = 100, z = 1.96: 98: 0.930 .. 0.994; 100: 0.963 .. 1; 0: 0 .. 0.037.
TEST(Confidence95, IsWilsons) {
  EXPECT_NEAR(Confidence95(98, 100).low, 0.930, 0.0005);
  EXPECT_NEAR(Confidence95(98, 100).high, 0.9945, 0.0005);
  EXPECT_NEAR(Confidence95(100, 100).low, 0.963, 0.0005);
  EXPECT_NEAR(Confidence95(100, 100).high, 1.0, 1e-12);
  EXPECT_NEAR(Confidence95(0, 100).low, 0.0, 1e-12);
  EXPECT_NEAR(Confidence95(0, 100).high, 0.037, 0.0005);
  EXPECT_EQ(Confidence95(0, 0).low, 0.0);
  EXPECT_EQ(Confidence95(0, 0).high, 1.0);
}

TEST(Summarise, MeansAreOfTheSuccessesAndExtremesOfAll) {
  const std::vector<Row> rows = Summarise(
      {RunOf(3, true, 10.0, 30.0), RunOf(1, true, 20.0, 90.0), RunOf(2, false, 1.0, 1.0)});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].runs, 3);
  EXPECT_EQ(rows[0].successes, 2);
  EXPECT_DOUBLE_EQ(rows[0].mean_time_s, 15.0);
  EXPECT_DOUBLE_EQ(rows[0].mean_speed_mps, 4.0);  // 120 m in 30 s
  EXPECT_DOUBLE_EQ(rows[0].clearance_m, 0.0);
  EXPECT_EQ(rows[0].failed_seeds, std::vector<uint64_t>({2}));
  EXPECT_EQ(rows[0].outcomes[static_cast<size_t>(Outcome::kContact)], 1);
}

TEST(Summarise, KeepsEveryWayOfRunningApart) {
  RunResult other = RunOf(1, true, 1.0, 1.0);
  other.planner = "astar";
  RunResult third = RunOf(1, true, 1.0, 1.0);
  third.vehicle = "warthog_recorded";
  RunResult fourth = RunOf(1, true, 1.0, 1.0);
  fourth.labels = "100 ms";
  RunResult fifth = RunOf(1, true, 1.0, 1.0);
  fifth.max_speed_set_mps = 3.0;
  EXPECT_EQ(Summarise({RunOf(1, true, 1.0, 1.0), other, third, fourth, fifth}).size(), 5u);
}

TEST(Summarise, QuantilesAreOfAllRunsTogether) {
  RunResult one = RunOf(1, true, 1.0, 1.0);
  RunResult other = RunOf(2, true, 1.0, 1.0);
  one.cross_track_m.Add(0.011, 90);
  other.cross_track_m.Add(0.201, 10);
  one.vertical_mps2.Add(1.25, 90);
  other.vertical_mps2.Add(3.21, 10);
  const std::vector<Row> rows = Summarise({one, other});
  EXPECT_NEAR(rows[0].cross_track_m.Quantile(0.5), 0.015, 1e-9);
  EXPECT_NEAR(rows[0].cross_track_m.Quantile(0.95), 0.205, 1e-9);
  EXPECT_NEAR(rows[0].vertical_mps2.Quantile(0.95), 3.3, 1e-9);
}

TEST(Summarise, WhatTheWayShowsIsOfAllRuns) {
  RunResult one = RunOf(1, true, 1.0, 1.0);
  one.way = {.off_base_m = 1.0,
             .cross_track_m = 0.5,
             .overshoots = 2,
             .recovery_s = 1.5,
             .recovered = false,
             .side_switches = 2,
             .replans_beside = 3,
             .off_middle_m = 0.7};
  RunResult other = RunOf(2, false, 1.0, 1.0);
  other.way.off_base_m = 0.5;
  other.way.off_middle_m = 0.2;
  const std::vector<Row> rows = Summarise({one, other});
  const WayRow& way = rows[0].way;
  EXPECT_DOUBLE_EQ(way.least_off_base_m, 0.5);
  EXPECT_DOUBLE_EQ(way.mean_off_base_m, 0.75);
  EXPECT_DOUBLE_EQ(way.cross_track_m, 0.5);
  EXPECT_EQ(way.overshoots, 2);
  EXPECT_DOUBLE_EQ(way.recovery_s, 1.5);
  EXPECT_EQ(way.not_recovered, 1);
  EXPECT_EQ(way.switched_side, 1);
  EXPECT_EQ(way.replanned_beside, 1);
  EXPECT_DOUBLE_EQ(way.off_middle_m.value(), 0.7);
}

TEST(Summarise, FaultAlarmsAreThoseOfTheVehicleAndNotOfTheWorld) {
  RunResult one = RunOf(1, true, 900.0, 1.0);
  one.reasons = {{"obstacle", 7}, {"lidar_covered", 2}, {"person", 1}};
  RunResult other = RunOf(2, false, 900.0, 1.0);
  other.reasons = {{"lidar_covered", 1}, {"drives", 1}, {"no_way", 4}};
  const std::vector<Row> rows = Summarise({one, other});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].fault_alarms, 4);
  EXPECT_DOUBLE_EQ(rows[0].hours, 0.5);
  EXPECT_EQ(ToJson(rows[0])["fault_alarms"], 4);
  EXPECT_NE(ToMarkdown(rows).find("| 4 | 0.50 |"), std::string::npos) << ToMarkdown(rows);
}

// 0.06 s at 5 m/s are 0.3 m, of the columns that were considered at speed; to a bin.
TEST(Summarise, ReactionIsToldAtASpeedThatIsAskedFor) {
  RunResult one = RunOf(1, true, 1.0, 1.0);
  one.reaction_s.Add(0.158, 100);
  one.reaction_fast_s.Add(0.058, 100);
  const std::vector<Row> rows = Summarise({one});
  EXPECT_NEAR(rows[0].ReactionAt_m(5.0, 0.5), 0.3, 1e-9);
  EXPECT_NEAR(ToJson(rows[0])["reaction_at_5_mps_p99_m"].get<double>(), 0.3, 1e-9);
}

TEST(Summarise, OfNoSuccessHasNoNumberThatIsNone) {
  const std::vector<Row> rows = Summarise({RunOf(1, false, 1.0, 1.0)});
  const std::string text = ToJson(rows[0]).dump() + ToMarkdown(rows);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_NE(text.find("0/1 (0-79 %)"), std::string::npos) << text;
}

TEST(ToMarkdown, NamesTheSeedsThatFailed) {
  std::vector<RunResult> runs;
  for (uint64_t seed = 1; seed <= 20; ++seed) runs.push_back(RunOf(seed, seed > 15, 1.0, 1.0));
  const std::string text = ToMarkdown(Summarise(runs));
  EXPECT_NE(text.find("| 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, ... |"), std::string::npos) << text;
  EXPECT_NE(text.find("5/20"), std::string::npos);
}

}  // namespace
}  // namespace hardpack::experiment
