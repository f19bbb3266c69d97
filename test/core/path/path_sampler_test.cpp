// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>

#include "core/path/path.h"

namespace hardpack {
namespace {

constexpr int kAll = 1 << 30;

class Sampler : public ::testing::Test {
 protected:
  Sampler() {
    const GridWindow window = GridWindow::CenteredAt({0.0f, 0.0f});
    EXPECT_EQ(builder_->BeginCells(window, CostmapParams{}), Status::kOk);
  }

  void AddWall(float x_m, float from_y_m, float to_y_m) {
    const GridWindow window = GridWindow::CenteredAt({0.0f, 0.0f});
    for (float y_m = from_y_m; y_m < to_y_m; y_m += 0.1f) {
      builder_->SetCell(window.Index(CellAt({x_m, y_m})), Costmap::kHard);
    }
  }

  void Search(Vec2 start, Vec2 goal) {
    static_cast<void>(builder_->StepCells(kAll));
    ASSERT_TRUE(IsUsable(search_->Begin(builder_->result(), AstarParams{}, start, goal)));
    ASSERT_EQ(search_->Step(builder_->result(), kAll), Progress::kDone);
    ASSERT_TRUE(IsUsable(search_->result().status));
  }

  Status Sample(Vec2 start, Vec2 goal, int units = kAll) {
    const Status begun = sampler_.Begin(*search_, params_, start, goal);
    if (begun != Status::kOk) return begun;
    while (sampler_.Step(*search_, units) == Progress::kBusy) {
    }
    return sampler_.status();
  }

  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  std::unique_ptr<AstarSearch> search_ = std::make_unique<AstarSearch>();
  PathSampler sampler_;
  PathParams params_;
};

float ChordOf(const WorldPath& path, int i) {
  return std::hypot(path[i + 1].x_m - path[i].x_m, path[i + 1].y_m - path[i].y_m);
}

TEST_F(Sampler, GoesFromStartToGoalInEvenSteps) {
  // s ----+      +---- g
  //       |  ##  |
  //       +------+
  AddWall(0.0f, -1.0f, 8.0f);
  const Vec2 start = {-10.03f, 0.07f};
  const Vec2 goal = {9.97f, 1.11f};
  Search(start, goal);
  ASSERT_EQ(Sample(start, goal), Status::kOk);
  const WorldPath& path = sampler_.result();
  EXPECT_EQ(path[0].x_m, start.x_m);
  EXPECT_EQ(path[0].y_m, start.y_m);
  EXPECT_EQ(path.back().x_m, goal.x_m);
  EXPECT_EQ(path.back().y_m, goal.y_m);
  float longest = 0.0f;
  for (int i = 0; i + 1 < path.size(); ++i) {
    longest = std::max(longest, ChordOf(path, i));
    EXPECT_GT(ChordOf(path, i), 0.92f * params_.step_m) << i;  // a chord cuts a corner of 45 deg
    EXPECT_LT(ChordOf(path, i), 1.02f * params_.step_m) << i;
    EXPECT_EQ(path[i].theta_rad,
              HeadingOf({path[i + 1].x_m - path[i].x_m, path[i + 1].y_m - path[i].y_m}));
  }
}

TEST_F(Sampler, StaysOnTheCellPath) {
  AddWall(0.0f, -3.0f, 8.0f);
  const Vec2 start = {-10.0f, 0.0f};
  const Vec2 goal = {9.0f, 5.0f};
  Search(start, goal);
  ASSERT_EQ(Sample(start, goal), Status::kOk);
  for (const Pose2& pose : sampler_.result()) {
    float nearest = 1e9f;
    Cell cell = search_->result().start;
    while (true) {
      const Vec2 center = CellCenter(cell);
      nearest = std::min(nearest, std::hypot(center.x_m - pose.x_m, center.y_m - pose.y_m));
      if (cell == search_->result().end) break;
      cell = search_->Next(cell);
    }
    EXPECT_LT(nearest, 0.1416f);  // half a cell's diagonal
  }
}

TEST_F(Sampler, GivesTheSamePathInUnitsOfAnySize) {
  AddWall(0.0f, -3.0f, 8.0f);
  const Vec2 start = {-10.0f, 0.0f};
  const Vec2 goal = {9.0f, 5.0f};
  Search(start, goal);
  ASSERT_EQ(Sample(start, goal), Status::kOk);
  const WorldPath whole = sampler_.result();
  for (const int units : {1, 3, 17}) {
    ASSERT_EQ(Sample(start, goal, units), Status::kOk);
    ASSERT_EQ(sampler_.result().size(), whole.size());
    for (int i = 0; i < whole.size(); ++i) {
      EXPECT_EQ(sampler_.result()[i].x_m, whole[i].x_m);
      EXPECT_EQ(sampler_.result()[i].y_m, whole[i].y_m);
      EXPECT_EQ(sampler_.result()[i].theta_rad, whole[i].theta_rad);
    }
  }
}

TEST_F(Sampler, CutsWhatIsLongerThanItsCapacity) {
  params_.step_m = 0.1f;
  const Vec2 start = {-40.0f, 0.0f};
  const Vec2 goal = {40.0f, 0.0f};
  Search(start, goal);
  ASSERT_EQ(Sample(start, goal), Status::kPathCut);
  ASSERT_EQ(sampler_.result().size(), kMaxPathPoints);
  EXPECT_NEAR(LengthOf(sampler_.result()), 25.5f, 0.1f);
}

TEST_F(Sampler, EndsAtTheLastCellWhenTheGoalIsElsewhere) {
  const Vec2 start = {0.0f, 0.0f};
  Search(start, {500.0f, 0.0f});
  params_.step_m = 0.5f;
  ASSERT_EQ(Sample(start, {500.0f, 0.0f}), Status::kOk);
  const Vec2 end = CellCenter(search_->result().end);
  EXPECT_EQ(sampler_.result().back().x_m, end.x_m);
  EXPECT_EQ(sampler_.result().back().y_m, end.y_m);
}

TEST_F(Sampler, GivesEnoughPointsOnAShortWay) {
  const Vec2 start = {0.01f, 0.01f};
  const Vec2 goal = {0.18f, 0.18f};  // the same cell
  Search(start, goal);
  ASSERT_EQ(Sample(start, goal), Status::kOk);
  ASSERT_EQ(sampler_.result().size(), PathSampler::kMinPathSteps + 1);
  EXPECT_EQ(sampler_.result()[0].x_m, start.x_m);
  EXPECT_EQ(sampler_.result().back().x_m, goal.x_m);
}

TEST_F(Sampler, SaysWhenTheGoalIsWhereTheStartIs) {
  Search({0.1f, 0.1f}, {0.1f, 0.1f});
  EXPECT_EQ(Sample({0.1f, 0.1f}, {0.1f, 0.1f}), Status::kPathTooShort);
}

TEST_F(Sampler, RefusesBadInput) {
  EXPECT_EQ(Sample({0.0f, 0.0f}, {1.0f, 1.0f}), Status::kNotStarted);  // nothing was searched
  Search({0.0f, 0.0f}, {5.0f, 1.0f});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Sample({nan, 0.0f}, {5.0f, 1.0f}), Status::kNotFinite);
  EXPECT_EQ(Sample({0.0f, 0.0f}, {5.0f, nan}), Status::kNotFinite);
  for (const float step_m : {nan, 0.0f, -1.0f, 1e-9f}) {
    params_.step_m = step_m;
    EXPECT_EQ(Sample({0.0f, 0.0f}, {5.0f, 1.0f}), Status::kParameterOutOfRange) << step_m;
  }
  EXPECT_EQ(sampler_.Step(*search_, 10), Progress::kDone);
}

}  // namespace
}  // namespace hardpack
