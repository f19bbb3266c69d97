// SPDX-License-Identifier: Apache-2.0
// Lines of thin returns: what lies on one is found whatever its direction, what is strewn is not.
#include "core/segmentation/wire_finder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// Of 64 beams over 33.2 degrees, 10 m away: a beam is on 20 mm in two directions of nine.
constexpr float kSpacing_m = 0.092f;

// A point of a level line through a place far from the origin, as odometry's are.
Vec3 OnLine(double heading_rad, double along_m, double rise = 0.0) {
  return {static_cast<float>(812.3 + along_m * std::cos(heading_rad)),
          static_cast<float>(-441.7 + along_m * std::sin(heading_rad)),
          static_cast<float>(3.2 + rise * along_m)};
}

TEST(WireFinder, FindsFourOnALineWhateverItsDirection) {
  for (int degrees = 0; degrees < 180; degrees += 5) {
    const double heading_rad = degrees * M_PI / 180.0;
    WireFinder finder;
    for (int i = 0; i < 4; ++i) {
      EXPECT_TRUE(finder.Find(3 * i, kSpacing_m).empty()) << degrees;
      finder.AddThin(OnLine(heading_rad, 0.3 * i, 0.1), 3 * i);
    }
    const auto found = finder.Find(9, kSpacing_m);
    ASSERT_EQ(found.size(), 4u) << degrees;
    for (int i = 0; i < 4; ++i) {
      const Vec3 point = OnLine(heading_rad, 0.3 * i, 0.1);
      EXPECT_EQ(found[static_cast<size_t>(i)].x_m, point.x_m);
      EXPECT_EQ(found[static_cast<size_t>(i)].z_m, point.z_m);
    }
  }
}

// Of one direction, as a wire along the line of sight.
TEST(WireFinder, FindsFourOfOneDirection) {
  WireFinder finder;
  for (int i = 0; i < 4; ++i) finder.AddThin(OnLine(0.4, 0.4 * i), 7);
  EXPECT_EQ(finder.Find(7, kSpacing_m).size(), 4u);
}

TEST(WireFinder, LeavesOutWhatIsBesideTheLineOrAboveIt) {
  for (const bool above : {false, true}) {
    WireFinder finder;
    for (int i = 0; i < 5; ++i) {
      Vec3 point = OnLine(0.0, 0.3 * i);
      if (i == 2) (above ? point.z_m : point.y_m) += 0.1f;
      finder.AddThin(point, i);
    }
    EXPECT_EQ(finder.Find(4, kSpacing_m).size(), 4u);
  }
}

TEST(WireFinder, WhatIsOldOrTooLongOrTooShortIsNoLine) {
  WireFinder old;
  for (int i = 0; i < 4; ++i) old.AddThin(OnLine(0.0, 0.3 * i), i * WireFinder::kDirections);
  EXPECT_TRUE(old.Find(3 * WireFinder::kDirections, kSpacing_m).empty());
  WireFinder long_line;
  for (int i = 0; i < 4; ++i) long_line.AddThin(OnLine(0.0, 1.0 * i), i);
  EXPECT_TRUE(long_line.Find(3, kSpacing_m).empty());
  WireFinder short_line;
  for (int i = 0; i < 4; ++i) short_line.AddThin(OnLine(0.0, 0.05 * i), i);
  EXPECT_TRUE(short_line.Find(3, kSpacing_m).empty());
  // And none of before a restart.
  WireFinder begun_anew;
  for (int i = 0; i < 3; ++i) begun_anew.AddThin(OnLine(0.0, 0.3 * i), i);
  begun_anew.Restart();
  begun_anew.AddThin(OnLine(0.0, 0.9), 3);
  EXPECT_TRUE(begun_anew.Find(3, kSpacing_m).empty());
}

// Four of 33 directions are enough where one beam is 0.092 m above the next, not where it is 0.03
// m.
TEST(WireFinder, AWireHasABeamOnItInAsManyDirectionsAsItIsThick) {
  WireFinder finder;
  for (int i = 0; i < 4; ++i) finder.AddThin(OnLine(0.0, 0.3 * i), 11 * i);
  EXPECT_EQ(finder.Find(33, kSpacing_m).size(), 4u);
  EXPECT_TRUE(finder.Find(33, 0.03f).empty());
  EXPECT_TRUE(finder.Find(33, 0.0f).empty());
  EXPECT_TRUE(finder.Find(33, kNaN).empty());
}

// On the line, about it and further away: at most a third as many about it as on it.
TEST(WireFinder, WhatHasMuchAboutItIsNoWire) {
  for (const bool thin : {false, true}) {
    const auto find = [&](int about, float aside_m) {
      WireFinder finder;
      for (int i = 0; i < about; ++i) {
        Vec3 other = OnLine(0.0, 0.2 + 0.3 * i);
        other.y_m += aside_m;
        thin ? finder.AddThin(other, 0) : finder.AddOther(other, 0);
      }
      for (int i = 0; i < 4; ++i) finder.AddThin(OnLine(0.0, 0.3 * i), i);
      return finder.Find(3, kSpacing_m).size();
    };
    EXPECT_EQ(find(0, 0.15f), 4u);
    EXPECT_EQ(find(1, 0.15f), 4u);
    EXPECT_EQ(find(2, 0.15f), 0u);
    EXPECT_EQ(find(2, -0.15f), 0u);
    EXPECT_EQ(find(2, 0.25f), 4u);
  }
}

TEST(WireFinder, TakesNothingThatIsNotFinite) {
  WireFinder finder;
  for (int i = 0; i < 3; ++i) finder.AddThin(OnLine(0.0, 0.3 * i), i);
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    finder.AddThin({bad, 0.0f, 0.0f}, 3);
    finder.AddThin({0.0f, bad, 0.0f}, 3);
    finder.AddThin({0.0f, 0.0f, bad}, 3);
  }
  finder.AddThin(OnLine(0.0, 0.9), 4);
  EXPECT_EQ(finder.Find(4, kSpacing_m).size(), 4u);
}

// Grass of 3 x 2 m and 0.3 m of height, of which one return in eight is thin.
TEST(WireFinder, WhatIsStrewnIsNoLine) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  constexpr int kDirectionsSeen = 20000;
  int lines = 0;
  WireFinder finder;
  for (int i = 0; i < kDirectionsSeen; ++i) {
    for (int beam = 0; beam < 4; ++beam) {
      const Vec3 tip = {3.0f * share(random), 2.0f * share(random), 0.1f + 0.3f * share(random)};
      share(random) < 0.125f ? finder.AddThin(tip, i) : finder.AddOther(tip, i);
    }
    lines += finder.Find(i, kSpacing_m).empty() ? 0 : 1;
  }
  EXPECT_LT(lines, kDirectionsSeen / 1000);
}

}  // namespace
}  // namespace hardpack
