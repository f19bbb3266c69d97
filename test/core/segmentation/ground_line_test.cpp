// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/ground_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hardpack {
namespace {

constexpr float kMaxSlope = 0.6f;
constexpr float kSlopeBase_m = 1.0f;
constexpr float kMaxCarrySlope = 0.3f;

// The returns of one direction on rolling ground: no beam's return is nearer than one of a lower
// beam.
GroundCandidates RollingGround(std::mt19937& random, int beams) {
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  constexpr float kSensor_m = 1.2f;
  const float length_m = 4.0f + 12.0f * share(random);
  const float rise_m = 0.3f * share(random);
  const float step = 0.7f + 0.25f * share(random);
  GroundCandidates all;
  float level_m = 1.5f + share(random);
  for (int i = 0; i < beams; ++i) {
    const float height_m = rise_m * std::sin(level_m / length_m);
    all.level_m[i] = level_m;
    all.height_m[i] = height_m;
    all.slope[i] = (height_m - kSensor_m) / level_m;
    all.beam[i] = static_cast<uint8_t>(i);
    level_m += 0.05f + 0.05f * level_m * step * share(random);
  }
  all.count = beams;
  return all;
}

int LastBefore(const GroundLine& line, float level_m) {
  int last = 0;
  for (int i = 1; i < line.size(); ++i) last = line.level_m(i) < level_m ? i : last;
  return last;
}

TEST(GroundLine, FindsTheLastPointBeforeWhateverTheHint) {
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round) {
    GroundLine line;
    line.Find(RollingGround(random, 1 + round * 6), kMaxSlope);
    ASSERT_GT(line.size(), round < 2 ? 0 : 2 * round);
    for (int i = 0; i < line.size(); ++i) {
      for (const float aside_m : {-0.01f, 0.0f, 0.01f}) {
        const float level_m = line.level_m(i) + aside_m;
        for (int hint = 0; hint < line.size(); ++hint) {
          ASSERT_EQ(line.LastPointBefore(level_m, hint), LastBefore(line, level_m))
              << "round " << round << ", point " << i << ", hint " << hint;
        }
      }
    }
  }
}

// Of a sensor that looks steeply down, ground begins close by.
TEST(GroundLine, BeginsRightBelowTheSensor) {
  GroundCandidates all;
  constexpr float kSensor_m = 1.2f;
  all.count = 12;
  for (int i = 0; i < all.count; ++i) {
    all.level_m[i] = 0.2f * static_cast<float>(i);  // the first is below it, and tells nothing
    all.slope[i] = -kSensor_m / std::fmax(all.level_m[i], 0.01f);
    all.beam[i] = static_cast<uint8_t>(i);
  }
  GroundLine line;
  line.Find(all, kMaxSlope);
  ASSERT_GT(line.size(), 1);
  EXPECT_FLOAT_EQ(line.level_m(1), 0.2f);
}

// The slope is measured from the last point that lies at least a base back.
TEST(GroundLine, IsCarriedOnWithTheSlopeOfItsLastMetre) {
  std::mt19937 random(2);
  for (int round = 0; round < 100; ++round) {
    GroundLine line;
    line.Find(RollingGround(random, 8 + round), kMaxSlope);
    const int last = line.size() - 1;
    const float end_m = line.level_m(last);
    int base = 0;
    for (int i = 1; i <= last; ++i) base = end_m - line.level_m(i) >= kSlopeBase_m ? i : base;
    const float run_m = end_m - line.level_m(base);
    const float slope =
        run_m >= kSlopeBase_m ? (line.height_m(last) - line.height_m(base)) / run_m : 0.0f;
    const float carried = std::fmin(std::fmax(slope, -kMaxCarrySlope), kMaxCarrySlope);
    const GroundHeight ground = line.At(last, end_m + 2.0f, 3.0f);
    EXPECT_TRUE(ground.known);
    EXPECT_FLOAT_EQ(ground.height_m, line.height_m(last) + carried * 2.0f) << "round " << round;
    EXPECT_FALSE(line.At(last, end_m + 2.0f, 1.9f).known);
  }
}

}  // namespace
}  // namespace hardpack
