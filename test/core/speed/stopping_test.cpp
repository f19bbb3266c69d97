// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/speed/speed.h"
#include "test/not_finite.h"

// Stopping distances and the caps that follow from them.

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;

// SR-SPD01
TEST(StoppingDistance, IsTheWayOfASimulatedLaggedRamp) {
  const SpeedParams params;
  for (const double start : {0.5, 2.0, 5.0}) {
    // Reaction and dead time at full speed, then v' = (command - v) / tau behind a ramp to zero.
    const double delay_s = double{params.reaction_time_s} + double{params.stopping_dead_time_s};
    double way_m = start * delay_s;
    double command = start;
    double v = start;
    const double dt = 1e-4;
    for (int i = 0; i < 200000; ++i) {
      way_m += v * dt;
      v += (command - v) / double{params.stopping_lag_s} * dt;
      command = std::max(0.0, command - double{params.max_deceleration_mps2} * dt);
    }
    EXPECT_NEAR(StoppingDistance(params, static_cast<float>(start)), way_m, 2e-3 * way_m);
  }
}

// SR-SPD01
TEST(ReactionSpeedCap, IsTheLargestSpeedThatStopsAndNeverAboveIt) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (int i = 0; i < 200000; ++i) {
    SpeedParams params;
    params.max_deceleration_mps2 = 0.2f + 8.0f * unit(random);
    params.reaction_time_s = unit(random);
    params.stopping_dead_time_s = 0.5f * unit(random);
    params.stopping_lag_s = i % 10 == 0 ? 0.0f : unit(random);
    const float free_m = std::pow(10.0f, -6.0f + 8.0f * unit(random));
    const float cap = ReactionSpeedCap(params, free_m);
    ASSERT_LE(StoppingDistance(params, cap), free_m) << "free " << free_m << " case " << i;
    ASSERT_LE(cap, params.max_speed_mps);
    if (cap < params.max_speed_mps) {
      ASSERT_GT(StoppingDistance(params, cap * 1.00001f), free_m) << "free " << free_m;
    }
  }
}

TEST(ReactionSpeedCap, NeverFallsAsTheFreeWayGrows) {
  const SpeedParams params;
  float before = 0.0f;
  for (int i = 0; i < 200000; ++i) {
    const float cap = ReactionSpeedCap(params, 1e-4f * static_cast<float>(i));
    ASSERT_GE(cap, before * 0.999999f) << i;
    before = cap;
  }
  EXPECT_EQ(before, params.max_speed_mps);
}

TEST(ReactionSpeedCap, IsZeroWithoutAFreeWay) {
  const SpeedParams params;
  for (const float free_m : {0.0f, -0.0f, -1.0f, -kInfinity, kNaN, 1e-40f}) {
    EXPECT_EQ(ReactionSpeedCap(params, free_m), 0.0f) << free_m;
  }
  // From a micrometre on there is one.
  EXPECT_EQ(ReactionSpeedCap(params, std::nextafter(1e-6f, 0.0f)), 0.0f);
  EXPECT_GT(ReactionSpeedCap(params, 1e-6f), 0.0f);
  EXPECT_EQ(ReactionSpeedCap(params, kInfinity), params.max_speed_mps);
  EXPECT_EQ(ReactionSpeedCap(params, std::numeric_limits<float>::max()), params.max_speed_mps);
}

//      person
//        |  lateral
//   [>]=====================  corridor
TEST(PersonSpeedCap, SlowsForAPersonWhoCanReachTheWay) {
  const SpeedParams params;
  const VehicleParams vehicle;
  const float cap = PersonSpeedCap(params, vehicle, 6.0f, 1.0f, 3.0f);
  EXPECT_LT(cap, params.max_speed_mps);
  EXPECT_GT(cap, 0.0f);
  EXPECT_LE(StoppingDistance(params, cap), 6.0f - 0.5f * vehicle.length_m - params.person_margin_m);
}

TEST(PersonSpeedCap, IgnoresAPersonTooFarAsideOrAlreadyPassed) {
  const SpeedParams params;
  const VehicleParams vehicle;
  EXPECT_EQ(PersonSpeedCap(params, vehicle, 6.0f, 30.0f, 3.0f), params.max_speed_mps);
  EXPECT_EQ(PersonSpeedCap(params, vehicle, -2.0f, 0.5f, 3.0f), params.max_speed_mps);
  EXPECT_EQ(PersonSpeedCap(params, vehicle, 40.0f, 0.0f, 3.0f), params.max_speed_mps);
}

TEST(PersonSpeedCap, StandsForAPersonInTheWayHoweverClose) {
  const SpeedParams params;
  const VehicleParams vehicle;
  for (const float along_m : {-0.7f, 0.0f, 0.5f, 1.2f}) {
    EXPECT_EQ(PersonSpeedCap(params, vehicle, along_m, 0.0f, 3.0f), 0.0f) << along_m;
  }
}

// Of 4000 walkers who cross the way of a vehicle that keeps to the cap of each moment, brakes at
// the limit and sees the walker a reaction time late, the number that is touched: in the way and
// beside the vehicle while it moves. `told_m` turns the walker's distance into what the cap is
// told; start_mps(0 .. 1) is the speed at which it begins.
template <typename Told, typename Start>
int CountTouchedWalkers(Told told_m, Start start_mps) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const SpeedParams params;
  const VehicleParams vehicle;
  const double half_length_m = 0.5 * double{vehicle.length_m};
  const double dt = 0.02;
  int touched_walkers = 0;
  for (int scene = 0; scene < 4000; ++scene) {
    const double walker_mps = 0.7 + 1.3 * unit(random);
    const double walker_at_m = 5.0 + 25.0 * unit(random);
    double lateral_m = 1.0 + 20.0 * unit(random);
    double position_m = 0.0;
    double v = 0.0;
    const auto cap = [&] {
      const double seen_m = lateral_m + walker_mps * double{params.reaction_time_s};
      return double{PersonSpeedCap(params, vehicle, static_cast<float>(walker_at_m - position_m),
                                   static_cast<float>(told_m(seen_m)), static_cast<float>(v))};
    };
    v = std::min(start_mps(unit(random)), cap());
    bool touched = false;
    while (lateral_m > -double{vehicle.width_m}) {
      v = std::max(std::max(0.0, v - double{params.max_deceleration_mps2} * dt),
                   std::min(v + double{params.max_acceleration_mps2} * dt, cap()));
      position_m += v * dt;
      lateral_m -= walker_mps * dt;
      const bool beside = std::abs(walker_at_m - position_m) < half_length_m;
      touched = touched || (lateral_m <= 0.0 && beside && v > 0.05);
    }
    touched_walkers += touched ? 1 : 0;
  }
  return touched_walkers;
}

// The same of walkers who come straight for where the vehicle is, and keep to that line: the number
// that is touched by a vehicle faster than at which it may creep.
int CountMetWalkers(double told_speed_mps) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  SpeedParams params;
  const VehicleParams vehicle;
  const double half_length_m = 0.5 * double{vehicle.length_m};
  const double half_width_m = 0.5 * double{vehicle.width_m};
  const double brakes_mps2 = double{params.max_deceleration_mps2};
  const double reaction_s = double{params.reaction_time_s};
  params.person_speed_mps = static_cast<float>(told_speed_mps);
  const double dt = 0.02;
  int touched_walkers = 0;
  for (int scene = 0; scene < 4000; ++scene) {
    const double walker_mps = 0.7 + 1.3 * unit(random);
    const double bearing_rad = 0.5 * double{kPi} * unit(random);
    const double ahead_m = std::cos(bearing_rad);
    const double aside_m = std::sin(bearing_rad);
    double along_m = 12.0 * ahead_m;  // of the walker before the vehicle's middle
    double lateral_m = 12.0 * aside_m;
    double v = 0.0;
    const auto cap = [&] {
      const double seen_along_m = along_m + (v + walker_mps * ahead_m) * reaction_s;
      const double seen_lateral_m = lateral_m + walker_mps * aside_m * reaction_s - half_width_m;
      return double{PersonSpeedCap(params, vehicle, static_cast<float>(seen_along_m),
                                   static_cast<float>(seen_lateral_m), static_cast<float>(v))};
    };
    v = std::min(2.0 * unit(random), cap());
    bool touched = false;
    while (lateral_m > -2.0 * half_width_m && along_m > -2.0 * half_length_m) {
      v = std::max(std::max(0.0, v - brakes_mps2 * dt),
                   std::min(v + double{params.max_acceleration_mps2} * dt, cap()));
      along_m -= (v + walker_mps * ahead_m) * dt;
      lateral_m -= walker_mps * aside_m * dt;
      const bool meets = std::abs(along_m) < half_length_m && std::abs(lateral_m) < half_width_m;
      if (meets && v > double{params.person_creep_mps} + 0.05) touched = true;
      if (meets || (v <= 0.0 && walker_mps * dt <= 0.0)) break;
    }
    touched_walkers += touched ? 1 : 0;
  }
  return touched_walkers;
}

// SR-SPD03
TEST(PersonSpeedCap, MeetsNobodyWhoWalksTowardsTheVehicle) {
  EXPECT_EQ(CountMetWalkers(2.0), 0);
  EXPECT_GT(CountMetWalkers(0.0), 40) << "the walkers were no threat";
}

// SR-SPD03
TEST(PersonSpeedCap, TouchesNoWalkerWhereBrakingForTheCorridorAloneTouchesMany) {
  const auto told = [](double lateral_m) { return lateral_m; };
  const auto corridor_alone = [](double lateral_m) { return lateral_m > 0.5 ? 1e6 : lateral_m; };
  const auto fast = [](double share) { return 2.0 + 3.0 * share; };
  const auto slow = [](double share) { return 2.0 * share; };
  EXPECT_EQ(CountTouchedWalkers(told, fast), 0);
  EXPECT_EQ(CountTouchedWalkers(told, slow), 0);
  EXPECT_GT(CountTouchedWalkers(corridor_alone, fast), 40);
  EXPECT_GT(CountTouchedWalkers(corridor_alone, slow), 40);
}

//        person: far enough aside for a vehicle that drives at min_speed_mps, not for one that has
//   [>]====+====    yet to get there
TEST(PersonSpeedCap, PassesBeforeAPersonOnlyAsFastAsItDrives) {
  const SpeedParams params;
  const VehicleParams vehicle;
  const float way_m = 1.0f + 0.5f * vehicle.length_m;
  const float at_speed_m =
      params.person_margin_m +
      params.person_speed_mps * PassingTime(params, way_m, params.min_speed_mps);
  EXPECT_EQ(PersonSpeedCap(params, vehicle, 1.0f, at_speed_m + 0.01f, 2.0f), params.max_speed_mps);
  // Else it stands before they can be in the corridor.
  const float aside_m = at_speed_m - params.person_margin_m;
  for (const bool is_slow : {false, true}) {
    const float room_m = is_slow ? 0.01f : -0.01f;
    const float cap_mps =
        PersonSpeedCap(params, vehicle, 1.0f, at_speed_m + room_m, is_slow ? 1.9f : 5.0f);
    EXPECT_NEAR(params.person_speed_mps * StoppingTime(params, cap_mps), aside_m + room_m, 1.0e-4f);
  }
}

// One who leaves room to creep by leaves it to a vehicle that is as slow already.
TEST(PersonSpeedCap, CreepsOnlyAsFarAsThePersonCannotComeWhileItBrakes) {
  const SpeedParams params;
  const VehicleParams vehicle;
  for (const float speed_mps : {0.0f, 0.2f, 1.0f}) {
    const float brakes_s =
        std::max(speed_mps, params.person_creep_mps) / params.max_deceleration_mps2;
    const float room_m =
        params.person_margin_m + params.person_speed_mps * (params.reaction_time_s + brakes_s);
    EXPECT_EQ(PersonSpeedCap(params, vehicle, 0.5f, room_m + 0.01f, speed_mps),
              params.person_creep_mps);
    EXPECT_EQ(PersonSpeedCap(params, vehicle, 0.5f, room_m - 0.01f, speed_mps), 0.0f);
  }
}

// Against a vehicle that follows a ramp with dead time and lag, in small steps.
TEST(PassingTime, IsNotLessThanWhatTheDrivesTake) {
  const SpeedParams params;
  for (const double start_mps : {0.0, 0.5, 1.5, 2.0, 4.0}) {
    for (const double way_m : {0.3, 1.0, 3.0, 10.0}) {
      const double dt = 1.0e-3;
      double told_mps = start_mps;
      double v = start_mps;
      double driven_m = 0.0;
      double t = 0.0;
      for (; driven_m < way_m; t += dt) {
        driven_m += v * dt;
        if (t < double{params.stopping_dead_time_s}) continue;
        told_mps = std::min(std::max(start_mps, double{params.min_speed_mps}),
                            told_mps + double{params.max_acceleration_mps2} * dt);
        v += (told_mps - v) * dt / double{params.stopping_lag_s};
      }
      const double most_s =
          double{PassingTime(params, static_cast<float>(way_m), static_cast<float>(start_mps))} -
          double{params.reaction_time_s};
      EXPECT_LE(t, most_s + 0.01) << start_mps << " m/s, " << way_m << " m";
      if (way_m >= 10.0 && start_mps <= 2.0) {
        EXPECT_GE(t, most_s - 0.02) << start_mps;
      }
    }
  }
}

}  // namespace
}  // namespace hardpack
