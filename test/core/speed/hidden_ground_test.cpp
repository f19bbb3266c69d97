// SPDX-License-Identifier: Apache-2.0
#include "core/speed/hidden_ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <random>

namespace hardpack {
namespace {

struct Place {
  std::unique_ptr<Costmap> map = std::make_unique<Costmap>();
  Lookouts lookouts;

  Place() {
    map->window.origin = {-256, -256};
    std::memset(map->flags, Costmap::kObserved, sizeof(map->flags));
    lookouts.blind_m = 3.0f;
  }
  void Wall(float x_m, float low_y_m, float high_y_m) {
    for (float y_m = low_y_m; y_m <= high_y_m; y_m += 0.1f) {
      map->flags[map->window.Index(CellAt({x_m, y_m}))] |= Costmap::kHard;
    }
  }
  bool Hidden(float x_m, float y_m) const { return IsHidden(*map, lookouts, CellAt({x_m, y_m})); }
};

TEST(HiddenGround, WithoutALookoutNothingIsHidden) {
  Place place;
  place.Wall(2.1f, -3.0f, 3.0f);
  EXPECT_FALSE(place.Hidden(4.1f, 0.1f));
}

//   o      #
//   blind  # hidden
//          #
// SR-SPD06
TEST(HiddenGround, WhatAWallShadowsIsHiddenUntilAPlaceLooksBehindIt) {
  Place place;
  place.Wall(4.1f, 0.0f, 6.0f);
  place.lookouts.Add({0.1f, 0.1f}, 0.0f);
  EXPECT_TRUE(place.Hidden(6.1f, 2.1f));
  EXPECT_FALSE(place.Hidden(6.1f, -1.1f)) << "beside the shadow: nothing came back, so it is a gap";
  place.lookouts.Add({4.1f, -4.1f}, 0.0f);
  EXPECT_FALSE(place.Hidden(6.1f, 2.1f));
}

//   o...#.hidden         seen from the first place only over the wall, from the second not at all
// SR-SPD06
TEST(HiddenGround, WhatIsNearerThanTheLowestBeamIsHiddenOnlyIfItWasShadowedBefore) {
  Place place;
  place.lookouts.Add({2.1f, 0.1f}, 0.0f);
  EXPECT_FALSE(place.Hidden(4.3f, 0.1f)) << "2.2 m away: nobody has looked there, as at the start";
  place.lookouts.Add({-1.0f, 0.1f}, 0.0f);
  EXPECT_FALSE(place.Hidden(4.3f, 0.1f)) << "in view from 5.3 m";
  place.Wall(1.1f, -1.0f, 1.0f);
  EXPECT_TRUE(place.Hidden(4.3f, 0.1f));
  place.lookouts.Add({-1.0f, 4.1f}, 0.0f);
  EXPECT_FALSE(place.Hidden(4.3f, 0.1f)) << "past the wall's end";
}

TEST(HiddenGround, GrowthAndSoftThingsHideNothing) {
  Place place;
  place.Wall(4.1f, -2.0f, 2.0f);
  for (uint8_t& flags : place.map->flags) {
    if ((flags & Costmap::kHard) != 0) flags = Costmap::kSoft | Costmap::kGrowth;
  }
  place.lookouts.Add({0.1f, 0.1f}, 0.0f);
  EXPECT_FALSE(place.Hidden(6.1f, 0.1f));
}

TEST(HiddenGround, BeyondItsReachALookoutNeitherShowsNorShadows) {
  Place place;
  place.Wall(2.1f, -4.0f, 4.0f);
  place.lookouts.Add({0.1f, 0.1f}, 0.0f);
  EXPECT_TRUE(place.Hidden(9.9f, 0.1f));
  EXPECT_FALSE(place.Hidden(10.5f, 0.1f));
}

TEST(HiddenGround, LinesLeadToTheCellFromAnyPlaceToAnyOther) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-7.0f, 7.0f);
  Place place;
  for (int i = 0; i < 20000; ++i) {
    place.lookouts.Clear();
    const Vec2 from = {at(random), at(random)};
    place.lookouts.Add(from, 0.0f);
    const Vec2 ground = {at(random), at(random)};
    const float way_m = std::hypot(from.x_m - ground.x_m, from.y_m - ground.y_m);
    if (std::fabs(way_m - 3.0f) < 0.3f || std::fabs(way_m - Lookouts::kReach_m) < 0.3f) continue;
    const Cell cell = CellAt(ground);
    EXPECT_FALSE(IsHidden(*place.map, place.lookouts, cell)) << "no wall is between";
    // Just before the cell, on the line to it.
    const float share = (way_m - 0.5f) / way_m;
    const Cell before = CellAt(
        {from.x_m + share * (ground.x_m - from.x_m), from.y_m + share * (ground.y_m - from.y_m)});
    for (int32_t dy = -1; dy <= 1; ++dy) {
      for (int32_t dx = -1; dx <= 1; ++dx) {
        const Cell beside = {before.x + dx, before.y + dy};
        if (!(beside == cell)) place.map->flags[place.map->window.Index(beside)] |= Costmap::kHard;
      }
    }
    const bool is_in_reach = way_m > 3.0f && way_m < Lookouts::kReach_m;
    EXPECT_EQ(IsHidden(*place.map, place.lookouts, cell), is_in_reach);
    std::memset(place.map->flags, Costmap::kObserved, sizeof(place.map->flags));
  }
}

TEST(Lookouts, KeepsTheLastPlacesAMetreApartAndThePresentOne) {
  Lookouts lookouts;
  for (int step = 0; step <= 2000; ++step) {
    const float x_m = 0.01f * static_cast<float>(step);
    lookouts.Add({x_m, 5.0f}, 0.0f);
    EXPECT_EQ(lookouts.places_odom.back().x_m, x_m);
  }
  ASSERT_EQ(lookouts.places_odom.size(), Lookouts::kMost);
  for (int k = 0; k + 2 < Lookouts::kMost; ++k) {
    EXPECT_NEAR(lookouts.places_odom[k + 1].x_m - lookouts.places_odom[k].x_m, Lookouts::kApart_m,
                0.02f);
  }
  EXPECT_NEAR(lookouts.places_odom[0].x_m, 20.0f - 11.0f, 1.1f);
}

// Up a slope of 0.15 by 1.5 m, then on level ground.
TEST(Lookouts, RememberTheClimbForAWhile) {
  Lookouts lookouts;
  for (int step = 0; step <= 4000; ++step) {
    const float x_m = 0.01f * static_cast<float>(step);
    lookouts.Add({x_m, 0.0f}, std::fmin(0.15f * x_m, 1.5f));
    const bool remembers = x_m > 7.0f && x_m < 30.0f;
    if (remembers) {
      EXPECT_NEAR(lookouts.climb.x_m, 0.15f, 0.01f) << x_m;
      EXPECT_EQ(lookouts.climb.y_m, 0.0f) << x_m;
    } else if (x_m < 5.0f || x_m > 38.0f) {
      EXPECT_EQ(Length(lookouts.climb), 0.0f) << x_m;
    }
  }
  lookouts.Clear();
  EXPECT_TRUE(lookouts.places_odom.empty());
  EXPECT_EQ(Length(lookouts.climb), 0.0f);
}

TEST(Lookouts, RememberWhichWayTheyClimbed) {
  Lookouts lookouts;
  for (int step = 0; step <= 1000; ++step) {
    const float on_m = 0.01f * static_cast<float>(step);
    lookouts.Add({-0.8f * on_m, 0.6f * on_m}, 0.2f * on_m);
  }
  EXPECT_NEAR(lookouts.climb.x_m, -0.16f, 0.01f);
  EXPECT_NEAR(lookouts.climb.y_m, 0.12f, 0.01f);
}

TEST(Lookouts, NoClimbIsALowRiseAWayDownOrAStand) {
  Lookouts rise;
  Lookouts down;
  for (int step = 0; step <= 3000; ++step) {
    const float x_m = 0.01f * static_cast<float>(step);
    rise.Add({x_m, 0.0f}, 0.3f * std::sin(x_m));
    down.Add({x_m, 0.0f}, -0.2f * x_m);
    EXPECT_EQ(Length(rise.climb), 0.0f);
    EXPECT_EQ(Length(down.climb), 0.0f);
  }
  for (int tick = 0; tick < 100; ++tick)
    down.Add({30.0f, 0.0f}, -6.0f + 0.02f * static_cast<float>(tick));
  EXPECT_EQ(Length(down.climb), 0.0f) << "a height that drifts at rest";
}

TEST(Lookouts, AVehicleThatStandsKeepsWhereItCameFrom) {
  Lookouts lookouts;
  for (int step = 0; step <= 400; ++step)
    lookouts.Add({0.01f * static_cast<float>(step), 0.0f}, 0.0f);
  const float first_m = lookouts.places_odom[0].x_m;
  for (int tick = 0; tick < 1000; ++tick) lookouts.Add({4.0f, tick % 2 == 0 ? 0.001f : 0.0f}, 0.0f);
  EXPECT_EQ(lookouts.places_odom[0].x_m, first_m);
}

}  // namespace
}  // namespace hardpack
