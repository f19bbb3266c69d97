// SPDX-License-Identifier: Apache-2.0
#include "core/people/people_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;
constexpr int kTicksARevolution = 10;

// Somebody is seen once a revolution, in a few columns one after the other.
struct Watched {
  PeopleTracks tracks;
  uint64_t now_ns = 5'000'000'000;
  std::vector<Vec2> left;

  void Tick() {
    now_ns += kTick_ns;
    Vec2 place;
    if (tracks.TakeLeft(now_ns, place)) left.push_back(place);
  }
  void See(Vec2 middle) {
    for (int column = -2; column <= 2; ++column) {
      tracks.Look({middle.x_m, middle.y_m + 0.1f * static_cast<float>(column)}, now_ns);
    }
  }
  // From `from` at a velocity, seen for so many revolutions.
  Vec2 Walk(Vec2 from, Vec2 velocity_mps, int revolutions, bool is_seen = true) {
    Vec2 at = from;
    for (int revolution = 0; revolution < revolutions; ++revolution) {
      if (is_seen) See(at);
      for (int tick = 0; tick < kTicksARevolution; ++tick) Tick();
      at = {at.x_m + 0.1f * velocity_mps.x_m, at.y_m + 0.1f * velocity_mps.y_m};
    }
    return at;
  }
  bool HasLeftNear(Vec2 place, float within_m) const {
    for (const Vec2& one : left) {
      if (std::hypot(one.x_m - place.x_m, one.y_m - place.y_m) <= within_m) return true;
    }
    return false;
  }
};

// SR-PER11
TEST(PeopleTracks, EachPlaceIsLeftOnceItsPersonIsSeenElsewhere) {
  for (const float speed_mps : {0.3f, 1.0f, 2.0f}) {
    Watched watched;
    const int revolutions = static_cast<int>(60.0f / speed_mps);
    const Vec2 end = watched.Walk({0.0f, 0.0f}, {speed_mps, 0.0f}, revolutions);
    EXPECT_EQ(watched.tracks.size(), 1);
    for (float x_m = 0.0f; x_m < end.x_m - 1.5f; x_m += 0.1f) {
      EXPECT_TRUE(watched.HasLeftNear({x_m, 0.0f}, 0.5f)) << x_m << " at " << speed_mps;
    }
    for (const Vec2& place : watched.left) {
      EXPECT_LE(place.x_m, end.x_m - PeopleTracks::kLeft_m + 0.3f);
    }
  }
}

// SR-PER11
TEST(PeopleTracks, WhoStandsHasLeftNothing) {
  Watched watched;
  for (int i = 0; i < 300; ++i) {
    watched.Walk({4.0f + (i % 2 == 0 ? 0.15f : -0.15f), 1.0f}, {0.0f, 0.0f}, 1);
  }
  EXPECT_TRUE(watched.left.empty());
  EXPECT_EQ(watched.tracks.size(), 1);
}

// SR-PER11
TEST(PeopleTracks, WhoCrouchesIsNotTakenForSomebodyWhoWalksPast) {
  Watched watched;
  watched.Walk({4.0f, 0.0f}, {0.0f, 0.0f}, 20);
  watched.Walk({4.0f, 0.0f}, {0.0f, 0.0f}, 10, false);
  // Somebody else comes through the very place.
  watched.Walk({4.0f, -4.0f}, {0.0f, 1.5f}, 60);
  EXPECT_FALSE(watched.HasLeftNear({4.0f, 0.0f}, 0.9f));
  EXPECT_TRUE(watched.HasLeftNear({4.0f, -2.5f}, 0.5f)) << "whose own places are left";
  EXPECT_TRUE(watched.HasLeftNear({4.0f, 2.5f}, 0.5f));
}

// SR-PER11
TEST(PeopleTracks, BesideSomebodyWhoStaysNothingIsLeft) {
  Watched watched;
  Vec2 walker = {4.0f, -1.7f};
  for (int revolution = 0; revolution < 60; ++revolution) {
    watched.See({4.8f, 0.0f});
    walker = watched.Walk(walker, {0.0f, 1.2f}, 1);
  }
  EXPECT_FALSE(watched.HasLeftNear({4.0f, -1.7f}, 0.3f)) << "it was not left when they met";
  EXPECT_TRUE(watched.HasLeftNear({4.0f, 2.5f}, 0.5f));
  for (const Vec2& place : watched.left) {
    EXPECT_GE(std::hypot(place.x_m - 4.8f, place.y_m), PeopleTracks::kBeside_m - 0.2f);
  }
}

// Behind a tree for half a second: nobody knows whether the one who comes out is the same.
// SR-PER11
TEST(PeopleTracks, WhoWasOutOfSightIsSomebodyElseAfterwards) {
  Watched watched;
  const Vec2 tree = watched.Walk({0.0f, 0.0f}, {1.5f, 0.0f}, 20);
  const Vec2 out = watched.Walk(tree, {1.5f, 0.0f}, 5, false);
  watched.Walk(out, {1.5f, 0.0f}, 30);
  EXPECT_EQ(watched.tracks.size(), 2);
  EXPECT_FALSE(watched.HasLeftNear(tree, 0.7f));
}

// Two side by side are one track; one of them crouches, and the other walks on.
// SR-PER11
TEST(PeopleTracks, OfTwoSideBySideNothingIsLeft) {
  Watched watched;
  for (int revolution = 0; revolution < 30; ++revolution) {
    watched.See({4.0f, 0.0f});
    watched.See({4.0f, 0.7f});
    watched.Walk({4.0f, 0.0f}, {0.0f, 0.0f}, 1, false);
  }
  watched.Walk({4.0f, 0.7f}, {0.0f, 1.5f}, 40);
  EXPECT_FALSE(watched.HasLeftNear({4.0f, 0.3f}, 0.9f));
}

TEST(PeopleTracks, NobodyIsFasterThanTheGate) {
  Watched watched;
  watched.Walk({0.0f, 0.0f}, {0.0f, 0.0f}, 5);
  watched.Walk({1.5f, 0.0f}, {0.0f, 0.0f}, 20);
  EXPECT_TRUE(watched.left.empty());
  EXPECT_EQ(watched.tracks.size(), 2);
}

TEST(PeopleTracks, OfACrowdTheLongestUnseenAreForgotten) {
  Watched watched;
  for (int revolution = 0; revolution < 3; ++revolution) {
    for (int i = 0; i < 2 * PeopleTracks::kMost; ++i) {
      watched.See({3.0f * static_cast<float>(i), 0.0f});
    }
    watched.Walk({0.0f, 0.0f}, {0.0f, 0.0f}, 1, false);
  }
  EXPECT_EQ(watched.tracks.size(), PeopleTracks::kMost);
  watched.now_ns += 2 * PeopleTracks::kUnseen_ns;
  watched.Walk({-50.0f, 0.0f}, {1.0f, 0.0f}, 40);
  EXPECT_EQ(watched.tracks.size(), PeopleTracks::kMost);
  EXPECT_TRUE(watched.HasLeftNear({-50.0f, 0.0f}, 0.5f));
}

// Ground that is labelled a person, here and there.
TEST(PeopleTracks, ASingleWrongLabelGuardsNothing) {
  Watched watched;
  Vec2 walker = {4.0f, -4.0f};
  for (int revolution = 0; revolution < 60; ++revolution) {
    const float y_m = -3.0f + 0.1f * static_cast<float>(revolution);
    if (revolution % 20 == 10) watched.tracks.Look({5.3f, y_m}, watched.now_ns);
    walker = watched.Walk(walker, {0.0f, 1.5f}, 1);
  }
  for (float y_m = -3.5f; y_m < 3.0f; y_m += 0.1f) {
    EXPECT_TRUE(watched.HasLeftNear({4.0f, y_m}, 0.8f)) << y_m;
  }
  EXPECT_LE(watched.tracks.size(), 4);
}

TEST(PeopleTracks, WhatIsNotANumberIsNobody) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PeopleTracks tracks;
  tracks.Look({nan, 0.0f}, 1);
  tracks.Look({0.0f, std::numeric_limits<float>::infinity()}, 1);
  EXPECT_EQ(tracks.size(), 0);
  Vec2 place;
  EXPECT_FALSE(tracks.TakeLeft(2, place));
}

// Walkers at random, of whom some stop and crouch: nothing is left where one does, whoever walks
// past and is taken for whom. Who is seen is filed again at once. SR-PER11
TEST(PeopleTracks, NothingIsLeftWhereSomebodyCrouches) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> at(-6.0f, 6.0f);
  std::uniform_real_distribution<float> chance(0.0f, 1.0f);
  int left = 0;
  for (int run = 0; run < 200; ++run) {
    Watched watched;
    struct Walker {
      Vec2 place;
      Vec2 velocity;
      int unseen = 0;
      int seen = 0;
    };
    std::vector<Walker> walkers(6);
    for (Walker& walker : walkers) {
      walker = {{at(random), at(random)}, {at(random) / 4.0f, at(random) / 4.0f}, 0, 0};
    }
    for (int revolution = 0; revolution < 200; ++revolution) {
      for (Walker& walker : walkers) {
        if (walker.unseen > 0) {
          --walker.unseen;
          walker.seen = 0;
          continue;
        }
        // Bodies do not overlap.
        const bool is_apart =
            std::none_of(walkers.begin(), walkers.end(), [&](const Walker& other) {
              return &other != &walker && std::hypot(other.place.x_m - walker.place.x_m,
                                                     other.place.y_m - walker.place.y_m) < 0.6f;
            });
        const bool is_sure = ++walker.seen > PeopleTracks::kSurePasses;
        if (is_sure && is_apart && chance(random) < 0.01f) walker.unseen = 30;
        walker.place.x_m += 0.1f * walker.velocity.x_m;
        walker.place.y_m += 0.1f * walker.velocity.y_m;
        if (std::fabs(walker.place.x_m) > 6.0f) walker.velocity.x_m *= -1.0f;
        if (std::fabs(walker.place.y_m) > 6.0f) walker.velocity.y_m *= -1.0f;
        watched.See(walker.place);
      }
      for (int tick = 0; tick < kTicksARevolution; ++tick) {
        watched.left.clear();
        watched.Tick();
        left += static_cast<int>(watched.left.size());
        for (const Vec2& place : watched.left) {
          for (const Walker& walker : walkers) {
            if (walker.unseen == 0) continue;
            const float off_m =
                std::hypot(place.x_m - walker.place.x_m, place.y_m - walker.place.y_m);
            EXPECT_GT(off_m, 0.5f) << run << ' ' << revolution;
          }
        }
      }
    }
  }
  EXPECT_GT(left, 1000);
}

constexpr float kPersonSpeed_mps = 2.0f;

Walkers WalkersOf(const Watched& watched) {
  Walkers walkers;
  watched.tracks.Walk(watched.now_ns, kPersonSpeed_mps, walkers);
  return walkers;
}

// SR-PER12
TEST(PeopleTracks, TellsTheVelocityOfWhoWalks) {
  for (const float speed_mps : {0.7f, 1.4f, 2.0f}) {
    SCOPED_TRACE(speed_mps);
    Watched watched;
    const Vec2 end = watched.Walk({0.0f, 0.0f}, {0.6f * speed_mps, -0.8f * speed_mps}, 15);
    const Walkers walkers = WalkersOf(watched);
    ASSERT_EQ(walkers.size(), 1);
    EXPECT_NEAR(walkers[0].velocity_mps.x_m, 0.6f * speed_mps, 0.1f);
    EXPECT_NEAR(walkers[0].velocity_mps.y_m, -0.8f * speed_mps, 0.1f);
    EXPECT_NEAR(walkers[0].place_odom.x_m, end.x_m, 0.1f) << "where they are now";
    EXPECT_NEAR(walkers[0].place_odom.y_m, end.y_m, 0.1f);
    EXPECT_LE(walkers[0].doubt_mps, 1.3f);
    EXPECT_GE(walkers[0].doubt_mps, 0.5f) << "whoever walks may turn";
  }
}

// SR-PER12
TEST(PeopleTracks, WhoStandsMaySetOffAnywhere) {
  Watched watched;
  watched.Walk({3.0f, 1.0f}, {0.0f, 0.0f}, 30);
  const Walkers walkers = WalkersOf(watched);
  ASSERT_EQ(walkers.size(), 1);
  EXPECT_EQ(walkers[0].doubt_mps, kPersonSpeed_mps);
}

// SR-PER12
TEST(PeopleTracks, NothingIsKnownOfWhoHasJustAppeared) {
  Watched watched;
  for (int revolutions = 1; revolutions < PeopleTracks::kKnownPasses; ++revolutions) {
    watched.Walk({0.15f * static_cast<float>(revolutions), 0.0f}, {1.5f, 0.0f}, 1);
    const Walkers walkers = WalkersOf(watched);
    ASSERT_EQ(walkers.size(), 1) << "somebody is there from the first return on";
    EXPECT_EQ(walkers[0].doubt_mps, kPersonSpeed_mps) << revolutions;
    EXPECT_EQ(walkers[0].velocity_mps.x_m, 0.0f);
  }
  watched.Walk({0.9f, 0.0f}, {1.5f, 0.0f}, 2);
  EXPECT_LT(WalkersOf(watched)[0].doubt_mps, kPersonSpeed_mps);
}

// Of two who come close nobody knows who walks on.
// SR-PER12
TEST(PeopleTracks, NothingIsKnownOfTwoWhoMeet) {
  Watched watched;
  const auto most_doubt_mps = [&] {
    float most_mps = 0.0f;
    for (const Walker& walker : WalkersOf(watched)) most_mps = std::max(most_mps, walker.doubt_mps);
    return most_mps;
  };
  float apart_mps = 0.0f;
  for (int revolution = 0; revolution < 19; ++revolution) {
    const float x_m = 0.1f * static_cast<float>(revolution) - 2.2f;
    watched.See({x_m, 0.0f});
    watched.See({-x_m, 0.3f});
    if (revolution == 10) apart_mps = most_doubt_mps();
    for (int tick = 0; tick < kTicksARevolution; ++tick) watched.Tick();
  }
  EXPECT_EQ(watched.tracks.size(), 2);
  EXPECT_LT(apart_mps, kPersonSpeed_mps) << "before they meet";
  EXPECT_EQ(most_doubt_mps(), kPersonSpeed_mps) << "0.8 m apart";
}

// Behind a post, lying down: for good, unless the place is seen without them.
// SR-PER12
TEST(PeopleTracks, WhoIsOutOfSightStaysUntilTheirPlaceIsSeenEmpty) {
  Watched watched;
  watched.Walk({4.0f, 0.0f}, {0.0f, 1.0f}, 20);
  watched.Walk({}, {}, 600, false);
  const Walkers walkers = WalkersOf(watched);
  ASSERT_EQ(walkers.size(), 1);
  EXPECT_NEAR(walkers[0].place_odom.y_m, 1.9f, 0.1f);
  EXPECT_EQ(walkers[0].doubt_mps, kPersonSpeed_mps);
  Vec2 lost;
  ASSERT_TRUE(watched.tracks.LookForLost(watched.now_ns, lost));
  EXPECT_EQ(lost.x_m, walkers[0].place_odom.x_m);
  EXPECT_EQ(lost.y_m, walkers[0].place_odom.y_m);
  watched.tracks.ForgetLost();
  EXPECT_TRUE(WalkersOf(watched).empty());
  EXPECT_FALSE(watched.tracks.LookForLost(watched.now_ns, lost));
}

// Below the beams nobody is seen: they are not expected to walk, but nothing of them is released.
// SR-PER11
TEST(PeopleTracks, BesideAPlaceThatWasSeenEmptyNothingIsLeft) {
  Watched watched;
  watched.Walk({4.0f, 0.0f}, {0.0f, 0.0f}, 20);
  watched.Walk({}, {}, 30, false);
  Vec2 lost;
  ASSERT_TRUE(watched.tracks.LookForLost(watched.now_ns, lost));
  watched.tracks.ForgetLost();
  watched.Walk({4.0f, -4.0f}, {0.0f, 1.5f}, 60);
  EXPECT_FALSE(watched.HasLeftNear({4.0f, 0.0f}, 0.9f));
  EXPECT_TRUE(watched.HasLeftNear({4.0f, 2.5f}, 0.5f));
}

// SR-PER12
TEST(PeopleTracks, NobodyInSightIsLookedFor) {
  Watched watched;
  watched.Walk({4.0f, 0.0f}, {0.0f, 1.0f}, 20);
  watched.See({4.0f, 2.0f});
  Vec2 lost;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(watched.tracks.LookForLost(watched.now_ns, lost));
}

// One who was out of sight, and one who appears where they could have walked to, are one walker;
// farther off, or much later, they are two.
// SR-PER12
TEST(PeopleTracks, WhoAppearsNearByIsWhoWasOutOfSight) {
  const auto walkers_after = [](int unseen, float off_m) {
    Watched watched;
    const Vec2 tree = watched.Walk({0.0f, 0.0f}, {1.5f, 0.0f}, 20);
    watched.Walk(tree, {}, unseen, false);
    watched.Walk({tree.x_m + off_m, 0.0f}, {1.5f, 0.0f}, 10);
    return WalkersOf(watched).size();
  };
  EXPECT_EQ(walkers_after(6, 0.9f), 1);
  EXPECT_EQ(walkers_after(6, 3.0f), 2);
  EXPECT_EQ(walkers_after(25, 4.0f), 1);
  EXPECT_EQ(walkers_after(40, 4.0f), 2);
}

// A single return that was labelled wrongly is nobody a moment later.
// SR-PER12
TEST(PeopleTracks, WhoWasSeenOnceIsNotLookedFor) {
  Watched watched;
  watched.Walk({4.0f, 0.0f}, {}, 1);
  EXPECT_EQ(WalkersOf(watched).size(), 1);
  watched.Walk({}, {}, 3, false);
  EXPECT_TRUE(WalkersOf(watched).empty());
}

// Labels come late, and not in order: what was measured earlier tells nothing new.
TEST(PeopleTracks, GoesByWhenItWasMeasured) {
  Watched late;
  Vec2 at = {0.0f, 0.0f};
  uint64_t newest_ns = 0;
  for (int revolution = 0; revolution < 30; ++revolution) {
    at.x_m += 0.12f;
    // 50 or 190 ms ago, and where it was then.
    const uint64_t ago_ns = revolution % 2 == 0 ? 50'000'000 : 190'000'000;
    const float ago_s = 1e-9f * static_cast<float>(ago_ns);
    newest_ns = std::max(newest_ns, late.now_ns - ago_ns);
    late.tracks.Look({at.x_m - 1.2f * ago_s, 0.0f}, late.now_ns, late.now_ns - ago_ns);
    for (int tick = 0; tick < kTicksARevolution; ++tick) late.Tick();
  }
  const Walkers walkers = WalkersOf(late);
  ASSERT_EQ(walkers.size(), 1);
  EXPECT_NEAR(walkers[0].velocity_mps.x_m, 1.2f, 0.15f);
  EXPECT_NEAR(walkers[0].place_odom.x_m, at.x_m + 0.12f, 0.15f);
}

TEST(PeopleTracks, KnowsWhoIsNear) {
  Watched watched;
  const Vec2 end = watched.Walk({2.0f, 0.0f}, {0.0f, 1.0f}, 10);
  const auto is_near = [&](Vec2 place, float reach_m, uint64_t for_ns) {
    return watched.tracks.IsAnyoneWithin(place, reach_m, watched.now_ns, for_ns);
  };
  EXPECT_TRUE(is_near(end, 0.5f, 2'000'000'000));
  EXPECT_FALSE(is_near({2.0f, 0.0f}, 0.5f, 2'000'000'000)) << "where they are not any more";
  EXPECT_FALSE(is_near(end, 0.5f, 10'000'000)) << "seen 0.1 s ago";
  watched.Walk({}, {}, 10, false);
  EXPECT_TRUE(is_near(end, 0.5f, 2'000'000'000));
  watched.Walk({}, {}, 11, false);
  EXPECT_FALSE(is_near(end, 0.5f, 2'000'000'000));
}

}  // namespace
}  // namespace hardpack
