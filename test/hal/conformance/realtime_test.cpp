// SPDX-License-Identifier: Apache-2.0
#include "port_linux/realtime.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <string>
#include <thread>

namespace hardpack {
namespace {

// In a thread of its own, which takes what it was granted with it.
template <typename Body>
void InAThread(const Body& body) {
  std::thread(body).join();
}

TEST(BecomeRealtime, AsksForNothingThatIsNotWanted) {
  InAThread([] {
    const RealtimeOutcome outcome = BecomeRealtime({.priority = 0, .lock_memory = false});
    EXPECT_FALSE(outcome.scheduled || outcome.locked || outcome.pinned);
    EXPECT_TRUE(outcome.refused.empty());
    EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
  });
}

TEST(BecomeRealtime, IsWhatItSaysOrSaysWhyNot) {
  InAThread([] {
    const RealtimeOutcome outcome = BecomeRealtime({.priority = 1, .lock_memory = false, .cpu = 0});
    const int policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
    EXPECT_EQ(outcome.scheduled, policy == SCHED_FIFO);
    cpu_set_t set;
    ASSERT_EQ(sched_getaffinity(0, sizeof(set), &set), 0);
    EXPECT_EQ(outcome.pinned, CPU_COUNT(&set) == 1 && CPU_ISSET(0, &set));
    EXPECT_EQ(outcome.refused.size(), (outcome.scheduled ? 0u : 1u) + (outcome.pinned ? 0u : 1u));
  });
}

TEST(BecomeRealtime, DoesNotPassTheSchedulingOn) {
  InAThread([] {
    if (!BecomeRealtime({.priority = 1, .lock_memory = false}).scheduled) {
      GTEST_SKIP() << "real-time scheduling is not permitted here";
    }
    InAThread([] { EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER); });
  });
}

TEST(BecomeRealtime, TriesTheRestWhenOneThingIsRefused) {
  InAThread([] {
    const RealtimeOutcome outcome =
        BecomeRealtime({.priority = 1000, .lock_memory = false, .cpu = 100000});
    ASSERT_EQ(outcome.refused.size(), 2u);
    EXPECT_EQ(outcome.refused[0],
              "processor 100000: Invalid argument (does it exist, and may it be used?)");
    EXPECT_EQ(outcome.refused[1],
              "real-time scheduling, priority 1000: Invalid argument (needs CAP_SYS_NICE or "
              "LimitRTPRIO)");
  });
}

}  // namespace
}  // namespace hardpack
