// SPDX-License-Identifier: Apache-2.0
#include "core/scan/mount_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;

// Ground returns around the vehicle, each so far above the map's ground.
struct Ground {
  MountWatch watch;
  uint64_t now_ns = 1'000'000'000;
  std::minstd_rand random{3};

  template <typename Step>
  void Ticks(int count, Step&& step, int returns = 20) {
    for (int tick = 0; tick < count; ++tick) {
      now_ns += kTick_ns;
      for (int i = 0; i < returns; ++i) {
        const double angle = static_cast<double>(random() % 6283u) / 1000.0;
        const double way_m = 4.0 + static_cast<double>(random() % 6000u) / 1000.0;
        const auto x_m = static_cast<float>(way_m * std::cos(angle));
        const auto y_m = static_cast<float>(way_m * std::sin(angle));
        const float noise_m = static_cast<float>(random() % 100u) * 0.001f;
        watch.Add({x_m, y_m}, step(x_m, y_m) + noise_m);
      }
      watch.Advance(now_ns);
    }
  }
};

TEST(MountWatch, ASensorThatSitsStillHasNotTurned) {
  Ground ground;
  ground.Ticks(1000, [](float, float) { return 0.0f; });
  EXPECT_FALSE(ground.watch.has_turned());
  EXPECT_LT(ground.watch.tilt_rad(), 0.01f);
  // The odometry's height drifts: everything lies higher. That is no turn.
  ground.Ticks(100, [](float, float) { return 0.4f; });
  EXPECT_FALSE(ground.watch.has_turned());
}

// SR-SEE05: a turn by 5 degrees in its mount is told within 0.5 s, although where the ground seems
// to sink the map has sunk with it.
TEST(MountWatch, ATurnIsToldWithinHalfASecond) {
  for (const float side : {-1.0f, 1.0f}) {
    for (const bool is_pitch : {true, false}) {
      Ground ground;
      ground.Ticks(100, [](float, float) { return 0.0f; });
      const auto tilted = [&](float x_m, float y_m) {
        return std::max(0.0f, side * 0.087f * (is_pitch ? x_m : y_m));
      };
      ground.Ticks(50, tilted);
      EXPECT_TRUE(ground.watch.has_turned());
      EXPECT_GT(ground.watch.turned_since_ns(), 1'950'000'000u);
      ground.Ticks(100, [](float, float) { return 0.0f; });
      EXPECT_TRUE(ground.watch.has_turned()) << "until somebody has looked at it";
      ground.watch.Reset();
      EXPECT_FALSE(ground.watch.has_turned());
    }
  }
}

// SR-SEE02
TEST(MountWatch, ABumpIsNoTurn) {
  Ground ground;
  for (int bump = 0; bump < 20; ++bump) {
    ground.Ticks(80, [](float, float) { return 0.0f; });
    ground.Ticks(20, [](float x_m, float) { return std::max(0.0f, 0.1f * x_m); });
  }
  EXPECT_FALSE(ground.watch.has_turned());
}

// SR-SEE02: what grows around the vehicle lifts some directions, by any angle.
TEST(MountWatch, BushesAreNoTurn) {
  struct Hedge {
    const char* name;
    bool (*covers)(float x_m, float y_m);
  };
  constexpr Hedge kHedges[] = {
      {"on one side", [](float x_m, float y_m) { return y_m > std::fabs(x_m); }},
      {"on both sides", [](float x_m, float y_m) { return std::fabs(y_m) > std::fabs(x_m); }},
      {"ahead", [](float x_m, float y_m) { return x_m > std::fabs(y_m); }},
      {"a corner", [](float x_m, float y_m) { return x_m > 0.0f && y_m > 0.0f; }},
  };
  for (const Hedge& hedge : kHedges) {
    Ground ground;
    std::minstd_rand random{5};
    ground.Ticks(
        300,
        [&](float x_m, float y_m) {
          const float share = static_cast<float>(random() % 1000u) * 0.001f;
          return hedge.covers(x_m, y_m) ? share : 0.0f;
        },
        80);
    EXPECT_FALSE(ground.watch.has_turned()) << hedge.name;
  }
}

// SR-SEE02: on a trail between bushes the ground shows along the trail. To both sides few returns
// pass for ground, here on one side all of them on leaves.
TEST(MountWatch, FewReturnsInGrowthSayNothing) {
  Ground ground;
  for (int tick = 0; tick < 300; ++tick) {
    ground.now_ns += kTick_ns;
    for (int i = 0; i < 24; ++i) {
      const float side = i % 2 == 0 ? 1.0f : -1.0f;
      const float way_m = 5.5f + 0.2f * static_cast<float>(i);
      ground.watch.Add({side * way_m, 0.3f * static_cast<float>(i % 5 - 2)}, 0.01f);
    }
    for (int sector = 1; sector < 8; ++sector) {
      const double angle = 0.3927 * sector;
      const auto x_m = static_cast<float>(6.0 * std::cos(angle));
      const auto y_m = static_cast<float>(6.0 * std::sin(angle));
      ground.watch.Add({x_m, y_m}, 0.8f);
      ground.watch.Add({-x_m, -y_m}, 0.01f);
    }
    ground.watch.Advance(ground.now_ns);
  }
  EXPECT_FALSE(ground.watch.has_turned());
}

// A turn is told although a third of the returns come from bushes.
TEST(MountWatch, ATurnAmongBushesIsTold) {
  Ground ground;
  std::minstd_rand random{5};
  const auto bush = [&](float step_m) {
    return random() % 3u == 0 ? step_m + static_cast<float>(random() % 800u) * 0.001f : step_m;
  };
  ground.Ticks(300, [&](float, float) { return bush(0.0f); });
  EXPECT_FALSE(ground.watch.has_turned());
  ground.Ticks(50, [&](float x_m, float) { return bush(std::max(0.0f, 0.13f * x_m)); });
  EXPECT_TRUE(ground.watch.has_turned());
}

// SR-SEE05: in any direction, between two sectors too.
TEST(MountWatch, ATurnAboutAnyLevelAxisIsTold) {
  for (int degrees = 0; degrees < 360; degrees += 9) {
    const float cos = std::cos(static_cast<float>(degrees) * 0.0174533f);
    const float sin = std::sin(static_cast<float>(degrees) * 0.0174533f);
    Ground ground;
    ground.Ticks(100, [](float, float) { return 0.0f; });
    ground.Ticks(
        50, [&](float x_m, float y_m) { return std::max(0.0f, 0.087f * (cos * x_m + sin * y_m)); });
    EXPECT_TRUE(ground.watch.has_turned()) << degrees;
  }
}

TEST(MountWatch, TooFewOrUnusableReturnsSayNothing) {
  Ground ground;
  ground.Ticks(
      200, [](float x_m, float) { return 0.2f * x_m; }, 2);
  EXPECT_FALSE(ground.watch.has_turned());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 1000; ++i) {
    ground.watch.Add({kNan, 1.0f}, 0.0f);
    ground.watch.Add({1.0f, 1.0f}, kNan);
    ground.watch.Add({1.0f, 1.0f}, 50.0f);
    ground.watch.Add({1.0f, 1.0f}, 0.5f);  // all at one place
    ground.now_ns += kTick_ns;
    ground.watch.Advance(ground.now_ns);
  }
  EXPECT_FALSE(ground.watch.has_turned());
}

}  // namespace
}  // namespace hardpack
