// SPDX-License-Identifier: Apache-2.0
// The counting build counts: compiled as the tests of the stages are there.
#include <csignal>

#include "core/base/loop_bound.h"
#include "gtest/gtest.h"
#include "test/loop_count/counted_beams.h"

namespace hardpack {
namespace {

// Planted: with 6 it runs once more than it says.
int RunFor(int times) {
  int runs = 0;
  HP_LOOP_BOUND(5)
  for (int i = 0; i < times; ++i) ++runs;
  return runs;
}

int RunWhile(int times) {
  int runs = 0;
  HP_LOOP_BOUND(5)
  while (runs < times) ++runs;
  return runs;
}

int RunOver(std::initializer_list<int> numbers) {
  int sum = 0;
  HP_LOOP_BOUND(3)
  for (const int number : numbers) {
    if (number < 0) break;
    if (number == 0) continue;
    sum += number;
  }
  return sum;
}

// An inner loop is entered anew in each iteration of the outer one.
int RunNested(int outer, int inner) {
  int runs = 0;
  HP_LOOP_BOUND(4)
  for (int i = 0; i < outer; ++i) {
    HP_LOOP_BOUND(2)
    for (int j = 0; j < inner; ++j) ++runs;
  }
  return runs;
}

template <typename Action>
void ExpectStop(Action action) {
  EXPECT_EXIT(action(), testing::KilledBySignal(SIGABRT),
              "loop_count_test.cpp:[0-9]+: the loop runs more often than its bound of [0-9]+");
}

TEST(LoopCount, LetsLoopsRunToTheirBounds) {
  EXPECT_EQ(RunFor(5), 5);
  EXPECT_EQ(RunFor(0), 0);
  EXPECT_EQ(RunFor(5), 5);  // an entry has its own count
  EXPECT_EQ(RunWhile(5), 5);
  EXPECT_EQ(RunOver({1, 2, 3}), 6);
  EXPECT_EQ(RunNested(4, 2), 8);
}

TEST(LoopCount, LeavesBreakAndContinueToTheLoop) {
  EXPECT_EQ(RunOver({1, 0, 2}), 3);
  EXPECT_EQ(RunOver({1, -1, 2, 3, 4, 5}), 1);
}

TEST(LoopCountDeathTest, StopsALoopThatRunsOnceMoreThanItSays) {
  ExpectStop([] { RunFor(6); });
  ExpectStop([] { RunWhile(6); });
  ExpectStop([] { RunOver({1, 2, 3, 4}); });
  ExpectStop([] { RunNested(5, 1); });
  ExpectStop([] { RunNested(1, 3); });
}

// The inner loops share the runs: as many as the numbers say.
int RunShared(std::initializer_list<int> numbers, int second) {
  int runs = 0;
  HP_LOOP_BOUND_INNER(3, 4)
  for (const int number : numbers) {
    HP_LOOP_BOUND(4)
    for (int i = 0; i < number; ++i) {
      HP_LOOP_BOUND(2)  // further inside: in each entry
      for (int j = 0; j < 2; ++j) ++runs;
    }
    HP_LOOP_BOUND(4)
    for (int i = 0; i < second; ++i) ++runs;
  }
  return runs;
}

TEST(LoopCount, LetsInnerLoopsRunToTheirBoundInAll) {
  EXPECT_EQ(RunShared({1, 0, 3}, 1), 11);
  EXPECT_EQ(RunShared({4}, 4), 12);  // a bound for each of them, and anew in each entry
  EXPECT_EQ(RunShared({0, 4, 0}, 0), 8);
}

TEST(LoopCountDeathTest, StopsInnerLoopsThatRunMoreOftenInAll) {
  EXPECT_EXIT(RunShared({2, 3}, 0), testing::KilledBySignal(SIGABRT),
              "the loop runs more often than 4 in all of that of .*loop_count_test.cpp");
  EXPECT_EXIT(RunShared({0, 0, 0}, 2), testing::KilledBySignal(SIGABRT),
              "more often than 4 in all");
}

// Of a lidar with so many beams, and one more than it has.
int RunOverBeams(int beams) {
  int runs = 0;
  HP_LOOP_BOUND_BEAMS(kMaxBeams + 1)
  for (int beam = 0; beam <= beams; ++beam) ++runs;
  return runs;
}

int RunOverBeamsOf(int groups, int beams) {
  int runs = 0;
  HP_LOOP_BOUND_INNER_BEAMS(kMaxBeams, kMaxBeams)
  for (int group = 0; group < groups; ++group) {
    HP_LOOP_BOUND(kMaxBeams)
    for (int beam = 0; beam < beams; ++beam) ++runs;
  }
  return runs;
}

TEST(LoopCount, LetsLoopsOverBeamsRunAsOftenAsTheLidarHasThem) {
  EXPECT_EQ(RunOverBeams(kMaxBeams), kMaxBeams + 1);
  EXPECT_EQ(RunOverBeamsOf(1, kMaxBeams), kMaxBeams);
  const CountedBeams counted(16);
  EXPECT_EQ(RunOverBeams(16), 17);
  EXPECT_EQ(RunOverBeamsOf(2, 8), 16);
}

TEST(LoopCountDeathTest, StopsALoopOverMoreBeamsThanTheLidarHas) {
  ExpectStop([] { RunOverBeams(kMaxBeams + 1); });
  const CountedBeams counted(16);
  ExpectStop([] { RunOverBeams(17); });
  ExpectStop([] { RunOverBeamsOf(17, 0); });
  EXPECT_EXIT(RunOverBeamsOf(2, 9), testing::KilledBySignal(SIGABRT), "more often than 16 in all");
}

TEST(LoopCount, LeavesLoopsOfTestsUncounted) {
  int runs = 0;
  for (int i = 0; i < 100; ++i) ++runs;
  while (runs < 200) ++runs;
  do {
    ++runs;
  } while (runs < 300);
  EXPECT_EQ(runs, 300);
}

constexpr int CountAtCompileTime(int times) {
  int runs = 0;
  HP_LOOP_BOUND(5)
  for (int i = 0; i < times; ++i) ++runs;
  return runs;
}
static_assert(CountAtCompileTime(5) == 5);

}  // namespace
}  // namespace hardpack
