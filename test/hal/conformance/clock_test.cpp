// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/time.h>

#include <atomic>
#include <cstdint>

#include "port_linux/monotonic_clock.h"
#include "test/fakes/manual_clock.h"

// What every Clock has to do (hal/clock.h).

namespace hardpack {
namespace {

constexpr uint64_t kMillisecond_ns = 1'000'000;

template <typename ClockType>
class ClockConformance : public ::testing::Test {
 protected:
  ClockType clock_;
};

using Clocks = testing::Types<fakes::ManualClock, MonotonicClock>;
TYPED_TEST_SUITE(ClockConformance, Clocks);

TYPED_TEST(ClockConformance, NeverRunsBackwards) {
  uint64_t last_ns = this->clock_.Now_ns();
  for (int i = 0; i < 10000; ++i) {
    const uint64_t now_ns = this->clock_.Now_ns();
    ASSERT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TYPED_TEST(ClockConformance, SleepsUntilTheTimeAndNotLess) {
  for (int i = 1; i <= 5; ++i) {
    const uint64_t until_ns = this->clock_.Now_ns() + static_cast<uint64_t>(i) * kMillisecond_ns;
    this->clock_.SleepUntil(until_ns);
    EXPECT_GE(this->clock_.Now_ns(), until_ns);
  }
}

TYPED_TEST(ClockConformance, ReturnsAtOnceWhenTheTimeHasPassed) {
  const uint64_t now_ns = this->clock_.Now_ns();
  this->clock_.SleepUntil(0);
  this->clock_.SleepUntil(now_ns);
  this->clock_.SleepUntil(now_ns - 1);
  EXPECT_GE(this->clock_.Now_ns(), now_ns);
}

TEST(ManualClock, PassesWhenItIsToldTo) {
  fakes::ManualClock clock(5);
  clock.Pass(7);
  EXPECT_EQ(clock.Now_ns(), 12u);
  clock.SleepUntil(10);
  EXPECT_EQ(clock.Now_ns(), 12u);
  clock.SleepUntil(20);
  EXPECT_EQ(clock.Now_ns(), 20u);
}

std::atomic<int> signals = 0;

TEST(MonotonicClock, IsNotWokenBySignals) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) { ++signals; };
  ASSERT_EQ(sigaction(SIGALRM, &action, &before), 0);
  const itimerval often{{0, 1000}, {0, 1000}};
  const itimerval never{};
  MonotonicClock clock;
  const uint64_t until_ns = clock.Now_ns() + 50 * kMillisecond_ns;
  setitimer(ITIMER_REAL, &often, nullptr);
  clock.SleepUntil(until_ns);
  setitimer(ITIMER_REAL, &never, nullptr);
  EXPECT_GE(clock.Now_ns(), until_ns);
  EXPECT_GT(signals, 0);
  sigaction(SIGALRM, &before, nullptr);
}

}  // namespace
}  // namespace hardpack
