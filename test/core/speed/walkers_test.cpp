// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "core/people/people_tracks.h"
#include "core/speed/speed_caps.h"

// Speed caps for people whose walk is known.

namespace hardpack {
namespace {

constexpr float kStep_m = 0.275f;

struct Way {
  std::unique_ptr<Costmap> map = std::make_unique<Costmap>();
  SpeedParams speed;
  VehicleParams vehicle;
  WorldPath path;
  std::unique_ptr<SpeedCaps> caps = std::make_unique<SpeedCaps>();

  Way() {
    map->window.origin = {-256, -256};
    std::memset(map->flags, Costmap::kObserved, sizeof(map->flags));
    std::memset(map->hard_distance2, kMaxDistance2_cells2, sizeof(map->hard_distance2));
    LayFrom(0.0f);
  }
  void LayFrom(float from_m) {
    path.Clear();
    for (float x_m = from_m; x_m <= 40.0f; x_m += kStep_m) {
      EXPECT_EQ(path.PushBack({x_m, 0.0f, 0.0f}), Status::kOk);
    }
  }
  void AddPersonCell(float x_m, float y_m) {
    map->flags[map->window.Index(CellAt({x_m, y_m}))] |= Costmap::kHard | Costmap::kPerson;
  }
  const SpeedCaps& Cap(const Walkers* walkers, float driven_mps = 2.0f, int units = 100000) {
    caps->Begin(map->window, speed, vehicle, path, driven_mps, {}, walkers);
    int steps = 0;
    while (caps->Step(*map, speed, vehicle, path, units) == Progress::kBusy) {
      EXPECT_LT(++steps, SpeedCaps::kMaxUnits);
    }
    return *caps;
  }
  float At(float x_m) const {
    return caps->cap_mps()[static_cast<size_t>(std::lround((x_m - path[0].x_m) / kStep_m))];
  }
};

Walkers One(Walker walker) {
  Walkers walkers;
  EXPECT_EQ(walkers.PushBack(walker), Status::kOk);
  return walkers;
}

// Of whom nothing is known counts as their cells do.
TEST(WalkerCaps, WhoMayWalkAnywhereCapsLikeTheirCells) {
  for (const float aside_m : {0.0f, 2.1f, 4.1f}) {
    SCOPED_TRACE(aside_m);
    Way by_cells;
    for (const float x_m : {-0.2f, 0.0f, 0.2f}) {
      for (const float y_m : {-0.2f, 0.0f, 0.2f}) by_cells.AddPersonCell(9.1f + x_m, aside_m + y_m);
    }
    by_cells.Cap(nullptr);
    Way way;
    const Walkers walkers = One({{9.1f, aside_m}, {}, way.speed.person_speed_mps});
    way.Cap(&walkers);
    for (float x_m = 0.0f; x_m < 8.5f; x_m += kStep_m) {
      EXPECT_NEAR(way.At(x_m), by_cells.At(x_m), 0.3f) << x_m;
    }
  }
}

//       p          walks away from the way, or towards it
//   [>]=============
// SR-SPD08
TEST(WalkerCaps, AreHigherOnlyForWhoWalksAway) {
  Way anywhere;
  const Walkers unknown = One({{9.1f, 4.0f}, {}, anywhere.speed.person_speed_mps});
  anywhere.Cap(&unknown);
  const auto gain_mps = [&](float aside_mps) {
    Way way;
    const Walkers known = One({{9.1f, 4.0f}, {0.0f, aside_mps}, 1.1f});
    way.Cap(&known);
    float most_mps = 0.0f;
    for (float x_m = 0.0f; x_m < 20.0f; x_m += kStep_m) {
      EXPECT_GE(way.At(x_m), anywhere.At(x_m) - 1e-3f) << x_m;
      most_mps = std::max(most_mps, way.At(x_m) - anywhere.At(x_m));
    }
    return most_mps;
  };
  EXPECT_GT(gain_mps(1.4f), 2.0f);
  EXPECT_EQ(gain_mps(-1.4f), 0.0f);
}

// By how much they come later than somebody who was on the way already: (2 - u)^2 / (2 2.5) with u
// = -1.4 + 1.1 towards the path.
// SR-SPD08
TEST(WalkerCaps, WhoWalksAwayIsFartherOffByWhatTurningRoundTakes) {
  Way way;
  const Walkers away = One({{9.075f, 4.0f}, {0.0f, 1.4f}, 1.1f});
  way.Cap(&away);
  Way farther_off;
  const Walkers there = One({{9.075f, 4.0f + 2.3f * 2.3f / 5.0f}, {}, 2.0f});
  farther_off.Cap(&there);
  for (float x_m = 0.0f; x_m < 20.0f; x_m += kStep_m) {
    EXPECT_NEAR(way.At(x_m), farther_off.At(x_m), 0.02f) << x_m;
  }
}

// Cells that people have left behind say nothing, unless there are more people than walkers.
// SR-SPD08
TEST(WalkerCaps, CountCellsOnlyWithMorePeopleThanWalkers) {
  Way way;
  way.AddPersonCell(9.1f, 2.1f);
  way.Cap(nullptr);
  const float by_cell_mps = way.At(8.25f);
  EXPECT_LT(by_cell_mps, 1.0f);
  Walkers walkers;
  way.Cap(&walkers);
  EXPECT_EQ(way.At(8.25f), way.speed.max_speed_mps);
  while (!walkers.full()) {
    EXPECT_EQ(walkers.PushBack({{-40.0f, 40.0f}, {}, 2.0f}), Status::kOk);
  }
  way.Cap(&walkers);
  EXPECT_EQ(way.At(8.25f), by_cell_mps);
}

TEST(WalkerCaps, AnySplitOfTheUnitsGivesTheSame) {
  Way whole;
  Way split;
  Walkers walkers = One({{9.1f, 4.0f}, {0.3f, -1.0f}, 0.9f});
  EXPECT_EQ(walkers.PushBack({{14.1f, -3.0f}, {0.1f, 0.2f}, 2.0f}), Status::kOk);
  whole.Cap(&walkers);
  split.Cap(&walkers, 2.0f, 1);
  for (float x_m = 0.0f; x_m < 39.0f; x_m += kStep_m) EXPECT_EQ(whole.At(x_m), split.At(x_m));
}

// Who walks to and fro over the way, at up to 2 m/s, stops, turns round and sets off again as
// quickly as people do, seen ten times a second with noise and 0.1 s late, and a vehicle that
// begins anywhere and keeps to the caps of each moment.
struct Crossing {
  std::mt19937 random;
  std::uniform_real_distribution<float> unit{0.0f, 1.0f};
  std::normal_distribution<float> noise{0.0f, 0.04f};
  PeopleTracks tracks;
  Way way;
  Vec2 at;
  Vec2 velocity_mps;
  Vec2 wanted_mps;
  Vec2 before;  // 0.1 s ago
  float x_m = 0.0f;
  float v_mps = 0.0f;
  bool touched = false;

  explicit Crossing(uint32_t seed) : random(seed) {
    const float side = unit(random) < 0.5f ? -1.0f : 1.0f;
    const float x = 6.0f + 20.0f * unit(random);
    at = {x, side * (1.5f + 8.0f * unit(random))};
    Turn();
  }
  // On across the way, or it stands for a while.
  void Turn() {
    const float speed_mps = unit(random) < 0.3f ? 0.0f : 0.7f + 1.3f * unit(random);
    const bool goes_on = unit(random) < 0.8f;
    const float to = goes_on == (at.y_m < 0.0f) ? 1.0f : -1.0f;
    const float aside = 0.6f * (unit(random) - 0.5f);
    wanted_mps = {speed_mps * aside, speed_mps * to * std::sqrt(1.0f - aside * aside)};
  }
  void Step(bool minds_people, float s) {
    constexpr float kSetsOff_mps2 = 2.5f;
    const auto towards = [&](float& now, float wanted) {
      now += std::clamp(wanted - now, -kSetsOff_mps2 * s, kSetsOff_mps2 * s);
    };
    towards(velocity_mps.x_m, wanted_mps.x_m);
    towards(velocity_mps.y_m, wanted_mps.y_m);
    at = {at.x_m + s * velocity_mps.x_m, at.y_m + s * velocity_mps.y_m};
    const float cap_mps = minds_people ? way.At(x_m + kStep_m) : way.speed.max_speed_mps;
    const float slower_mps = v_mps - way.speed.max_deceleration_mps2 * s;
    v_mps = std::max(std::max(slower_mps, 0.0f),
                     std::min(v_mps + way.speed.max_acceleration_mps2 * s, cap_mps));
    x_m += s * v_mps;
    const bool is_within = std::fabs(at.x_m - x_m) < 0.5f * way.vehicle.length_m &&
                           std::fabs(at.y_m) < 0.5f * way.vehicle.width_m;
    touched = touched || (is_within && v_mps > way.speed.person_creep_mps + 0.05f);
  }
  void Run(bool minds_people) {
    uint64_t now_ns = 1'000'000'000;
    for (int look = 0; look < 250 && x_m < 34.0f && !touched; ++look, now_ns += 100'000'000) {
      if (unit(random) < 0.03f) Turn();
      const Vec2 seen = {before.x_m + noise(random), before.y_m + noise(random)};
      if (look > 0) tracks.Look(seen, now_ns, now_ns - 100'000'000);
      before = at;
      Walkers walkers;
      tracks.Walk(now_ns, way.speed.person_speed_mps, walkers);
      way.LayFrom(x_m);
      way.Cap(&walkers, v_mps);
      if (look == 10) v_mps = std::min(5.0f * unit(random), way.At(x_m + kStep_m));
      for (int part = 0; part < 5; ++part) {
        if (look >= 10) Step(minds_people, 0.02f);
      }
    }
  }
};

// SR-SPD08
TEST(WalkerCaps, TouchNobodyWhoStopsOrTurns) {
  int touched = 0;
  int touched_otherwise = 0;
  int arrived = 0;
  for (uint32_t seed = 1; seed <= 300; ++seed) {
    Crossing crossing(seed);
    crossing.Run(true);
    touched += crossing.touched ? 1 : 0;
    arrived += crossing.x_m >= 34.0f ? 1 : 0;
    Crossing careless(seed);
    careless.Run(false);
    touched_otherwise += careless.touched ? 1 : 0;
  }
  EXPECT_EQ(touched, 0);
  EXPECT_GT(touched_otherwise, 10) << "the walkers were no threat";
  EXPECT_GT(arrived, 150);
}

}  // namespace
}  // namespace hardpack
