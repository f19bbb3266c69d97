// SPDX-License-Identifier: Apache-2.0
#include "tools/allocation_counter/allocation_counter.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "tools/bench/bench_timing.h"

namespace hardpack::command {
namespace {

// Kept where the compiler cannot see that nobody reads it.
std::unique_ptr<int> kept;

class AllocationCounter : public testing::Test {
 protected:
  void SetUp() override {
    if (!AllocationsAreCounted()) GTEST_SKIP() << "a sanitizer has replaced the allocator itself";
  }
};

TEST_F(AllocationCounter, CountsNewAndMallocAndItsSiblings) {
  const int64_t before = AllocationCount();
  kept = std::make_unique<int>(1);
  EXPECT_EQ(AllocationCount(), before + 1);
  void* volatile block = std::malloc(10);
  block = std::realloc(block, 100000);
  std::free(block);
  EXPECT_EQ(AllocationCount(), before + 3);
}

// The planted violation: a stage that allocates is seen in its row.
TEST_F(AllocationCounter, ShowsInTheRowOfAStageThatAllocates) {
  BenchRow row;
  MeasureRow({.run = [] { kept = std::make_unique<int>(2); }}, row);
  EXPECT_EQ(row.allocations, row.repetitions);
}

TEST_F(AllocationCounter, LeavesOutWhatPreparesAStage) {
  BenchRow row;
  int sum = 0;
  MeasureRow({.prepare = [] { kept = std::make_unique<int>(3); }, .run = [&sum] { sum += *kept; }},
             row);
  EXPECT_EQ(row.allocations, 0);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace hardpack::command
