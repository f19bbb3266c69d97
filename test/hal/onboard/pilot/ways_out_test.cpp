// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/pilot/ways_out.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "core/autonomy/planner.h"

namespace hardpack {
namespace {

constexpr uint64_t kStart_ns = 1'000'000'000;
constexpr uint64_t kTick_ns = 10'000'000;
constexpr uint64_t kHeld_ns = 500'000'000;

// Held from then on until another is preferred; the time at which it is.
uint64_t HeldUntilNext(WaysOut& ways, uint64_t from_ns) {
  uint64_t now_ns = from_ns;
  while (!ways.Held(now_ns) && now_ns < from_ns + 10 * kHeld_ns) now_ns += kTick_ns;
  return now_ns;
}

TEST(WaysOut, PreferNoneAtFirst) {
  const WaysOut ways;
  EXPECT_EQ(ways.preferred(), 0);
}

TEST(WaysOut, AreTriedOneAfterAnotherAndThenNone) {
  WaysOut ways;
  uint64_t now_ns = kStart_ns;
  for (int32_t way = 1; way <= kLeadOuts; ++way) {
    now_ns = HeldUntilNext(ways, now_ns + kTick_ns);
    EXPECT_EQ(ways.preferred(), way);
  }
  HeldUntilNext(ways, now_ns + kTick_ns);
  EXPECT_EQ(ways.preferred(), 0);
}

TEST(WaysOut, EachIsWaitedForHalfASecond) {
  WaysOut ways;
  EXPECT_EQ(HeldUntilNext(ways, kStart_ns), kStart_ns + kHeld_ns + kTick_ns);
  const uint64_t second_ns = kStart_ns + 3 * kHeld_ns;
  EXPECT_EQ(HeldUntilNext(ways, second_ns), second_ns + kHeld_ns + kTick_ns);
}

TEST(WaysOut, TheWaitBeginsAnewWhenItIsNotHeldBetween) {
  WaysOut ways;
  EXPECT_FALSE(ways.Held(kStart_ns));
  EXPECT_FALSE(ways.Held(kStart_ns + kHeld_ns));
  ways.NotHeld();
  EXPECT_FALSE(ways.Held(kStart_ns + kHeld_ns + kTick_ns));
  EXPECT_EQ(ways.preferred(), 0);
}

// Else the vehicle stands for good: what leads to no plan is not held by one either.
TEST(WaysOut, OneThatLeadsToNoPlanIsNotKept) {
  WaysOut ways;
  HeldUntilNext(ways, kStart_ns);
  ASSERT_EQ(ways.preferred(), 1);
  for (int32_t way = 2; way <= kLeadOuts; ++way) {
    ways.FoundNoPlan();
    EXPECT_EQ(ways.preferred(), way);
  }
  ways.FoundNoPlan();
  EXPECT_EQ(ways.preferred(), 0);
}

// The planner has tried them all by itself.
TEST(WaysOut, NoneIsPreferredWhereNoPlanIsFoundWithoutOne) {
  WaysOut ways;
  ways.FoundNoPlan();
  EXPECT_EQ(ways.preferred(), 0);
}

TEST(WaysOut, NoneIsPreferredOnceItMoves) {
  WaysOut ways;
  HeldUntilNext(ways, kStart_ns);
  EXPECT_FALSE(ways.Held(kStart_ns + 2 * kHeld_ns));
  ways.Reset();
  EXPECT_EQ(ways.preferred(), 0);
  EXPECT_FALSE(ways.Held(kStart_ns + 4 * kHeld_ns));
}

}  // namespace
}  // namespace hardpack
