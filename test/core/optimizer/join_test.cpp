// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "core/optimizer/optimizer.h"
#include "test/core/optimizer/optimizer_scene.h"

namespace hardpack {
namespace {

class Join : public ::testing::Test {
 protected:
  Status Start(const WorldPath& base, float heading_rad) {
    return JoinStart(base, path_params_, params_, heading_rad, seed_);
  }
  Status End(const WorldPath& base, float heading_rad) {
    return JoinEnd(base, path_params_, params_, heading_rad, seed_);
  }

  PathParams path_params_;
  OptimizerParams params_;
  WorldPath seed_;
};

TEST_F(Join, PointsTheFirstChordAlongTheHeading) {
  //   .--.
  //  /    '--------   off by up to 60 degrees, back on the path with no step of curvature
  for (int degrees = -59; degrees <= 59; ++degrees) {
    SCOPED_TRACE(degrees);
    const float heading_rad = kRadPerDeg * static_cast<float>(degrees);
    const WorldPath base = Along({{-3.0f, 2.0f}, {27.0f, 2.0f}});
    ASSERT_EQ(Start(base, heading_rad), Status::kOk);
    EXPECT_NEAR(seed_[0].theta_rad, heading_rad, 1e-5f);
    EXPECT_EQ(seed_[0].x_m, base[0].x_m);
    EXPECT_EQ(seed_.back().x_m, base.back().x_m);
    EXPECT_LE(ShapeOf(seed_, 0.0f).largest_curvature_per_m, 1.2f * params_.max_curvature_per_m);
  }
}

TEST_F(Join, KeepsWhatIsBehindItsWindow) {
  const WorldPath base = Along({{0.0f, 0.0f}, {30.0f, 0.0f}});
  ASSERT_EQ(Start(base, 0.5f), Status::kOk);
  const float reach_m = 4.62f * 0.5f / params_.max_curvature_per_m + 0.6f;
  for (int k = 0; k < base.size(); ++k) {
    if (base[k].x_m < reach_m) continue;
    EXPECT_EQ(seed_[k].x_m, base[k].x_m);
    EXPECT_EQ(seed_[k].y_m, base[k].y_m);
  }
}

TEST_F(Join, LeavesAPathThatIsAlreadyJoined) {
  const WorldPath base = Along({{0.0f, 0.0f}, {5.0f, 0.0f}, {9.0f, 4.0f}});
  ASSERT_EQ(Start(base, 0.0f), Status::kOk);
  for (int k = 0; k < base.size(); ++k) {
    EXPECT_NEAR(seed_[k].x_m, base[k].x_m, 1e-6f);
    EXPECT_NEAR(seed_[k].y_m, base[k].y_m, 1e-6f);
  }
}

TEST_F(Join, FitsIntoAShortPath) {
  const WorldPath base = Along({{0.0f, 0.0f}, {1.0f, 0.0f}});
  ASSERT_EQ(base.size(), 4);
  ASSERT_EQ(Start(base, 1.0f), Status::kOk);
  EXPECT_NEAR(seed_[0].theta_rad, 1.0f, 1e-5f);
  EXPECT_EQ(seed_.back().x_m, base.back().x_m);
  EXPECT_EQ(seed_.back().y_m, base.back().y_m);
}

TEST_F(Join, PointsTheLastChordAlongTheGoalsHeading) {
  for (int degrees = -59; degrees <= 59; degrees += 7) {
    SCOPED_TRACE(degrees);
    const float heading_rad = kRadPerDeg * static_cast<float>(degrees);
    const WorldPath base = Along({{-3.0f, 2.0f}, {27.0f, 2.0f}});
    ASSERT_EQ(End(base, heading_rad), Status::kOk);
    EXPECT_NEAR(seed_.back().theta_rad, heading_rad, 2e-5f);
    EXPECT_EQ(seed_[0].x_m, base[0].x_m);
    EXPECT_EQ(seed_[1].y_m, base[1].y_m);
    EXPECT_EQ(seed_.back().x_m, base.back().x_m);
    EXPECT_EQ(seed_.back().y_m, base.back().y_m);
  }
}

TEST_F(Join, WorksInPlace) {
  const WorldPath base = Along({{0.0f, 0.0f}, {20.0f, 3.0f}});
  ASSERT_EQ(Start(base, 0.6f), Status::kOk);
  WorldPath same = base;
  ASSERT_EQ(JoinStart(same, path_params_, params_, 0.6f, same), Status::kOk);
  EXPECT_TRUE(SamePoints(same, seed_));
}

TEST_F(Join, RefusesWhatItCannotJoin) {
  WorldPath base = Along({{0.0f, 0.0f}, {10.0f, 0.0f}});
  EXPECT_EQ(Start(base, 1.1f), Status::kInvalidArgument);  // a pivot first
  EXPECT_EQ(Start(base, kPi), Status::kInvalidArgument);
  EXPECT_TRUE(seed_.empty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(Start(base, nan), Status::kNotFinite);
  EXPECT_EQ(End(base, nan), Status::kNotFinite);
  WorldPath damaged = base;
  damaged[3].x_m = nan;
  EXPECT_EQ(Start(damaged, 0.0f), Status::kNotFinite);
  damaged[3].x_m = 3e38f;
  EXPECT_EQ(Start(damaged, 0.0f), Status::kNotFinite);
  base.Resize(3);
  EXPECT_EQ(Start(base, 0.0f), Status::kPathTooShort);
}

}  // namespace
}  // namespace hardpack
