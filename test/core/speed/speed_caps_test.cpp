// SPDX-License-Identifier: Apache-2.0
#include "core/speed/speed_caps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

#include "core/path/path.h"

namespace hardpack {
namespace {

// A map whose ground was observed everywhere, until a test says otherwise, and a path along x.
struct FlatGround {
  std::unique_ptr<Costmap> map = std::make_unique<Costmap>();
  SpeedParams speed;
  VehicleParams vehicle;
  WorldPath path;
  float driven_mps = 2.0f;
  std::unique_ptr<SpeedCaps> caps = std::make_unique<SpeedCaps>();

  explicit FlatGround(float length_m = 30.0f, float step_m = 0.275f) {
    map->window.origin = {-256, -256};
    std::memset(map->flags, Costmap::kObserved, sizeof(map->flags));
    std::memset(map->hard_distance2, kMaxDistance2_cells2, sizeof(map->hard_distance2));
    for (float x_m = 0.0f; x_m <= length_m && !path.full(); x_m += step_m) {
      EXPECT_EQ(path.PushBack({x_m, 0.0f, 0.0f}), Status::kOk);
    }
  }
  uint8_t& At(float x_m, float y_m) { return map->flags[map->window.Index(CellAt({x_m, y_m}))]; }
  // The ground from x0 to x1, of all cells from y0 to y1.
  void Hide(float x0, float x1, float y0 = -3.0f, float y1 = 3.0f) {
    for (float x = x0 + 0.1f; x < x1; x += 0.2f) {
      for (float y = y0 + 0.1f; y < y1; y += 0.2f) At(x, y) = 0;
    }
  }
  const SpeedCaps& Caps(int units = SpeedCaps::kMaxUnits) {
    caps->Begin(map->window, speed, vehicle, path, driven_mps);
    int steps = 0;
    while (caps->Step(*map, speed, vehicle, path, units) == Progress::kBusy) {
      EXPECT_LT(++steps, SpeedCaps::kMaxUnits);
    }
    return *caps;
  }
  float CapAt(float x_m) { return caps->cap_mps()[static_cast<size_t>(std::lround(x_m / 0.275f))]; }
  CapCause CauseAt(float x_m) { return caps->cause(static_cast<int>(std::lround(x_m / 0.275f))); }
};

TEST(SpeedCaps, ObservedGroundDoesNotCap) {
  FlatGround ground;
  EXPECT_EQ(ground.Caps().observed_m(), SpeedCaps::kFar_m);
  EXPECT_EQ(ground.CapAt(5.5f), ground.speed.max_speed_mps);
  EXPECT_EQ(ground.CauseAt(29.7f), CapCause::kPathEnd);
}

//  [>]=====wwwwww=======
// Growth under a wheel or under the middle slows the vehicle from where its front is in it; beside
// the outline it does not.
// SR-LOW03
TEST(SpeedCaps, GrowthIsDrivenSlowlyFromWhereTheFrontIsInIt) {
  for (const float y_m : {-0.5f, 0.1f, 0.5f, 2.1f}) {
    FlatGround ground;
    ground.speed.growth_speed_mps = 1.5f;
    for (float x_m = 12.1f; x_m < 16.0f; x_m += 0.2f) {
      ground.At(x_m, y_m) |= Costmap::kGrowth;
    }
    ground.Caps();
    const bool is_in = y_m < 1.0f;
    const float front_m = FootprintOf(ground.vehicle).front_m;
    for (float x_m = 0.275f; x_m < 18.0f; x_m += 0.275f) {
      // A chord that begins up to its own length before the growth and the samples' 0.1 m.
      if (x_m > 12.0f - front_m + 0.275f && x_m < 15.9f) {
        EXPECT_EQ(ground.CapAt(x_m), is_in ? 1.5f : ground.speed.max_speed_mps) << x_m;
        EXPECT_EQ(ground.CauseAt(x_m) == CapCause::kGrowth, is_in) << x_m;
      } else if (x_m < 12.0f - front_m - 0.7f || x_m > 16.7f) {
        EXPECT_EQ(ground.CapAt(x_m), ground.speed.max_speed_mps) << x_m;
      }
    }
    EXPECT_EQ(ground.caps->observed_m(), SpeedCaps::kFar_m);
  }
}

// A path in reverse along x, by a vehicle whose axle is nearer to its front, then forward again.
struct BackwardGround : FlatGround {
  static constexpr int kBack = 60;  // points
  BackwardGround() {
    vehicle.axle_offset_m = 0.4f;
    path.Clear();
    for (int k = 0; k <= kBack; ++k) Put(k);
    for (int k = kBack; k >= 20; --k) Put(k);
  }
  void Put(int k) {
    EXPECT_EQ(path.PushBack({0.275f * static_cast<float>(k), 0.0f, kPi}), Status::kOk);
  }
};

// SR-STA04
TEST(SpeedCaps, InReverseItIsSlow) {
  BackwardGround ground;
  ground.Caps();
  for (int k = 0; k < BackwardGround::kBack; ++k) {
    EXPECT_EQ(ground.caps->cap_mps()[static_cast<size_t>(k)], ground.speed.max_reverse_mps) << k;
    EXPECT_EQ(ground.caps->cause(k), CapCause::kReverse) << k;
  }
  EXPECT_GT(ground.caps->cap_mps()[BackwardGround::kBack + 5], 2.0f);
}

// SR-STA05
TEST(SpeedCaps, InReverseTheRearIsWhatStopsBeforeUnobservedGround) {
  BackwardGround ground;
  ground.Hide(12.0f, 40.0f);
  EXPECT_NEAR(ground.Caps().observed_m(), 12.0f, 0.11f);
  const float rear_m = 0.5f * ground.vehicle.length_m + 0.4f + ground.speed.unseen_margin_m;
  for (int k = 1; k < BackwardGround::kBack; ++k) {
    const float free_m = std::max(0.0f, 12.0f - rear_m - 0.275f * static_cast<float>(k));
    const float cap_mps = ground.caps->cap_mps()[static_cast<size_t>(k)];
    EXPECT_LE(StoppingDistance(ground.speed, cap_mps), free_m + 0.11f) << k;
    if (free_m > 1.0f) {
      EXPECT_EQ(cap_mps, ground.speed.max_reverse_mps) << k;
    }
  }
}

//  =====>|  ?????      the end of the stretch in reverse is observed, but not what is behind the
//  rear
// SR-STA05
TEST(SpeedCaps, BehindTheEndOfAStretchInReverseTheGroundIsObservedToo) {
  BackwardGround ground;
  const float end_m = 0.275f * BackwardGround::kBack;
  ground.Hide(end_m + 0.3f, end_m + 6.0f);
  EXPECT_LT(ground.Caps().observed_m(), end_m + 0.5f);
  EXPECT_EQ(ground.caps->cap_mps()[BackwardGround::kBack - 1], 0.0f);
  // What lies farther behind than the rear reaches does not matter.
  BackwardGround clear;
  clear.Hide(end_m + 2.2f, end_m + 8.0f);
  EXPECT_EQ(clear.Caps().observed_m(), SpeedCaps::kFar_m);
  // Nor does it make up for what is not observed where the vehicle drives next, to the left.
  BackwardGround left;
  left.path.Resize(BackwardGround::kBack + 1);
  for (int k = 0; k <= 20; ++k) {
    ASSERT_EQ(left.path.PushBack({end_m, 0.275f * static_cast<float>(k), 0.5f * kPi}), Status::kOk);
  }
  left.Hide(end_m - 0.95f, end_m - 0.45f, 0.0f, 4.0f);
  EXPECT_LT(left.Caps().observed_m(), end_m + 0.3f);
}

//  [>]=============?????????
// SR-SPD02
TEST(SpeedCaps, StopsBeforeTheEndOfTheObservedGround) {
  FlatGround ground;
  ground.Hide(12.0f, 40.0f);
  EXPECT_NEAR(ground.Caps().observed_m(), 12.0f, 0.11f);
  for (float x_m = 0.0f; x_m < 11.0f; x_m += 0.275f) {
    const float kept_m = 0.5f * ground.vehicle.length_m + ground.speed.unseen_margin_m;
    const float free_m = std::max(0.0f, 12.0f - kept_m - x_m);
    EXPECT_LE(StoppingDistance(ground.speed, ground.CapAt(x_m)), free_m + 0.11f) << x_m;
    EXPECT_GE(StoppingDistance(ground.speed, ground.CapAt(x_m)) + 0.2f,
              std::min(free_m, StoppingDistance(ground.speed, ground.speed.max_speed_mps)))
        << x_m;
  }
  EXPECT_EQ(ground.CapAt(11.55f), 0.0f);
  EXPECT_EQ(ground.CapAt(29.7f), 0.0f);
  EXPECT_EQ(ground.CauseAt(11.55f), CapCause::kUnseenGround);
}

// SR-SPD02
TEST(SpeedCaps, GapsUpToTheParameterAreBridgedAndWiderOnesAreNot) {
  for (int cells = 1; cells <= 8; ++cells) {
    FlatGround ground;
    const float width_m = 0.2f * static_cast<float>(cells);
    ground.Hide(10.0f, 10.0f + width_m);
    const bool ends = ground.Caps().observed_m() < SpeedCaps::kFar_m;
    // By the samples' spacing of 0.1 m.
    if (width_m < 0.55f) {
      EXPECT_FALSE(ends) << width_m;
    }
    if (width_m > 0.75f) {
      EXPECT_TRUE(ends) << width_m;
    }
  }
}

// A wall beside the path hides what is behind it until the vehicle is past it.
struct Corner : FlatGround {
  Lookouts lookouts;

  // FlatGround from x0 to x1, from the middle of the path to beyond its left edge.
  Corner(float x0, float x1) {
    Hide(x0, x1, 0.0f, 3.0f);
    for (float y_m = 0.1f; y_m < 8.0f; y_m += 0.2f) At(x0 - 0.1f, y_m) |= Costmap::kHard;
    lookouts.blind_m = 3.0f;
    for (float x_m = -7.0f; x_m <= 0.0f; x_m += 1.0f) lookouts.Add({x_m, 0.1f}, 0.0f);
  }
  void Look() {
    caps->Begin(map->window, speed, vehicle, path, driven_mps, lookouts);
    while (caps->Step(*map, speed, vehicle, path, 1) == Progress::kBusy) {
    }
  }
};

// SR-SPD06
TEST(SpeedCaps, CreepsOverHiddenGroundAndNoFasterBeforeAndBehindIt) {
  Corner corner(5.0f, 7.0f);
  corner.Look();
  EXPECT_EQ(corner.caps->observed_m(), SpeedCaps::kFar_m);
  const Footprint footprint = FootprintOf(corner.vehicle);
  const float first_m = 5.0f - footprint.front_m - corner.speed.unseen_margin_m;
  const float last_m = 7.0f - footprint.rear_m;
  for (float x_m = 0.275f; x_m < 18.0f; x_m += 0.275f) {
    if (x_m > first_m && x_m < last_m - 0.2f) {
      EXPECT_EQ(corner.CapAt(x_m), corner.speed.hidden_creep_mps) << x_m;
      EXPECT_EQ(corner.CauseAt(x_m), CapCause::kHiddenGround) << x_m;
    } else if (x_m < first_m - 0.3f || x_m > last_m + 0.3f) {
      EXPECT_EQ(corner.CapAt(x_m), corner.speed.max_speed_mps) << x_m;
    }
  }
  corner.speed.hidden_creep_mps = 0.0f;
  corner.Look();
  EXPECT_NEAR(corner.caps->observed_m(), 5.0f, 0.21f);
  EXPECT_EQ(corner.CauseAt(5.5f), CapCause::kUnseenGround);
}

// SR-SPD06
TEST(SpeedCaps, AGapInViewOfAnyLookoutStopsIt) {
  Corner corner(5.0f, 7.0f);
  corner.lookouts.places_odom[2] = {4.0f, 8.1f};
  corner.At(4.9f, 7.9f) = Costmap::kObserved;
  for (float y_m = 0.1f; y_m < 8.0f; y_m += 0.2f) corner.At(4.9f, y_m) = Costmap::kObserved;
  corner.Look();
  EXPECT_NEAR(corner.caps->observed_m(), 5.0f, 0.21f);
}

// What was in view is counted together, however shadows lie between it.
// SR-SPD06
TEST(SpeedCaps, AGapThatAShadowDividesIsAsLongAsItsParts) {
  for (const bool is_long : {false, true}) {
    Corner corner(5.0f, 7.0f);
    // The part behind the wall that a lookout sees.
    corner.Hide(7.0f, is_long ? 7.9f : 7.3f, 0.0f, 3.0f);
    for (float y_m = 0.1f; y_m < 8.0f; y_m += 0.2f) corner.At(6.9f, y_m) |= Costmap::kHard;
    corner.lookouts.places_odom[0] = {8.1f, 8.1f};
    corner.Look();
    EXPECT_EQ(corner.caps->observed_m() < SpeedCaps::kFar_m, is_long) << is_long;
  }
}

TEST(SpeedCaps, AShortShadowIsBridgedAsAGapIs) {
  Corner corner(5.0f, 5.4f);
  corner.Look();
  EXPECT_EQ(corner.caps->observed_m(), SpeedCaps::kFar_m);
  EXPECT_EQ(corner.CapAt(5.5f), corner.speed.max_speed_mps);
}

// SR-SPD06
TEST(SpeedCaps, FarAwayHiddenGroundEndsTheObservedGround) {
  Corner corner(9.0f, 12.0f);
  corner.Look();
  EXPECT_NEAR(corner.caps->observed_m(), 9.0f, 0.21f);
}

// Nothing is seen behind 5 m: the vehicle has climbed there, so it creeps on, as far as it may.
// SR-SPD09
TEST(SpeedCaps, CreepsOverABrowThatTheVehicleHasClimbedTo) {
  FlatGround ground;
  ground.Hide(5.0f, 30.0f, -12.0f, 12.0f);
  const auto no_terrain = std::make_unique<Terrain>();
  for (const bool has_climbed : {false, true}) {
    Lookouts lookouts;
    lookouts.blind_m = 3.0f;
    for (float x_m = -11.0f; x_m <= 0.0f; x_m += 1.0f) {
      lookouts.Add({x_m, 0.1f}, has_climbed ? 0.15f * x_m : 0.0f);
    }
    ground.caps->Begin(ground.map->window, ground.speed, ground.vehicle, ground.path, 2.0f,
                       lookouts);
    while (ground.caps->Step(*ground.map, ground.speed, ground.vehicle, ground.path, 100, nullptr,
                             no_terrain.get()) == Progress::kBusy) {
    }
    EXPECT_NEAR(ground.caps->observed_m(), has_climbed ? SpeedCaps::kCreepAhead_m : 5.0f, 0.21f);
    EXPECT_EQ(ground.CauseAt(5.1f),
              has_climbed ? CapCause::kHiddenGround : CapCause::kUnseenGround);
    EXPECT_EQ(ground.CapAt(5.1f), has_climbed ? ground.speed.hidden_creep_mps : 0.0f);
  }
}

TEST(SpeedCaps, HiddenGroundGivesTheSameInAnyPortions) {
  Corner corner(5.0f, 7.0f);
  corner.Look();
  const auto once = corner.caps->cap_mps();
  const std::vector<float> whole(once.begin(), once.end());
  corner.caps->Begin(corner.map->window, corner.speed, corner.vehicle, corner.path,
                     corner.driven_mps, corner.lookouts);
  while (corner.caps->Step(*corner.map, corner.speed, corner.vehicle, corner.path, 13) ==
         Progress::kBusy) {
  }
  const auto caps = corner.caps->cap_mps();
  EXPECT_TRUE(std::equal(caps.begin(), caps.end(), whole.begin(), whole.end()));
}

// A post beside the path: the discs' radius, half a cell's diagonal and the room together are
// 1.08 m, between cell centres.
// SR-SPD05
TEST(SpeedCaps, DrivesSlowlyWhereThereIsLittleRoom) {
  for (int cells_aside = 0; cells_aside <= 8; ++cells_aside) {
    FlatGround ground;
    const Cell post = {CellAt({12.0f, 0.0f}).x, CellAt({12.0f, 0.0f}).y + cells_aside};
    for (int32_t y = -20; y <= 20; ++y) {
      for (int32_t x = -20; x <= 20; ++x) {
        const int distance2 = std::min(x * x + y * y, kMaxDistance2_cells2);
        ground.map->hard_distance2[ground.map->window.Index({post.x + x, post.y + y})] =
            static_cast<uint8_t>(distance2);
      }
    }
    ground.Caps();
    const bool is_narrow = cells_aside <= 5;
    EXPECT_EQ(ground.caps->narrow(), is_narrow) << cells_aside;
    // Nearer than the discs reach there is no room at all.
    const float little_mps =
        cells_aside <= 4 ? ground.speed.least_room_mps : ground.speed.min_speed_mps;
    const float expected = is_narrow ? little_mps : ground.speed.max_speed_mps;
    // The discs are 0.38 m ahead of and behind the vehicle's middle.
    EXPECT_EQ(ground.CapAt(11.55f), expected) << cells_aside;
    EXPECT_EQ(ground.CapAt(12.375f), expected) << cells_aside;
    EXPECT_EQ(ground.CapAt(9.9f), ground.speed.max_speed_mps) << cells_aside;
    EXPECT_EQ(ground.CapAt(14.3f), ground.speed.max_speed_mps) << cells_aside;
    if (is_narrow) {
      EXPECT_EQ(ground.CauseAt(12.1f), CapCause::kLittleRoom);
    }
  }
}

// A ditch under one wheel alone, one that it is beside, and one further off.
// SR-SPD02
TEST(SpeedCaps, LooksUnderBothWheels) {
  for (const float side : {-1.0f, 1.0f}) {
    FlatGround under;
    under.Hide(9.8f, 12.0f, side > 0.0f ? 0.4f : -0.8f, side > 0.0f ? 0.8f : -0.4f);
    EXPECT_NEAR(under.Caps().observed_m(), 9.8f, 0.11f);
    FlatGround edge;
    edge.Hide(9.8f, 12.0f, side > 0.0f ? 0.8f : -3.0f, side > 0.0f ? 3.0f : -0.8f);
    EXPECT_NEAR(edge.Caps().observed_m(), 9.8f, 0.11f);
    FlatGround beside;
    beside.Hide(9.8f, 12.0f, side > 0.0f ? 1.0f : -3.0f, side > 0.0f ? 3.0f : -1.0f);
    EXPECT_EQ(beside.Caps().observed_m(), SpeedCaps::kFar_m);
  }
}

TEST(SpeedCaps, LooksWhereTheVehiclesFrontStandsAtThePathsEnd) {
  FlatGround ground(10.0f);
  ground.Hide(9.9f, 20.0f);
  ground.speed.max_unseen_m = 0.5f;
  ground.Caps();
  EXPECT_EQ(ground.CapAt(9.9f), 0.0f);
  EXPECT_NEAR(ground.caps->observed_m(), 9.9f, 0.11f);
  EXPECT_EQ(ground.CauseAt(9.35f), CapCause::kUnseenGround);
}

TEST(SpeedCaps, KeepsTheMarginAtThePathsEnd) {
  FlatGround ground(10.0f);
  const float kept_m = 0.5f * ground.vehicle.length_m + ground.speed.unseen_margin_m;
  ground.Hide(10.2f + kept_m, 20.0f);
  EXPECT_EQ(ground.Caps().observed_m(), SpeedCaps::kFar_m);
  ground.Hide(9.6f + kept_m, 20.0f);
  ground.speed.max_unseen_m = 0.0f;
  EXPECT_NEAR(ground.Caps().observed_m(), 9.6f + kept_m, 0.31f);
  EXPECT_EQ(ground.CapAt(9.9f), 0.0f);
}

// SR-SPD02
TEST(SpeedCaps, TheMapsEdgeEndsTheObservedGround) {
  FlatGround ground(60.0f);
  ground.Caps();
  EXPECT_NEAR(ground.caps->observed_m(), 51.2f, 0.15f);
}

TEST(SpeedCaps, APathOfOnePointOrATurnOnTheSpotIsNoWay) {
  FlatGround one(0.0f);
  ASSERT_EQ(one.path.size(), 1);
  EXPECT_EQ(one.Caps().cap_mps()[0], 0.0f);
  FlatGround turn(0.0f);
  ASSERT_EQ(turn.path.PushBack({0.0f, 0.0f, 1.0f}), Status::kOk);
  EXPECT_EQ(turn.Caps().cap_mps()[1], 0.0f);
  EXPECT_EQ(turn.caps->cause(0), CapCause::kPathEnd);
}

TEST(SpeedCaps, AnySplitOfTheUnitsGivesTheSame) {
  FlatGround ground;
  ground.Hide(14.0f, 40.0f);
  ground.At(9.0f, 2.0f) |= Costmap::kHard | Costmap::kPerson;
  const SpeedCaps whole = ground.Caps();
  for (const int units : {1, 3, 64}) {
    const SpeedCaps& split = ground.Caps(units);
    for (int k = 0; k < ground.path.size(); ++k) {
      ASSERT_EQ(split.cap_mps()[static_cast<size_t>(k)], whole.cap_mps()[static_cast<size_t>(k)]);
      ASSERT_EQ(split.cause(k), whole.cause(k));
    }
  }
}

//            P   3 m beside
//   [>]=========================
// No stop before the person is possible any more from 0.8 m on: it goes by slowly, if it is slow.
TEST(SpeedCaps, CreepsPastAPersonWhoLeavesRoom) {
  FlatGround ground;
  ground.driven_mps = 0.5f;
  ground.At(9.0f, 3.0f) |= Costmap::kHard | Costmap::kPerson;
  ground.Caps();
  float least_mps = 1e9f;
  for (float x_m = 0.0f; x_m < 9.5f; x_m += 0.275f) {
    least_mps = std::min(least_mps, ground.CapAt(x_m));
  }
  EXPECT_EQ(least_mps, ground.speed.person_creep_mps);
  EXPECT_EQ(ground.CapAt(13.0f), ground.speed.max_speed_mps);
  ground.driven_mps = 1.5f;
  ground.Caps();
  EXPECT_EQ(ground.CapAt(7.975f), 0.0f);
  ground.driven_mps = 0.5f;
  ground.speed.person_creep_mps = 0.0f;
  ground.Caps();
  EXPECT_EQ(ground.CapAt(7.975f), 0.0f);
  EXPECT_EQ(ground.CauseAt(7.975f), CapCause::kPerson);
}

TEST(SpeedCaps, SlowForAPersonOnTheLongestPath) {
  const float step_m = 0.1f;
  FlatGround longest(1000.0f, step_m);
  ASSERT_TRUE(longest.path.full());
  const float end_m = step_m * static_cast<float>(longest.path.size() - 1);
  FlatGround shorter(end_m - 10.0f, step_m);
  for (FlatGround* ground : {&longest, &shorter}) {
    ground->driven_mps = 0.5f;
    ground->At(9.0f, 3.0f) |= Costmap::kHard | Costmap::kPerson;
    ground->Caps();
  }
  for (size_t k = 0; step_m * static_cast<float>(k) < 9.0f; ++k) {
    ASSERT_EQ(longest.caps->cap_mps()[k], shorter.caps->cap_mps()[k]) << k;
  }
  EXPECT_EQ(longest.caps->cap_mps()[80], longest.speed.person_creep_mps);
}

//              person
//   [>]=============|===========   free again behind the person, but not to be driven to
TEST(SpeedCaps, WhereItHasToStandItIsNotDrivenAnyFurther) {
  FlatGround ground;
  ground.At(9.0f, 0.0f) |= Costmap::kHard | Costmap::kPerson;
  ground.Caps();
  const float free_again_m = ground.CapAt(11.0f);
  ASSERT_GT(free_again_m, 1.0f);
  const auto stands = static_cast<int>(std::lround(8.25f / 0.275f));
  ASSERT_EQ(ground.CapAt(8.25f), 0.0f);
  ground.caps->StandFrom(stands + 20);  // it is behind the person already
  EXPECT_EQ(ground.CapAt(11.0f), free_again_m);
  ground.caps->StandFrom(0);
  EXPECT_GT(ground.CapAt(2.75f), 1.0f);
  EXPECT_EQ(ground.CapAt(5.5f), ground.speed.person_creep_mps) << "who may come nearer";
  for (float x_m = 8.25f; x_m < 29.8f; x_m += 0.275f) {
    EXPECT_EQ(ground.CapAt(x_m), 0.0f) << x_m;
    EXPECT_EQ(ground.CauseAt(x_m), CapCause::kPerson) << x_m;
  }
}

//   P           of a vehicle whose middle is at 0.825 m the rear, 0.76 m behind that, is past it
//   [>]======
TEST(SpeedCaps, AreFreeAgainOnceTheVehicleIsPastAPersonAtTheStart) {
  FlatGround ground;
  ground.At(0.1f, 0.1f) |= Costmap::kHard | Costmap::kPerson;
  ground.Caps();
  EXPECT_EQ(ground.CauseAt(0.0f), CapCause::kPerson);
  EXPECT_EQ(ground.CauseAt(0.55f), CapCause::kPerson);
  EXPECT_NE(ground.CauseAt(0.825f), CapCause::kPerson);
  EXPECT_EQ(ground.CapAt(0.825f), ground.speed.max_speed_mps);
}

// SR-SPD03
TEST(SpeedCaps, StandsForAPersonWhoCouldStepIntoTheWay) {
  for (const float beside_m : {0.0f, 0.9f, 1.5f, 1.9f}) {
    FlatGround ground;
    ground.At(9.0f, beside_m) |= Costmap::kHard | Costmap::kPerson;
    ground.Caps();
    EXPECT_EQ(ground.CapAt(8.25f), 0.0f) << beside_m;
    EXPECT_EQ(ground.CauseAt(8.25f), CapCause::kPerson) << beside_m;
  }
}
// A hard cell so far to the left of the path, all along it: what the distance field says.
void PutWall(FlatGround& ground, int cells) {
  for (int y = 0; y < kMapSize_cells; ++y) {
    for (int x = 0; x < kMapSize_cells; ++x) {
      const int away = y - (256 + cells);
      const int distance2 = std::min(away * away, kMaxDistance2_cells2);
      ground.map->hard_distance2[y * kMapSize_cells + x] = static_cast<uint8_t>(distance2);
    }
  }
}

// SR-MOV03 the less room beside the path, the slower
TEST(SpeedCaps, LittleRoomBesideABendIsDrivenSlowly) {
  FlatGround straight;
  PutWall(straight, 7);  // 1.4 m: 0.51 m of room
  straight.Caps();
  EXPECT_NEAR(straight.caps->room_m(20), 0.51f, 0.01f);
  const float straight_mps = straight.CapAt(5.5f);
  FlatGround bent;
  PutWall(bent, 7);
  // Bends of 0.4 / m to and fro, a hand's breadth off the straight line.
  float heading = 0.0f;
  for (int k = 0; k < bent.path.size(); ++k) {
    heading += (k / 4 % 2 == 0 ? 0.11f : -0.11f);
    bent.path[k].theta_rad = heading;
  }
  bent.Caps();
  EXPECT_LT(bent.CapAt(5.5f), 0.75f * straight_mps);
  const SpeedParams& speed = bent.speed;
  const float cap_mps = bent.CapAt(5.5f);
  EXPECT_NEAR(speed.track_error_m + speed.track_error_s * cap_mps +
                  speed.track_error_s2 * cap_mps * cap_mps * 0.4f,
              0.51f, 0.02f)
      << "what it may be off by is the room";
  EXPECT_EQ(bent.CauseAt(5.5f), CapCause::kLittleRoom);
}

// SR-MOV03
TEST(SpeedCaps, WithoutAnyRoomItIsDrivenAtTheLeast) {
  FlatGround ground;
  PutWall(ground, 4);
  ground.Caps();
  EXPECT_EQ(ground.caps->room_m(20), 0.0f);
  EXPECT_EQ(ground.CapAt(5.5f), ground.speed.least_room_mps);
}

//  [>]======|zone|======
// SR-ARE05
TEST(SpeedCaps, ASpeedZoneCapsWhereTheOutlineMayTouchIt) {
  FlatGround ground;
  const auto areas = std::make_unique<AreaSet>();
  Area zone;
  zone.kind = AreaKind::kSpeedZone;
  zone.speed_mps = 1.25f;
  zone.corners = 4;
  zone.corner[0] = {.x_mm = 10'000, .y_mm = -2000};
  zone.corner[1] = {.x_mm = 15'000, .y_mm = -2000};
  zone.corner[2] = {.x_mm = 15'000, .y_mm = 2000};
  zone.corner[3] = {.x_mm = 10'000, .y_mm = 2000};
  Area keep_out = zone;
  keep_out.kind = AreaKind::kKeepOut;
  keep_out.speed_mps = 0.0f;
  ASSERT_EQ(areas->Take(0, 2, keep_out), Status::kOk);
  ASSERT_EQ(areas->Take(1, 2, zone), Status::kOk);
  std::vector<float> whole;
  for (const int units : {SpeedCaps::kMaxUnits, 1, 7}) {
    ground.caps->Begin(ground.map->window, ground.speed, ground.vehicle, ground.path, 2.0f);
    while (ground.caps->Step(*ground.map, ground.speed, ground.vehicle, ground.path, units,
                             areas.get()) == Progress::kBusy) {
    }
    const auto caps = ground.caps->cap_mps();
    if (whole.empty()) whole.assign(caps.begin(), caps.end());
    EXPECT_TRUE(std::equal(caps.begin(), caps.end(), whole.begin(), whole.end())) << units;
  }
  const Footprint footprint = FootprintOf(ground.vehicle);
  const float first_m = 10.0f - footprint.front_m;
  const float last_m = 15.0f - footprint.rear_m;
  for (float x_m = 0.275f; x_m < 18.5f; x_m += 0.275f) {
    const bool must_be_slow = x_m > first_m - SpeedCaps::kZoneAhead_m && x_m < last_m;
    const bool may_be_slow = x_m > first_m - SpeedCaps::kZoneAhead_m - 0.3f &&
                             x_m < last_m + SpeedCaps::kZoneAhead_m + 0.3f;
    if (must_be_slow) {
      EXPECT_EQ(ground.CapAt(x_m), 1.25f) << x_m;
      EXPECT_EQ(ground.CauseAt(x_m), CapCause::kSpeedZone) << x_m;
    } else if (!may_be_slow) {
      EXPECT_EQ(ground.CapAt(x_m), ground.speed.max_speed_mps) << x_m;
    }
  }
}

// SR-SLP01
TEST(SpeedCaps, StandsBeforeGroundThatIsTooSteep) {
  FlatGround ground;
  ground.Caps();
  constexpr float kSteep_m = 20.0f;
  ground.caps->Begin(ground.map->window, ground.speed, ground.vehicle, ground.path, 2.0f, {},
                     nullptr, kSteep_m);
  while (ground.caps->Step(*ground.map, ground.speed, ground.vehicle, ground.path,
                           SpeedCaps::kMaxUnits) == Progress::kBusy) {
  }
  const float front_m = FootprintOf(ground.vehicle).front_m + ground.speed.unseen_margin_m;
  for (float x_m = 0.0f; x_m < 29.0f; x_m += 0.275f) {
    const float free_m = kSteep_m - front_m - x_m;
    const float most_mps = free_m > 0.0f ? ReactionSpeedCap(ground.speed, free_m) : 0.0f;
    EXPECT_LE(ground.CapAt(x_m), most_mps + 1.0e-3f) << x_m;
  }
  EXPECT_EQ(ground.CapAt(5.5f), ground.speed.max_speed_mps);
  EXPECT_EQ(ground.CauseAt(18.7f), CapCause::kSteepGround);
}

}  // namespace
}  // namespace hardpack
