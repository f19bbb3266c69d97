// SPDX-License-Identifier: Apache-2.0
#include "core/safety/reaction_meter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

namespace hardpack {
namespace {

constexpr uint64_t kMillisecond_ns = 1'000'000;
constexpr uint64_t kStart_ns = 5'000'000'000;

struct Meter {
  std::unique_ptr<ReactionMeter> meter = std::make_unique<ReactionMeter>();
  ReactionMeter* operator->() { return meter.get(); }
};

//  0 ms  filed   40 begun   (60 filed)   90 judged   100 commanded
TEST(ReactionMeter, MeasuresFromTheStampToTheFirstCommandWhoseMapHasTheColumn) {
  Meter meter;
  meter->Filed(kStart_ns);
  meter->RoundBegun();
  meter->Filed(kStart_ns + 60 * kMillisecond_ns);
  meter->Commanded(kStart_ns + 80 * kMillisecond_ns, 5.0f);
  EXPECT_EQ(meter->columns(), 0u);  // no path of that map yet
  meter->RoundJudged();
  meter->Commanded(kStart_ns + 100 * kMillisecond_ns, 5.0f);
  EXPECT_EQ(meter->columns(), 1u);
  EXPECT_EQ(meter->waiting(), 1);
  EXPECT_NEAR(meter->Time_s(0.5f), 0.1f, 0.006f);
  EXPECT_NEAR(meter->Radius_m(0.5f), 0.5f, 0.021f);
  meter->RoundBegun();
  meter->RoundJudged();
  meter->Commanded(kStart_ns + 260 * kMillisecond_ns, 5.0f);
  EXPECT_EQ(meter->columns(), 2u);
  EXPECT_NEAR(meter->Time_s(1.0f), 0.2f, 0.006f);
  EXPECT_NEAR(meter->Radius_m(1.0f), 1.0f, 0.021f);
}

TEST(ReactionMeter, ARoundWithoutAPathMakesItsColumnsWait) {
  Meter meter;
  meter->Filed(kStart_ns);
  meter->RoundBegun();
  meter->Commanded(kStart_ns + 100 * kMillisecond_ns, 1.0f);
  meter->RoundBegun();
  meter->RoundJudged();
  meter->Commanded(kStart_ns + 400 * kMillisecond_ns, 1.0f);
  EXPECT_EQ(meter->columns(), 1u);
  EXPECT_NEAR(meter->Time_s(0.5f), 0.4f, 0.006f);
}

TEST(ReactionMeter, WhatNeverGetsInIsInfinite) {
  Meter meter;
  for (int i = 0; i < 98; ++i) meter->Filed(kStart_ns);
  meter->RoundBegun();
  meter->RoundJudged();
  meter->Commanded(kStart_ns + 10 * kMillisecond_ns, 2.0f);
  meter->Lost();
  meter->Lost();
  EXPECT_EQ(meter->lost(), 2u);
  EXPECT_LT(meter->Time_s(0.5f), 0.02f);
  EXPECT_EQ(meter->Time_s(0.99f), ReactionMeter::kBeyond);
  EXPECT_EQ(meter->Radius_m(0.99f), ReactionMeter::kBeyond);
}

TEST(ReactionMeter, HasRoomForSoManyAndCountsTheRestAsLost) {
  Meter meter;
  for (int i = 0; i < ReactionMeter::kCapacity + 10; ++i) {
    if (i == 5) meter->RoundBegun();
    meter->Filed(kStart_ns);
  }
  EXPECT_EQ(meter->lost(), 10u);
  EXPECT_EQ(meter->waiting(), ReactionMeter::kCapacity);
  meter->RoundJudged();  // of columns that are gone
  meter->Commanded(kStart_ns + kMillisecond_ns, 1.0f);
  EXPECT_EQ(meter->columns(), 10u);
  meter->RoundBegun();
  meter->RoundJudged();
  meter->Commanded(kStart_ns + kMillisecond_ns, 1.0f);
  EXPECT_EQ(meter->columns(), 10u + ReactionMeter::kCapacity);
  EXPECT_EQ(meter->waiting(), 0);
}

TEST(ReactionMeter, APauseCountsNothing) {
  Meter meter;
  EXPECT_EQ(meter->Time_s(0.5f), 0.0f);
  EXPECT_EQ(meter->Radius_m(0.99f), 0.0f);
  meter->Filed(kStart_ns);
  meter->RoundBegun();
  meter->Pause();
  meter->RoundJudged();
  meter->Commanded(kStart_ns + kMillisecond_ns, 1.0f);
  EXPECT_EQ(meter->columns(), 0u);
  meter->Filed(kStart_ns);
  meter->Reset();
  EXPECT_EQ(meter->waiting(), 0);
}

TEST(ReactionMeter, TakesStampsOfTheFutureAndSpeedsThatAreNone) {
  Meter meter;
  meter->Filed(kStart_ns + 1000 * kMillisecond_ns);
  meter->Filed(0);
  meter->RoundBegun();
  meter->RoundJudged();
  meter->Commanded(kStart_ns, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(meter->columns(), 2u);
  EXPECT_NEAR(meter->Time_s(0.5f), 0.005f, 1e-6f);
  EXPECT_EQ(meter->Time_s(1.0f), ReactionMeter::kBeyond);
  for (const float share : {-1.0f, 0.0f, 2.0f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_GT(meter->Time_s(share), 0.0f);
  }
}

// Against sorted times.
TEST(ReactionMeter, TellsThePercentilesOfWhatItWasGiven) {
  Meter meter;
  std::mt19937 random(3);
  uint64_t now_ns = kStart_ns;
  std::vector<double> times_s;
  for (int i = 0; i < 20000; ++i) {
    const uint64_t age_ns = random() % (500 * kMillisecond_ns);
    now_ns += 10 * kMillisecond_ns;
    meter->Filed(now_ns - age_ns);
    meter->RoundBegun();
    meter->RoundJudged();
    meter->Commanded(now_ns, 3.0f);
    times_s.push_back(static_cast<double>(age_ns) * 1e-9);
  }
  std::sort(times_s.begin(), times_s.end());
  for (const double share : {0.01, 0.5, 0.9, 0.99}) {
    const double truth_s = times_s[static_cast<size_t>(share * 20000.0)];
    EXPECT_NEAR(meter->Time_s(static_cast<float>(share)), truth_s, 0.006);
    EXPECT_NEAR(meter->Radius_m(static_cast<float>(share)), 3.0 * truth_s, 0.03);
  }
}

}  // namespace
}  // namespace hardpack
