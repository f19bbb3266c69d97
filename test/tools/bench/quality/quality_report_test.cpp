// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_report.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "core/base/math.h"

namespace hardpack::command {
namespace {

class Measures : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(builder_->BeginCells(GridWindow::CenteredAt({}), CostmapParams{}), Status::kOk);
    builder_->SetCell(builder_->result().window.Index(CellAt({0.0f, 3.1f})), Costmap::kHard);
    while (builder_->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
    }
  }

  // From (-10, y) along x, in steps of 0.25 m that each turn by the curvature.
  QualityMeasures Of(float y_m, float curvature_per_m) const {
    ActuatorPath actuator;
    actuator.start = {-10.0f, y_m, 0.0f};
    for (int i = 0; i < 80; ++i) {
      EXPECT_EQ(actuator.steps.PushBack({0.25f * curvature_per_m, 0.25f}), Status::kOk);
    }
    WorldPath path;
    EXPECT_EQ(ToWorld<PlanarModel>(actuator, path), Status::kOk);
    return Measure(builder_->result(), PlannerParams{}, path, curvature_per_m);
  }

  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

TEST_F(Measures, OfAStraightPathFarFromEverything) {
  const QualityMeasures straight = Of(-10.0f, 0.0f);
  EXPECT_EQ(straight.cost.total(), 0.0f);
  EXPECT_EQ(straight.points, 81);
  EXPECT_NEAR(straight.length_m, 20.0f, 1.0e-3f);
  EXPECT_NEAR(straight.angle_per_m, 0.0f, 1.0e-5f);
  EXPECT_EQ(straight.clearance_m, kClearanceReach_m);
  EXPECT_TRUE(straight.keeps_limits);
  EXPECT_FALSE(straight.collides);
}

//         #  (0, 3.0) to (0.2, 3.2)
//   ------+------>  y = 1.5: the flank of 0.69 m passes 0.81 m below it
TEST_F(Measures, OfAPathPastAnObstacle) {
  const QualityMeasures past = Of(1.5f, 0.0f);
  EXPECT_NEAR(past.clearance_m, 3.0f - 1.5f - 0.5f * VehicleParams{}.width_m, 1.0e-3f);
  EXPECT_GT(past.cost.map, 0.0f);
  EXPECT_FALSE(past.collides);
  EXPECT_TRUE(Of(2.5f, 0.0f).collides);
}

TEST_F(Measures, OfABendWithinTheLimitAndBeyond) {
  const QualityMeasures gentle = Of(-10.0f, 0.4f);
  EXPECT_NEAR(gentle.largest_curvature_per_m, 0.4f, 1.0e-3f);
  // The path's last chord does not turn any more.
  EXPECT_NEAR(gentle.angle_per_m, 0.4f, 0.4f / 80.0f + 1.0e-3f);
  EXPECT_TRUE(gentle.keeps_limits);
  EXPECT_FALSE(Of(-10.0f, 0.6f).keeps_limits);
}

// A problem in which the solvers' runs are the same but for what is given of ours and the paper's.
QualityResult Result(int number, float our_cost, float paper_cost) {
  QualityResult result;
  result.number = number;
  result.runs.resize(Solvers().size());
  for (size_t i = 0; i < Solvers().size(); ++i) {
    QualityRun& run = result.runs[i];
    const bool is_ours = Solvers()[i].id == SolverId::kOurs;
    run.measures.cost.map = is_ours ? our_cost : paper_cost;
    run.measures.keeps_limits = true;
    run.median_us = is_ours ? 2.0 : 2.0 * number;
  }
  return result;
}

QualityRun& RunOf(QualityResult& result, SolverId id) {
  return const_cast<QualityRun&>(result.of(id));
}

TEST(HeadToHead, CountsWinsAndNamesTheWorst) {
  const std::vector<QualityResult> results = {Result(3, 10.0f, 20.0f), Result(4, 30.0f, 20.0f),
                                              Result(5, 20.0f, 20.0f)};
  const HeadToHead head = Compare(results, SolverId::kPaper);
  EXPECT_EQ(head.problems, 3);
  EXPECT_EQ(head.no_worse, 2);
  EXPECT_NEAR(head.median_cost_share, 1.0, 1.0e-6);
  EXPECT_NEAR(head.worst_cost_share, 1.5, 1.0e-6);
  EXPECT_EQ(head.worst_cost_problem, 4);
  EXPECT_NEAR(head.median_speed_up, 4.0, 1.0e-9);
  EXPECT_NEAR(head.least_speed_up, 3.0, 1.0e-9);
  EXPECT_EQ(head.least_speed_up_problem, 3);
  EXPECT_TRUE(head.limits_lost.empty());
}

TEST(HeadToHead, ListsLimitsThatTheOtherKeepsAndOursDoesNot) {
  std::vector<QualityResult> results = {Result(1, 1.0f, 1.0f), Result(2, 1.0f, 1.0f),
                                        Result(3, 1.0f, 1.0f)};
  RunOf(results[0], SolverId::kPaper).measures.keeps_limits = false;
  RunOf(results[0], SolverId::kOurs).measures.keeps_limits = false;
  RunOf(results[1], SolverId::kPaper).measures.keeps_limits = false;
  RunOf(results[2], SolverId::kOurs).measures.keeps_limits = false;
  EXPECT_EQ(Compare(results, SolverId::kPaper).limits_lost, std::vector<int>{3});
}

TEST(MostTelling, TakesWinsTypicalOnesAndLosses) {
  std::vector<QualityResult> results;
  for (int i = 0; i < 30; ++i) {
    // 17 and 30 have no common factor: each share comes once, in no order.
    results.push_back(Result(i, static_cast<float>(i * 17 % 30 + 1), 10.0f));
  }
  std::set<float> costs;
  for (const size_t index : MostTelling(results, SolverId::kPaper, 6)) {
    costs.insert(results[index].of(SolverId::kOurs).measures.cost.total());
  }
  EXPECT_EQ(costs, (std::set<float>{1.0f, 2.0f, 15.0f, 16.0f, 29.0f, 30.0f}));
}

TEST(MostTelling, TakesLostLimitsFirst) {
  std::vector<QualityResult> results;
  for (int i = 0; i < 30; ++i) results.push_back(Result(i, 1.0f, static_cast<float>(i + 1)));
  for (const size_t broken : {size_t{7}, size_t{22}}) {
    RunOf(results[broken], SolverId::kOurs).measures.keeps_limits = false;
  }
  const std::vector<size_t> chosen = MostTelling(results, SolverId::kPaper, 8);
  EXPECT_EQ(chosen.size(), 8u);
  EXPECT_EQ(std::set<size_t>(chosen.begin(), chosen.end()).size(), 8u);
  EXPECT_EQ(chosen[0], 7u);
  EXPECT_EQ(chosen[1], 22u);
}

TEST(MostTelling, TakesAllWhereThereAreFew) {
  const std::vector<QualityResult> results = {Result(1, 2.0f, 1.0f), Result(2, 1.0f, 1.0f)};
  EXPECT_EQ(MostTelling(results, SolverId::kPaper, 12), (std::vector<size_t>{1, 0}));
}

TEST(QualityJson, SumsUpEachSolver) {
  const std::vector<QualityResult> results = {Result(1, 10.0f, 40.0f), Result(2, 20.0f, 50.0f),
                                              Result(3, 90.0f, 60.0f)};
  const nlohmann::json json = QualityToJson(results, 7);
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["summary"]["hardpack"]["cost"],
            (nlohmann::json{{"mean", 40.0}, {"median", 20.0}, {"worst", 90.0}}));
  EXPECT_EQ(json["summary"]["hardpack"]["limits_kept"], 3);
  EXPECT_EQ(json["head_to_head"]["paper"]["no_worse"], 2);
  EXPECT_EQ(json["problems"].size(), 3u);
}

}  // namespace
}  // namespace hardpack::command
