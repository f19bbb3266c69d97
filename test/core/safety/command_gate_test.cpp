// SPDX-License-Identifier: Apache-2.0
#include "core/safety/command_gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
constexpr float kTick_s = 0.01f;

CommandGate MakeGate() {
  CommandGate gate;
  EXPECT_EQ(gate.Configure({.max_speed_radps = 17.5f, .max_acceleration_radps2 = 200.0f}),
            Status::kOk);
  return gate;
}

void ExpectZero(const WheelCommand& wheels) {
  EXPECT_EQ(wheels.left_radps, 0.0f);
  EXPECT_EQ(wheels.right_radps, 0.0f);
}

TEST(CommandGate, LetsAPlannedCommandThroughAsItIs) {
  CommandGate gate = MakeGate();
  float speed = 0.0f;
  for (int tick = 0; tick < 300; ++tick) {
    speed += tick < 150 ? 0.067f : -0.067f;
    const WheelCommand out = gate.Pass({speed - 0.5f, speed + 0.5f}, true, kTick_s);
    ASSERT_EQ(out.left_radps, speed - 0.5f);
    ASSERT_EQ(out.right_radps, speed + 0.5f);
  }
  EXPECT_EQ(gate.counters().above_change, 0u);
  EXPECT_EQ(gate.counters().above_speed, 0u);
}

// SR-CMD02
TEST(CommandGate, ClampsSpeedsAndChanges) {
  CommandGate gate = MakeGate();
  WheelCommand out = gate.Pass({100.0f, -100.0f}, true, kTick_s);
  EXPECT_FLOAT_EQ(out.left_radps, 2.0f);
  EXPECT_FLOAT_EQ(out.right_radps, -2.0f);
  for (int tick = 0; tick < 20; ++tick) out = gate.Pass({100.0f, -100.0f}, true, kTick_s);
  EXPECT_EQ(out.left_radps, 17.5f);
  EXPECT_EQ(out.right_radps, -17.5f);
  out = gate.Pass({-17.5f, -17.5f}, true, kTick_s);
  EXPECT_FLOAT_EQ(out.left_radps, 15.5f);
  EXPECT_EQ(gate.counters().above_speed, 21u);
  EXPECT_GT(gate.counters().above_change, 5u);
}

// SR-CMD02
TEST(CommandGate, SendsZeroAtOnceHoweverFastItWas) {
  CommandGate gate = MakeGate();
  for (int tick = 0; tick < 20; ++tick) {
    static_cast<void>(gate.Pass({17.0f, 17.0f}, true, kTick_s));
  }
  ExpectZero(gate.Pass({0.0f, 0.0f}, true, kTick_s));
  EXPECT_FLOAT_EQ(gate.Pass({17.0f, 17.0f}, true, kTick_s).left_radps, 2.0f);
  // Where nothing may move what was wanted does not count.
  ExpectZero(gate.Pass({17.0f, 17.0f}, false, kTick_s));
  EXPECT_EQ(gate.counters().not_permitted, 1u);
  EXPECT_FLOAT_EQ(gate.Pass({17.0f, 17.0f}, true, kTick_s).left_radps, 2.0f);
}

// SR-CMD03
TEST(CommandGate, MakesOfWhatIsNoNumberZeroAndAFault) {
  for (const WheelCommand& bad :
       {WheelCommand{kNaN, 1.0f}, WheelCommand{1.0f, kNaN}, WheelCommand{kInfinity, 1.0f},
        WheelCommand{1.0f, -kInfinity}, WheelCommand{kNaN, kInfinity}}) {
    for (const bool may_move : {true, false}) {
      CommandGate gate = MakeGate();
      static_cast<void>(gate.Pass({1.0f, 1.0f}, true, kTick_s));
      ExpectZero(gate.Pass(bad, may_move, kTick_s));
      EXPECT_TRUE(gate.has_fault());
      EXPECT_EQ(gate.counters().not_finite, 1u);
      ExpectZero(gate.Pass({1.0f, 1.0f}, true, kTick_s));  // it stays
      gate.ClearFault();
      EXPECT_EQ(gate.Pass({1.0f, 1.0f}, true, kTick_s).left_radps, 1.0f);
    }
  }
}

// SR-CMD01
TEST(CommandGate, PassesNothingWithoutLimitsOrTime) {
  CommandGate never;
  ExpectZero(never.Pass({1.0f, 1.0f}, true, kTick_s));
  for (const float bad : {0.0f, -1.0f, kNaN, kInfinity}) {
    CommandGate gate;
    EXPECT_EQ(gate.Configure({bad, 200.0f}), Status::kParameterOutOfRange);
    ExpectZero(gate.Pass({1.0f, 1.0f}, true, kTick_s));
    EXPECT_EQ(gate.Configure({17.5f, bad}), Status::kParameterOutOfRange);
    ExpectZero(gate.Pass({1.0f, 1.0f}, true, kTick_s));
    CommandGate good = MakeGate();
    ExpectZero(good.Pass({1.0f, 1.0f}, true, bad));
  }
}

// SR-CMD02
TEST(CommandGate, HoldsItsLimitsForAnyCommands) {
  constexpr uint32_t kSeed = 11;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  CommandGate gate = MakeGate();
  WheelCommand before;
  for (int i = 0; i < 100000; ++i) {
    const auto number = [&] {
      const float unit = std::uniform_real_distribution<float>(-1.0f, 1.0f)(random);
      return random() % 50u == 0 ? (unit > 0.0f ? kNaN : 1e38f) : 30.0f * unit;
    };
    const WheelCommand wanted = {number(), number()};
    const bool may_move = random() % 10u != 0;
    const WheelCommand out = gate.Pass(wanted, may_move, kTick_s);
    ASSERT_LE(std::abs(out.left_radps), 17.5f);
    ASSERT_LE(std::abs(out.right_radps), 17.5f);
    const bool is_zero = out.left_radps == 0.0f && out.right_radps == 0.0f;
    ASSERT_TRUE(may_move || is_zero);
    if (!is_zero) {
      ASSERT_LE(std::abs(out.left_radps - before.left_radps), 2.00001f);
      ASSERT_LE(std::abs(out.right_radps - before.right_radps), 2.00001f);
    }
    if (gate.has_fault() && random() % 5u == 0) gate.ClearFault();
    before = out;
  }
}

}  // namespace
}  // namespace hardpack
