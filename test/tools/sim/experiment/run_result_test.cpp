// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/run_result.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdio>
#include <fstream>

namespace hardpack::experiment {
namespace {

RunResult Sample(uint64_t seed = 4) {
  RunResult result;
  result.world = "gap";
  result.planner = "optimizer";
  result.tracker = "full";
  result.vehicle = "warthog_paper";
  result.labels = "100 ms";
  result.max_speed_set_mps = 5.0;
  result.settings = 0x0123456789abcdef;
  result.seed = seed;
  result.outcome = Outcome::kContact;
  result.success = false;
  result.reason = "none";
  result.reasons = {{"obstacle", 2}, {"lidar_covered", 1}};
  result.time_s = 12.5;
  result.driven_m = 40.25;
  result.max_speed_mps = 4.9;
  result.clearance_m = 0.31;
  result.person_clearance_m = 3.0;
  result.jerk_rms_mps3 = 2.5;
  result.replans = 9;
  result.stops = 1;
  result.cross_track_m.Add(0.031, 100);
  result.cross_track_m.Add(0.0999, 3);
  result.cross_track_m.Add(77.0, 2);
  result.odometry_off_m = 0.61;
  result.vertical_mps2.Add(1.25, 40);
  result.reaction_s.Add(0.064, 1000);
  result.reaction_fast_s.Add(0.051, 400);
  result.reaction_m.Add(0.32, 1000);
  result.way = {.off_base_m = 1.5,
                .cross_track_m = 0.4,
                .overshoots = 2,
                .recovery_s = 0.75,
                .recovered = false,
                .side_switches = 1,
                .replans_beside = 3,
                .off_middle_m = 0.25};
  result.decision_hash = 0xfedcba9876543210;
  result.replayed = true;
  return result;
}

class RunsFile : public ::testing::Test {
 protected:
  std::string path = ::testing::TempDir() + "runs_" + std::to_string(::getpid()) + ".jsonl";
  ~RunsFile() override { std::remove(path.c_str()); }
  void Write(const std::string& text) { std::ofstream(path) << text; }
};

TEST(RunResult, IsTheSameAfterJson) {
  RunResult back;
  const RunResult sample = Sample();
  ASSERT_TRUE(FromJson(nlohmann::json::parse(ToJson(sample).dump()), back).ok());
  EXPECT_EQ(ToJson(back), ToJson(sample));
  EXPECT_EQ(back.cross_track_m, sample.cross_track_m);
  EXPECT_EQ(back.odometry_off_m, sample.odometry_off_m);
  EXPECT_EQ(back.vertical_mps2, sample.vertical_mps2);
  EXPECT_EQ(back.reasons, sample.reasons);
  EXPECT_EQ(back.reaction_m, sample.reaction_m);
  EXPECT_EQ(back.reaction_fast_s, sample.reaction_fast_s);
  EXPECT_EQ(back.decision_hash, sample.decision_hash);
  EXPECT_EQ(back.outcome, Outcome::kContact);
}

TEST(RunResult, IsRefusedWithAFieldMissingOrOfAnotherKind) {
  const nlohmann::json whole = nlohmann::json::parse(ToJson(Sample()).dump());
  for (const auto& item : whole.items()) {
    RunResult result;
    nlohmann::json without = whole;
    without.erase(item.key());
    const bool is_younger = item.key() == "reasons" || item.key() == "vertical_mps2";
    EXPECT_EQ(FromJson(without, result).ok(), is_younger) << item.key();
    nlohmann::json other = whole;
    other[item.key()] = nlohmann::json::array({"x"});
    EXPECT_FALSE(FromJson(other, result).ok()) << item.key();
  }
  for (const auto& item : whole["way"].items()) {
    RunResult result;
    nlohmann::json without = whole;
    without["way"].erase(item.key());
    EXPECT_FALSE(FromJson(without, result).ok()) << item.key();
  }
}

TEST(RunResult, OfAFileFromBeforeReasonsWereCountedHasNone) {
  nlohmann::json older = nlohmann::json::parse(ToJson(Sample()).dump());
  older.erase("reasons");
  RunResult result;
  ASSERT_TRUE(FromJson(older, result).ok());
  EXPECT_TRUE(result.reasons.empty());
  EXPECT_EQ(ToJson(result)["reasons"].dump(), "{}");
}

TEST(RunResult, KeepsThatThereWasNoCorridor) {
  RunResult sample = Sample();
  sample.way.off_middle_m.reset();
  RunResult back;
  ASSERT_TRUE(FromJson(nlohmann::json::parse(ToJson(sample).dump()), back).ok());
  EXPECT_FALSE(back.way.off_middle_m.has_value());
}

TEST(RunResult, IsRefusedWithAHistogramOfOtherBins) {
  nlohmann::json object = nlohmann::json::parse(ToJson(Sample()).dump());
  RunResult result;
  object["cross_track_m"]["bins"][0][0] = 400;
  EXPECT_FALSE(FromJson(object, result).ok());
  object["cross_track_m"]["bins"][0][0] = 1;
  object["cross_track_m"]["width"] = 0.01;
  EXPECT_FALSE(FromJson(object, result).ok());
}

TEST_F(RunsFile, HoldsRunsInTheOrderOfTheirSeeds) {
  ASSERT_TRUE(WriteRuns(path, {Sample(9), Sample(2), Sample(5)}).ok());
  std::vector<RunResult> runs;
  ASSERT_TRUE(ReadRuns(path, runs).ok());
  ASSERT_EQ(runs.size(), 3u);
  EXPECT_EQ(runs[0].seed, 2u);
  EXPECT_EQ(runs[2].seed, 9u);
}

TEST_F(RunsFile, ReadTwiceAddsNothing) {
  ASSERT_TRUE(WriteRuns(path, {Sample(1), Sample(2)}).ok());
  std::vector<RunResult> runs;
  ASSERT_TRUE(ReadRuns(path, runs).ok());
  ASSERT_TRUE(ReadRuns(path, runs).ok());
  EXPECT_EQ(runs.size(), 2u);
}

TEST_F(RunsFile, WithOneSeedDecidedInTwoWaysIsRefused) {
  RunResult other = Sample(1);
  other.decision_hash ^= 1;
  ASSERT_TRUE(WriteRuns(path, {Sample(1), other}).ok());
  std::vector<RunResult> runs;
  const ReadOutcome outcome = ReadRuns(path, runs);
  EXPECT_FALSE(outcome.ok());
  EXPECT_NE(outcome.message.find(":2: seed 1"), std::string::npos) << outcome.message;
}

TEST_F(RunsFile, WithRunsOfOneRowUnderOtherSettingsIsRefused) {
  RunResult other = Sample(2);
  other.settings ^= 1;
  ASSERT_TRUE(WriteRuns(path, {Sample(1), other}).ok());
  std::vector<RunResult> runs;
  const ReadOutcome outcome = ReadRuns(path, runs);
  EXPECT_FALSE(outcome.ok());
  EXPECT_NE(outcome.message.find(":2: seed 2 was run with other settings"), std::string::npos)
      << outcome.message;
  // Of another row they are no matter.
  other.labels = "none";
  ASSERT_TRUE(WriteRuns(path, {Sample(1), other}).ok());
  runs.clear();
  EXPECT_TRUE(ReadRuns(path, runs).ok());
  EXPECT_EQ(runs.size(), 2u);
}

TEST_F(RunsFile, LosesALastLineThatWasCut) {
  const std::string line = ToJson(Sample(2)).dump();
  Write(ToJson(Sample(1)).dump() + "\n" + line.substr(0, line.size() / 2));
  std::vector<RunResult> runs;
  ASSERT_TRUE(ReadRuns(path, runs).ok());
  ASSERT_EQ(runs.size(), 1u);
  EXPECT_EQ(runs[0].seed, 1u);
}

TEST_F(RunsFile, ThatIsBadSaysWhere) {
  Write(ToJson(Sample()).dump() + "\n{\"world\": \n");
  std::vector<RunResult> runs;
  const ReadOutcome outcome = ReadRuns(path, runs);
  EXPECT_FALSE(outcome.ok());
  EXPECT_NE(outcome.message.find(path + ":2: "), std::string::npos) << outcome.message;
  EXPECT_FALSE(ReadRuns(path + ".none", runs).ok());
  EXPECT_FALSE(WriteRuns("/nowhere/runs.jsonl", {Sample()}).ok());
}

}  // namespace
}  // namespace hardpack::experiment
