// SPDX-License-Identifier: Apache-2.0
#include "core/people/moving_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "core/base/loop_bound.h"

namespace hardpack {
namespace {

constexpr int kColumns = 1024;
constexpr float kRange_m = 15.0f;

struct Disc {
  Vec2 middle;
  float radius_m = 0.0f;
};
struct Wall {  // from one end to the other
  Vec2 from;
  Vec2 to;
};

// A lidar that turns over discs and walls, and the map that its returns make: level ground all
// around, seen wherever nothing hides it.
struct Scene {
  std::vector<Disc> discs;
  std::vector<Wall> walls;
  Vec2 here;
  uint64_t now_ns = 1'000'000'000;
  float noise_m = 0.02f;
  std::mt19937 random{7};
  std::unique_ptr<HeightGrid> heights = std::make_unique<HeightGrid>();
  MovingBodies bodies;
  std::vector<Vec2> moving;  // told in the last revolution

  std::optional<float> RangeOf(Vec2 direction) const {
    std::optional<float> range_m;
    const auto take = [&](float at_m) {
      if (at_m > 0.0f && at_m < kRange_m) range_m = std::min(range_m.value_or(at_m), at_m);
    };
    for (const Disc& disc : discs) {
      const Vec2 arm = Minus(disc.middle, here);
      const float along_m = arm.x_m * direction.x_m + arm.y_m * direction.y_m;
      const float aside_m = arm.x_m * direction.y_m - arm.y_m * direction.x_m;
      const float half2 = disc.radius_m * disc.radius_m - aside_m * aside_m;
      if (half2 > 0.0f) take(along_m - std::sqrt(half2));
    }
    for (const Wall& wall : walls) {
      const Vec2 along = Minus(wall.to, wall.from);
      const Vec2 arm = Minus(wall.from, here);
      const float cross = direction.x_m * along.y_m - direction.y_m * along.x_m;
      if (std::fabs(cross) < 1e-6f) continue;
      const float at_m = (arm.x_m * along.y_m - arm.y_m * along.x_m) / cross;
      const float part = (arm.x_m * direction.y_m - arm.y_m * direction.x_m) / cross;
      if (part >= 0.0f && part <= 1.0f) take(at_m);
    }
    return range_m;
  }
  void SeeGround(Vec2 direction, float to_m) {
    for (float at_m = 1.0f; at_m < to_m; at_m += 0.1f) {
      const Vec3 ground = {here.x_m + at_m * direction.x_m, here.y_m + at_m * direction.y_m, 0.0f};
      EXPECT_EQ(heights->Insert(ground, ReturnClass::kGround), Status::kOk);
    }
  }
  // Somebody walks, once the ground has been seen without them.
  Vec2& Enter(Vec2 middle) {
    for (int i = 0; i < 2; ++i) Turn();
    discs.push_back({middle, 0.25f});
    return discs.back().middle;
  }
  void Walk(Vec2& at, Vec2 velocity_mps, int revolutions) {
    for (int i = 0; i < revolutions; ++i) {
      Turn();
      at = {at.x_m + 0.1f * velocity_mps.x_m, at.y_m + 0.1f * velocity_mps.y_m};
    }
  }
  // One revolution, as the chain makes it: what a column has seen is filed before it is looked at.
  void Turn() {
    moving.clear();
    std::normal_distribution<float> noise(0.0f, noise_m);
    for (int column = 0; column < kColumns; ++column) {
      const float azimuth_rad = kTwoPi * static_cast<float>(column) / kColumns;
      const Vec2 direction = {std::cos(azimuth_rad), std::sin(azimuth_rad)};
      const std::optional<float> seen_m = RangeOf(direction);
      SeeGround(direction, seen_m.value_or(kRange_m) - 0.2f);
      const float range_m = seen_m.value_or(0.0f) + noise(random);
      const Vec2 hit = {here.x_m + range_m * direction.x_m, here.y_m + range_m * direction.y_m};
      if (seen_m) {
        for (const float z_m : {0.3f, 0.9f, 1.5f}) {
          EXPECT_EQ(heights->Insert({hit.x_m, hit.y_m, z_m}, ReturnClass::kHard), Status::kOk);
        }
      }
      Vec2 body;
      if (!bodies.Column(seen_m.has_value(), hit, range_m, now_ns, body)) continue;
      if (bodies.Look(body, now_ns, here, *heights)) moving.push_back(body);
    }
    now_ns += 100'000'000;
  }
};

// SR-PER13
TEST(MovingBodies, FindsWhoWalksWithinASecondAndAHalf) {
  for (const float speed_mps : {0.5f, 1.0f, 2.0f}) {
    SCOPED_TRACE(speed_mps);
    Scene scene;
    Vec2& at = scene.Enter({6.0f, -3.0f});
    int revolutions = 0;
    for (; scene.moving.empty() && revolutions < 40; ++revolutions) {
      scene.Walk(at, {0.0f, speed_mps}, 1);
    }
    EXPECT_LE(revolutions, 15);
    // And goes on to be told, where they are.
    for (int i = 0; i < 20; ++i) {
      const Vec2 was = at;
      scene.Walk(at, {0.0f, speed_mps}, 1);
      ASSERT_EQ(scene.moving.size(), 1u) << i;
      EXPECT_LT(std::hypot(scene.moving[0].x_m - was.x_m, scene.moving[0].y_m - was.y_m), 0.3f);
    }
  }
}

// SR-PER13
TEST(MovingBodies, WhoStopsGoesOnToBeTold) {
  Scene scene;
  Vec2& at = scene.Enter({6.0f, -3.0f});
  scene.Walk(at, {0.0f, 1.2f}, 15);
  EXPECT_EQ(scene.moving.size(), 1u);
  scene.Walk(at, {}, 100);
  EXPECT_EQ(scene.moving.size(), 1u);
}

// A bush lets the lidar through here and there: the pieces that it sees of it in one revolution are
// no walker, however they lie, unless the next revolutions see them go on.
// SR-PER13
TEST(MovingBodies, PiecesSeenInOneRevolutionAreOneLook) {
  for (const bool goes_on : {false, true}) {
    Scene scene;
    for (int i = 0; i < 2; ++i) scene.Turn();  // the ground all around
    const auto look = [&](float x_m) {
      return scene.bodies.Look({x_m, 3.0f}, scene.now_ns, scene.here, *scene.heights);
    };
    const auto turn = [&] { scene.now_ns += 100'000'000; };
    EXPECT_FALSE(look(5.0f));
    turn();
    EXPECT_FALSE(look(5.3f));
    turn();
    for (const float x_m : {5.55f, 5.6f, 5.65f, 5.7f}) EXPECT_FALSE(look(x_m));
    turn();
    for (const float x_m : {5.75f, 5.8f}) EXPECT_FALSE(look(x_m));
    turn();
    EXPECT_EQ(look(goes_on ? 5.9f : 5.45f), goes_on);
  }
}

// Along a fence one piece after the other stands out, as fast as somebody walks; the first one is
// still there. Of somebody who walks nothing is left.
// SR-PER13
TEST(MovingBodies, WhoWalksIsNoLongerWhereTheyWere) {
  for (const bool is_fence : {true, false}) {
    Scene scene;
    for (int i = 0; i < 2; ++i) scene.Turn();
    bool moves = false;
    for (int i = 0; i < 12; ++i) {
      Vec2 body;
      if (is_fence) scene.bodies.Column(true, {5.05f, 3.0f}, 5.8f, scene.now_ns, body);
      scene.now_ns += 1'000'000;
      const Vec2 place = {5.0f + 0.12f * static_cast<float>(i), 3.0f};
      moves = scene.bodies.Look(place, scene.now_ns, scene.here, *scene.heights);
      scene.now_ns += 99'000'000;
    }
    EXPECT_EQ(moves, !is_fence);
  }
}

//      | o  o   __     posts, a bush whose returns scatter, walls with gaps, and pieces of a wall
//    o | o     |       that come into view and go behind posts: none of them moves, from a vehicle
//      |_______|       that drives by
TEST(MovingBodies, NothingThatStandsMoves) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  int bodies = 0;
  for (int world = 0; world < 12; ++world) {
    Scene scene;
    scene.noise_m = world % 3 == 0 ? 0.15f : 0.03f;
    for (int i = 0; i < 25; ++i) {
      const float side = unit(random) < 0.5f ? -1.0f : 1.0f;
      scene.discs.push_back({{20.0f * unit(random), side * (1.5f + 8.0f * unit(random))},
                             0.05f + 0.6f * unit(random) * unit(random)});
    }
    for (int i = 0; i < 4; ++i) {
      const Vec2 from = {20.0f * unit(random), 6.0f + 5.0f * unit(random)};
      scene.walls.push_back(
          {from, {from.x_m + 6.0f * unit(random) - 1.0f, from.y_m - unit(random)}});
    }
    for (int revolution = 0; revolution < 60; ++revolution) {
      scene.here.x_m += 0.25f;
      EXPECT_EQ(scene.heights->Recenter(scene.here), Status::kOk);
      scene.Turn();
      EXPECT_TRUE(scene.moving.empty()) << world << ' ' << revolution;
    }
    bodies += scene.bodies.size();
  }
  EXPECT_GT(bodies, 60) << "there was nothing to be taken for somebody";
}

// What moves too slowly, is too wide, or came out of what was never seen.
TEST(MovingBodies, TellsOnlyWhatIsLikeAPersonWhoWalks) {
  const auto is_told = [](float radius_m, float speed_mps, bool has_wall) {
    Scene scene;
    Vec2& at = scene.Enter({6.0f, -4.0f});
    scene.discs[0].radius_m = radius_m;
    if (has_wall) scene.walls = {{{6.0f + radius_m + 0.2f, -9.0f}, {6.0f + radius_m + 0.2f, 9.0f}}};
    bool told = false;
    for (int i = 0; i < 40; ++i) {
      scene.Walk(at, {0.0f, speed_mps}, 1);
      told = told || !scene.moving.empty();
    }
    return told;
  };
  EXPECT_TRUE(is_told(0.25f, 1.0f, false));
  EXPECT_FALSE(is_told(0.25f, 0.1f, false)) << "too slow";
  EXPECT_FALSE(is_told(0.9f, 1.0f, false)) << "a car";
  EXPECT_FALSE(is_told(0.1f, 1.0f, true)) << "right before a wall: not seen to stand out";
}

// A body that is first seen in front of ground that nobody has seen: it was hidden.
TEST(MovingBodies, GroundThatWasNotSeenWasNotFree) {
  Scene scene;
  HeightGrid unseen;
  bool told = false;
  for (int i = 0; i < 30; ++i) {
    const Vec2 at = {6.0f, 0.12f * static_cast<float>(i)};
    told = told || scene.bodies.Look(at, scene.now_ns, scene.here, unseen);
    scene.now_ns += 100'000'000;
  }
  EXPECT_FALSE(told);
}

// More bodies than there is room for: the nearest are kept, and who moves is, however far.
TEST(MovingBodies, ForgetsTheFarthestOfTooMany) {
  for (const float farther_m : {0.0f, 30.0f}) {
    Scene scene;
    scene.Walk(scene.Enter({6.0f, -3.0f}), {0.0f, 1.2f}, 15);
    ASSERT_EQ(scene.moving.size(), 1u);
    for (int i = 0; i < 3 * MovingBodies::kMost; ++i) {
      const Vec2 at = {farther_m + 0.5f * static_cast<float>(i % 10) - 2.0f,
                       0.5f * static_cast<float>(i / 10) - 2.0f};
      scene.bodies.Look(at, scene.now_ns, scene.here, *scene.heights);
      EXPECT_LE(scene.bodies.size(), MovingBodies::kMost);
    }
    EXPECT_EQ(scene.bodies.size(), MovingBodies::kMost);
    scene.Turn();
    EXPECT_EQ(scene.moving.size(), 1u) << "who moves is kept";
  }
}

// Columns' returns at these distances; the number of bodies that end.
int BodiesOf(const std::vector<float>& distances_m) {
  MovingBodies bodies;
  bodies.Reset();
  int ended = 0;
  for (size_t i = 0; i < distances_m.size(); ++i) {
    const float m = distances_m[i];
    const float aside_m = 0.05f * static_cast<float>(i);
    Vec2 body;
    ended += bodies.Column(m > 0.0f, {m, aside_m}, m, 0, body) ? 1 : 0;
  }
  return ended;
}

TEST(MovingBodies, ABodyIsNearerThanWhatIsOnBothSides) {
  EXPECT_EQ(BodiesOf({0, 0, 6, 6, 6, 0, 0}), 1);
  EXPECT_EQ(BodiesOf({9, 9, 6, 6, 6, 9, 9}), 1);
  EXPECT_EQ(BodiesOf({4, 4, 6, 6, 6, 0, 0}), 1) << "the near one only";
  EXPECT_EQ(BodiesOf({9, 9, 6, 6, 6, 4, 4}), 0) << "what is behind it goes on";
  EXPECT_EQ(BodiesOf({0, 6, 0, 6, 0}), 0) << "single returns";
  EXPECT_EQ(BodiesOf(std::vector<float>(40, 6.0f)), 0) << "a wall";
}

// One of two posts is hidden and the other one comes into view: a step, and then it stands.
TEST(MovingBodies, WhatHasMadeOneStepDoesNotMove) {
  Scene scene;
  scene.Turn();
  const auto is_told = [&](Vec2 at) {
    scene.now_ns += 100'000'000;
    return scene.bodies.Look(at, scene.now_ns, scene.here, *scene.heights);
  };
  EXPECT_FALSE(is_told({6.0f, 0.0f}));
  EXPECT_FALSE(is_told({6.0f, 0.3f}));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(is_told({6.0f, 0.6f})) << i;
}

// Where something stood before, nothing has walked to.
TEST(MovingBodies, WhereSomethingStoodNothingWalksTo) {
  Scene scene;
  scene.walls = {{{6.0f, -4.0f}, {6.0f, 4.0f}}};
  scene.Turn();
  bool told = false;
  for (int i = 0; i < 12; ++i) {
    scene.now_ns += 100'000'000;
    const Vec2 at = {6.0f, 0.1f * static_cast<float>(i)};
    told = told || scene.bodies.Look(at, scene.now_ns, scene.here, *scene.heights);
  }
  EXPECT_FALSE(told);
}

TEST(MovingBodies, ForgetsWhatWasNotSeenForAWhile) {
  Scene scene;
  scene.Walk(scene.Enter({6.0f, -3.0f}), {0.0f, 1.2f}, 15);
  ASSERT_EQ(scene.moving.size(), 1u);
  scene.now_ns += 1'000'000'000;
  scene.Turn();
  EXPECT_TRUE(scene.moving.empty());
  scene.bodies.Reset();
  EXPECT_EQ(scene.bodies.size(), 0);
}

TEST(MovingBodies, IgnoresWhatIsNotANumber) {
  Scene scene;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  Vec2 body;
  for (const float bad : {nan, infinity, -infinity, 3.0e38f}) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_FALSE(scene.bodies.Column(true, {bad, 1.0f}, 2.0f, scene.now_ns, body)) << bad;
      EXPECT_FALSE(scene.bodies.Column(true, {1.0f, 1.0f}, bad, scene.now_ns, body)) << bad;
    }
    scene.bodies.Column(false, {}, 0.0f, scene.now_ns, body);
    EXPECT_FALSE(scene.bodies.Look({bad, 0.0f}, scene.now_ns, scene.here, *scene.heights));
  }
  for (int i = 0; i < 3; ++i) scene.Turn();
  EXPECT_TRUE(scene.moving.empty());
}

}  // namespace
}  // namespace hardpack
