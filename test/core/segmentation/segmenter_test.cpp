// SPDX-License-Identifier: Apache-2.0
// The segmenter as its callers see it: what it refuses, and that no input harms it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/segmentation/segmentation.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

constexpr int kBeams = 64;
using testing::kInfinity;
using testing::kNaN;

// Flat ground 1.3 m below the sensor.
DirectionView FlatView() {
  DirectionView view;
  view.beams = kBeams;
  view.sensor_height_m = 1.3f;
  for (int beam = 0; beam < kBeams; ++beam) {
    const float slope = -0.3f + 0.0095f * static_cast<float>(beam);
    view.slope[beam] = slope;
    if (slope > -0.03f) continue;
    view.seen[beam] = true;
    view.level_m[beam] = -1.3f / slope;
    view.range_m[beam] = view.level_m[beam] * std::sqrt(1.0f + slope * slope);
  }
  return view;
}

std::unique_ptr<Segmenter> Configured() {
  auto segmenter = std::make_unique<Segmenter>();
  EXPECT_EQ(segmenter->Configure({}, kBeams), Status::kOk);
  return segmenter;
}

// What result() says is within its own contract, whatever went in.
void ExpectSane(const DirectionClasses& classes) {
  ASSERT_EQ(classes.beams, kBeams);
  for (int beam = 0; beam < kBeams; ++beam) {
    const ReturnClass what = classes.what[beam];
    EXPECT_TRUE(what == ReturnClass::kIgnored || what == ReturnClass::kGround ||
                what == ReturnClass::kSoft || what == ReturnClass::kHard);
    EXPECT_LT(classes.observed_from[beam], beam);
    EXPECT_GE(classes.observed_from[beam], -1);
    if (classes.observed_from[beam] >= 0) {
      EXPECT_EQ(what, ReturnClass::kGround);
      EXPECT_EQ(classes.what[classes.observed_from[beam]], ReturnClass::kGround);
    }
  }
}

TEST(Segmenter, RefusesWhatItCannotWorkWith) {
  auto segmenter = std::make_unique<Segmenter>();
  EXPECT_EQ(segmenter->Push(FlatView()), Status::kNotStarted);
  EXPECT_EQ(segmenter->Configure({}, 0), Status::kInvalidArgument);
  EXPECT_EQ(segmenter->Configure({}, kMaxBeams + 1), Status::kInvalidArgument);
  SegmentationParams params;
  params.isolation_m = kNaN;
  EXPECT_EQ(segmenter->Configure(params, kBeams), Status::kParameterOutOfRange);
  EXPECT_EQ(segmenter->Push(FlatView()), Status::kNotStarted);
  EXPECT_EQ(segmenter->Configure({}, 1), Status::kOk);
  EXPECT_EQ(segmenter->Configure({}, kMaxBeams), Status::kOk);
}

TEST(Segmenter, AnswersAfterItsLagAndAfterEachRestart) {
  auto segmenter = Configured();
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < Segmenter::kLag; ++i) {
      EXPECT_EQ(segmenter->Push(FlatView()), Status::kOk);
      EXPECT_FALSE(segmenter->ready());
    }
    EXPECT_EQ(segmenter->Push(FlatView()), Status::kOk);
    EXPECT_TRUE(segmenter->ready());
    segmenter->Restart();
    EXPECT_FALSE(segmenter->ready());
  }
}

TEST(Segmenter, ForgetsAllDirectionsAtARestart) {
  auto used = Configured();
  DirectionView wall = FlatView();
  for (int beam = 0; beam < kBeams; ++beam) {
    wall.seen[beam] = true;
    wall.level_m[beam] = 4.0f;
    wall.range_m[beam] = 4.0f;
    wall.height_m[beam] = 1.3f + 4.0f * wall.slope[beam];
  }
  for (int i = 0; i < 20; ++i) ASSERT_EQ(used->Push(wall), Status::kOk);
  used->Restart();
  auto fresh = Configured();
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(used->Push(FlatView()), Status::kOk);
    ASSERT_EQ(fresh->Push(FlatView()), Status::kOk);
    if (!fresh->ready()) continue;
    for (int beam = 0; beam < kBeams; ++beam) {
      EXPECT_EQ(used->result().what[beam], fresh->result().what[beam]);
      EXPECT_EQ(used->result().above_ground_m[beam], fresh->result().above_ground_m[beam]);
      EXPECT_EQ(used->result().observed_from[beam], fresh->result().observed_from[beam]);
    }
  }
}

TEST(Segmenter, TakesABadDirectionForOneWithNothingSeen) {
  for (int bad = 0; bad < 7; ++bad) {
    auto segmenter = Configured();
    for (int i = 0; i <= 2 * Segmenter::kLag; ++i) {
      DirectionView view = FlatView();
      Status expected = Status::kOk;
      if (i == Segmenter::kLag) {
        expected = bad == 0 ? Status::kInvalidArgument : Status::kNotFinite;
        if (bad == 0) view.beams = kBeams - 1;
        if (bad == 1) view.range_m[3] = kNaN;
        if (bad == 2) view.level_m[3] = kInfinity;
        if (bad == 3) view.height_m[3] = -kInfinity;
        if (bad == 4) view.slope[3] = kNaN;
        if (bad == 5) view.sensor_height_m = kNaN;
        if (bad == 6) view.range_m[0] = kInfinity;
      }
      EXPECT_EQ(segmenter->Push(view), expected) << bad;
    }
    ASSERT_TRUE(segmenter->ready());
    for (const ReturnClass what : segmenter->result().what) EXPECT_EQ(what, ReturnClass::kIgnored);
    // The one after it is classed as if nothing had been wrong.
    EXPECT_EQ(segmenter->Push(FlatView()), Status::kOk);
    EXPECT_EQ(segmenter->result().what[3], ReturnClass::kGround);
  }
}

TEST(Segmenter, DoesNotLookAtNumbersOfBeamsThatSawNothing) {
  auto segmenter = Configured();
  auto clean = Configured();
  for (int i = 0; i < 20; ++i) {
    DirectionView view = FlatView();
    for (int beam = 0; beam < kBeams; ++beam) {
      if (view.seen[beam]) continue;
      view.range_m[beam] = kNaN;
      view.level_m[beam] = kInfinity;
      view.height_m[beam] = kNaN;
    }
    EXPECT_EQ(segmenter->Push(view), Status::kOk);
    EXPECT_EQ(clean->Push(FlatView()), Status::kOk);
    for (int beam = 0; beam < kBeams; ++beam) {
      EXPECT_EQ(segmenter->result().what[beam], clean->result().what[beam]);
      EXPECT_EQ(segmenter->result().above_ground_m[beam], clean->result().above_ground_m[beam]);
    }
  }
}

TEST(Segmenter, MakesNothingOfDirectionsWithoutReturns) {
  auto segmenter = Configured();
  DirectionView view = FlatView();
  for (bool& seen : view.seen) seen = false;
  for (int i = 0; i < 20; ++i) EXPECT_EQ(segmenter->Push(view), Status::kOk);
  for (int beam = 0; beam < kBeams; ++beam) {
    EXPECT_EQ(segmenter->result().what[beam], ReturnClass::kIgnored);
    EXPECT_FALSE(segmenter->result().ground_known[beam]);
    EXPECT_EQ(segmenter->result().observed_from[beam], -1);
  }
}

//  o  |
//  |  |    all beams at one distance: a wall
TEST(Segmenter, TakesAllBeamsAtOneRangeForAWall) {
  auto segmenter = Configured();
  DirectionView view = FlatView();
  for (int beam = 0; beam < kBeams; ++beam) {
    view.seen[beam] = true;
    view.level_m[beam] = 4.0f;
    view.range_m[beam] = 4.0f * std::sqrt(1.0f + view.slope[beam] * view.slope[beam]);
    view.height_m[beam] = 1.3f + 4.0f * view.slope[beam];
  }
  for (int i = 0; i < 20; ++i) ASSERT_EQ(segmenter->Push(view), Status::kOk);
  for (int beam = 0; beam < kBeams; ++beam) {
    if (view.height_m[beam] < 0.25f) continue;
    EXPECT_EQ(segmenter->result().what[beam], ReturnClass::kHard) << beam;
    EXPECT_FLOAT_EQ(segmenter->result().above_ground_m[beam], view.height_m[beam]);
  }
}

// A missing direction between two good ones: what is beside it is classed all the same.
TEST(Segmenter, IsNotDisturbedByMissingDirections) {
  auto segmenter = Configured();
  DirectionView missing = FlatView();
  for (bool& seen : missing.seen) seen = false;
  for (int i = 0; i < 60; ++i) {
    ASSERT_EQ(segmenter->Push(i % 3 == 0 ? missing : FlatView()), Status::kOk);
    if (i < 2 * Segmenter::kLag || (i - Segmenter::kLag) % 3 == 0) continue;
    for (int beam = 0; beam < 20; ++beam) {
      EXPECT_EQ(segmenter->result().what[beam], ReturnClass::kGround) << i << " " << beam;
    }
  }
}

TEST(Segmenter, StaysWithinItsContractWhateverComesIn) {
  constexpr uint32_t kSeed = 20240607;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const std::vector<float> odd = {0.0f,     -0.0f,  1.0f,    -1.0f, 1.0e-38f,  1.0e38f,
                                  -1.0e38f, 1.0e9f, -1.0e9f, kNaN,  kInfinity, 3.0f};
  auto segmenter = Configured();
  for (int i = 0; i < 4000; ++i) {
    DirectionView view = FlatView();
    const auto kind = random() % 5;
    for (int beam = 0; beam < kBeams; ++beam) {
      const auto pick = [&] { return odd[random() % odd.size()]; };
      const auto uniform = [&] { return static_cast<float>(random() % 4000) * 0.01f; };
      if (kind == 0) view.seen[beam] = random() % 2 == 0;
      if (kind == 1) view.slope[beam] = uniform() * 0.1f - 2.0f;  // in no order
      if (kind == 2) view.level_m[beam] = uniform();
      if (kind == 2) view.height_m[beam] = uniform() - 20.0f;
      if (kind == 3 && random() % 400 == 0) view.range_m[beam] = pick();
      if (kind == 3 && random() % 400 == 0) view.level_m[beam] = pick();
      if (kind == 3 && random() % 400 == 0) view.height_m[beam] = pick();
      if (kind == 3 && random() % 400 == 0) view.slope[beam] = pick();
      if (kind == 4 && random() % 4 == 0) view.level_m[beam] = -1.0e38f;
      if (kind == 4 && random() % 4 == 0) view.height_m[beam] = 1.0e38f;
    }
    (void)segmenter->Push(view);
    if (segmenter->ready()) ExpectSane(segmenter->result());
  }
}

TEST(Segmenter, IsTheSameAfterBeingCopied) {
  auto segmenter = Configured();
  for (int i = 0; i < 7; ++i) ASSERT_EQ(segmenter->Push(FlatView()), Status::kOk);
  auto copy = std::make_unique<Segmenter>(*segmenter);
  for (int i = 0; i < 7; ++i) {
    ASSERT_EQ(segmenter->Push(FlatView()), Status::kOk);
    ASSERT_EQ(copy->Push(FlatView()), Status::kOk);
    for (int beam = 0; beam < kBeams; ++beam) {
      EXPECT_EQ(copy->result().above_ground_m[beam], segmenter->result().above_ground_m[beam]);
    }
  }
}

}  // namespace
}  // namespace hardpack
