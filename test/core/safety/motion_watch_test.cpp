// SPDX-License-Identifier: Apache-2.0
#include "core/safety/motion_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kNaN;
constexpr float kWatchTick_s = 0.01f;

struct Watched {
  MotionWatch watch;
  MotionSample sample;
  Watched() {
    EXPECT_EQ(watch.Configure(SafetyParams{}), Status::kOk);
    sample.has_wheels = true;
    sample.has_yaw_rate = true;
  }
  void Command(float speed_mps, float yaw_rate_radps) {
    sample.commanded_mps = speed_mps;
    sample.commanded_radps = yaw_rate_radps;
  }
  void Measure(float speed_mps, float yaw_rate_radps) {
    sample.wheels_mps = speed_mps;
    sample.wheels_radps = yaw_rate_radps;
    sample.yaw_rate_radps = yaw_rate_radps;
  }
  // Seconds until there is a fault; -1: none within the limit.
  double Until(double limit_s) {
    for (double t = 0.0; t < limit_s; t += double{kWatchTick_s}) {
      if (watch.Judge(sample, kWatchTick_s) != MotionFault::kNone) return t;
    }
    return -1.0;
  }
};

// SR-CMD04
TEST(MotionWatch, FindsAVehicleThatMovesWhenItShouldStand) {
  for (const float speed_mps : {1.3f, -1.3f, 5.0f}) {
    Watched vehicle;
    vehicle.Measure(speed_mps, 0.0f);
    EXPECT_NEAR(vehicle.Until(3.0), 1.0, 0.05);
    EXPECT_EQ(vehicle.watch.fault(), MotionFault::kRunaway);
  }
  Watched faster;
  faster.Command(2.0f, 0.0f);
  faster.Measure(3.5f, 0.0f);
  EXPECT_NEAR(faster.Until(3.0), 1.0, 0.05);
  EXPECT_EQ(faster.watch.fault(), MotionFault::kRunaway);
}

// SR-CMD04
TEST(MotionWatch, FindsAVehicleThatTurnsAgainstItsCommand) {
  Watched vehicle;
  vehicle.Command(0.0f, 0.8f);
  vehicle.Measure(0.0f, -0.8f);
  EXPECT_NEAR(vehicle.Until(3.0), 1.0, 0.05);
  EXPECT_EQ(vehicle.watch.fault(), MotionFault::kWrongTurn);
  Watched straight;
  straight.Command(2.0f, 0.0f);
  straight.Measure(2.0f, 0.9f);
  EXPECT_NEAR(straight.Until(3.0), 1.0, 0.05);
  EXPECT_EQ(straight.watch.fault(), MotionFault::kWrongTurn);
}

// SR-CMD04
TEST(MotionWatch, FindsAVehicleThatDoesNotMove) {
  Watched vehicle;
  vehicle.Command(1.0f, 0.0f);
  EXPECT_NEAR(vehicle.Until(10.0), 5.0, 0.05);
  EXPECT_EQ(vehicle.watch.fault(), MotionFault::kStuck);
  Watched turning;
  turning.Command(0.0f, -0.5f);
  EXPECT_NEAR(turning.Until(10.0), 5.0, 0.05);
  EXPECT_EQ(turning.watch.fault(), MotionFault::kStuck);
  Watched creeping;  // slowly on purpose
  creeping.Command(0.2f, 0.0f);
  EXPECT_EQ(creeping.Until(20.0), -1.0);
}

// Dead time of 0.3 s, a lag of 1 s, wheels that slip and slopes: none of it is against a command.
// SR-CMD04
TEST(MotionWatch, LetsSlowDrivesBe) {
  Watched vehicle;
  std::deque<float> sent(30, 0.0f);
  float speed = 0.0f;
  float yaw = 0.0f;
  for (int tick = 0; tick < 6000; ++tick) {
    const float t = kWatchTick_s * static_cast<float>(tick);
    const int phase = tick / 1000;
    const float since_s = t - 10.0f * static_cast<float>(phase);
    const float told = phase % 2 == 0 ? std::min(5.0f, 2.0f * since_s) : 0.0f;
    const float told_yaw = 1.5f * std::sin(1.5f * t);
    sent.push_back(told);
    speed += (sent.front() - speed) / 1.0f * kWatchTick_s;
    sent.pop_front();
    yaw += (told_yaw - yaw) / 0.5f * kWatchTick_s;
    vehicle.Command(told, told_yaw);
    vehicle.Measure(1.08f * speed - 0.1f, 0.7f * yaw + 0.15f * std::sin(20.0f * t));
    ASSERT_EQ(vehicle.watch.Judge(vehicle.sample, kWatchTick_s), MotionFault::kNone) << t;
  }
}

TEST(MotionWatch, WantsItWithoutABreakAndKeepsTheFirst) {
  Watched vehicle;
  for (int i = 0; i < 20; ++i) {
    vehicle.Measure(2.0f, 0.0f);
    ASSERT_EQ(vehicle.Until(0.9), -1.0);
    vehicle.Measure(0.0f, 0.0f);
    ASSERT_EQ(vehicle.Until(0.02), -1.0);
  }
  vehicle.Measure(2.0f, 0.0f);
  EXPECT_GE(vehicle.Until(2.0), 0.0);
  vehicle.Measure(0.0f, 0.0f);
  EXPECT_EQ(vehicle.watch.Judge(vehicle.sample, kWatchTick_s), MotionFault::kRunaway);
  vehicle.watch.Reset();
  EXPECT_EQ(vehicle.Until(10.0), -1.0);
}

TEST(MotionWatch, JudgesNothingThatIsNotMeasured) {
  Watched vehicle;
  vehicle.sample.has_wheels = false;
  vehicle.sample.has_yaw_rate = false;
  vehicle.Command(2.0f, 0.0f);
  vehicle.Measure(-5.0f, 3.0f);
  EXPECT_EQ(vehicle.Until(20.0), -1.0);
}

// SR-CMD04
TEST(MotionWatch, IsNotFooledByWhatIsNoNumber) {
  Watched vehicle;
  vehicle.Measure(kNaN, 0.0f);
  EXPECT_NEAR(vehicle.Until(3.0), 1.0, 0.05);
  EXPECT_EQ(vehicle.watch.fault(), MotionFault::kRunaway);
  Watched yaw;
  yaw.Measure(0.0f, kNaN);
  EXPECT_GE(yaw.Until(3.0), 0.0);
  Watched commanded;  // and it is judged on as if told to stand
  commanded.Command(kNaN, kNaN);
  EXPECT_EQ(commanded.Until(3.0), -1.0);
  commanded.Measure(2.0f, 0.0f);
  EXPECT_GE(commanded.Until(3.0), 0.0);
  Watched time;
  time.Measure(5.0f, 0.0f);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(time.watch.Judge(time.sample, kNaN), MotionFault::kNone);
    ASSERT_EQ(time.watch.Judge(time.sample, -1.0f), MotionFault::kNone);
  }
  EXPECT_GE(time.Until(3.0), 0.0);
  SafetyParams params;
  params.motion_time_s = kNaN;
  EXPECT_EQ(MotionWatch{}.Configure(params), Status::kParameterOutOfRange);
}

//  wheels (( ))  turn, the ground under them does not go by
//
// SR-STP05: wheels that spin in place, or stand while the vehicle slides, within 1 s.
TEST(MotionWatch, FindsWheelsThatDoNotHoldTheGround) {
  struct Slip {
    float wheels_mps;
    float ground_mps;
  };
  for (const Slip slip :
       {Slip{2.0f, 0.0f}, Slip{-2.0f, 0.1f}, Slip{5.0f, 2.0f}, Slip{0.0f, 2.0f}}) {
    SCOPED_TRACE(slip.wheels_mps);
    Watched vehicle;
    vehicle.Command(slip.wheels_mps, 0.0f);
    vehicle.Measure(slip.wheels_mps, 0.0f);
    vehicle.sample.has_ground = true;
    vehicle.sample.ground_mps = slip.ground_mps;
    EXPECT_NEAR(vehicle.Until(3.0), 1.0, 0.05);
    EXPECT_EQ(vehicle.watch.fault(), MotionFault::kSpin);
  }
}

// SR-STP05: and in a turn on the spot, where the speed over ground says nothing.
TEST(MotionWatch, FindsWheelsThatSpinInATurnOnTheSpot) {
  Watched vehicle;
  vehicle.Command(0.0f, 0.8f);
  vehicle.Measure(0.0f, 0.8f);
  vehicle.sample.yaw_rate_radps = 0.02f;
  EXPECT_NEAR(vehicle.Until(10.0), 5.0, 0.05);
  EXPECT_EQ(vehicle.watch.fault(), MotionFault::kSpin);
}

// SR-STP05
TEST(MotionWatch, TakesOrdinarySlipForNoSpin) {
  struct Slip {
    float wheels_mps;
    float ground_mps;
  };
  for (const Slip slip : {Slip{5.0f, 4.0f}, Slip{1.2f, 0.0f}, Slip{0.2f, 0.9f}, Slip{3.0f, 3.9f}}) {
    SCOPED_TRACE(slip.wheels_mps);
    Watched vehicle;
    vehicle.Command(slip.wheels_mps, 0.0f);
    vehicle.Measure(slip.wheels_mps, 0.0f);
    vehicle.sample.has_ground = true;
    vehicle.sample.ground_mps = slip.ground_mps;
    EXPECT_EQ(vehicle.Until(20.0), -1.0);
  }
  Watched blind;  // no speed over ground: nothing to tell it by
  blind.Command(3.0f, 0.0f);
  blind.Measure(3.0f, 0.0f);
  EXPECT_EQ(blind.Until(20.0), -1.0);
}

}  // namespace
}  // namespace hardpack
