// SPDX-License-Identifier: Apache-2.0
#include "core/base/fixed_vector.h"

#include <random>
#include <type_traits>
#include <vector>

#include "gtest/gtest.h"
#include "test/core/base/broken_assumption.h"

namespace hardpack {
namespace {

static_assert(std::is_trivially_copyable_v<FixedVector<float, 3>>);

TEST(FixedVector, BeginsEmpty) {
  const FixedVector<int, 3> vector;
  EXPECT_TRUE(vector.empty());
  EXPECT_FALSE(vector.full());
  EXPECT_EQ(vector.size(), 0);
  EXPECT_EQ(vector.capacity(), 3);
  EXPECT_EQ(vector.begin(), vector.end());
}

TEST(FixedVector, RefusesWhatDoesNotFitAndStaysAsItWas) {
  FixedVector<int, 2> vector;
  EXPECT_EQ(vector.PushBack(10), Status::kOk);
  EXPECT_EQ(vector.PushBack(20), Status::kOk);
  EXPECT_TRUE(vector.full());
  EXPECT_EQ(vector.PushBack(30), Status::kCapacityExceeded);
  EXPECT_EQ(vector.size(), 2);
  EXPECT_EQ(vector[0], 10);
  EXPECT_EQ(vector.back(), 20);
}

TEST(FixedVector, ResizeKeepsTheFirstAndClearsTheNew) {
  FixedVector<int, 4> vector;
  ASSERT_EQ(vector.PushBack(1), Status::kOk);
  ASSERT_EQ(vector.PushBack(2), Status::kOk);
  vector.Resize(1);
  EXPECT_EQ(vector.size(), 1);
  EXPECT_EQ(vector[0], 1);
  vector.Resize(4);
  EXPECT_EQ(vector[0], 1);
  EXPECT_EQ(vector[1], 0);  // not the 2 that was there
  EXPECT_EQ(vector[3], 0);
  vector.Resize(0);
  EXPECT_TRUE(vector.empty());
}

TEST(FixedVector, IsAssertedAtItsBorders) {
  FixedVector<int, 2> vector;
  ASSERT_EQ(vector.PushBack(1), Status::kOk);
  const FixedVector<int, 2>& constant = vector;
  int seen = 0;
  EXPECT_NE(BrokenAssumption([&] { seen = vector[1]; }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { seen = vector[-1]; }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { seen = constant[1]; }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { vector.Resize(3); }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { vector.Resize(-1); }).expression(), "");
  EXPECT_EQ(BrokenAssumption([&] { seen = vector[0]; }).expression(), "");
  vector.Clear();
  EXPECT_NE(BrokenAssumption([&] { seen = vector.back(); }).expression(), "");
  EXPECT_NE(BrokenAssumption([&] { seen = constant.back(); }).expression(), "");
  EXPECT_EQ(seen, 1);
}

TEST(FixedVector, CopiesByValue) {
  FixedVector<int, 2> vector;
  ASSERT_EQ(vector.PushBack(1), Status::kOk);
  FixedVector<int, 2> copy = vector;
  copy[0] = 5;
  EXPECT_EQ(vector[0], 1);
  EXPECT_EQ(copy[0], 5);
}

// Random operations on it and on a std::vector.
TEST(FixedVector, BehavesAsAVectorOfBoundedSize) {
  constexpr uint32_t kSeed = 99;
  std::independent_bits_engine<std::mt19937, 32, uint32_t> random(kSeed);
  FixedVector<uint32_t, 7> vector;
  std::vector<uint32_t> reference;
  for (int i = 0; i < 20000; ++i) {
    const uint32_t operation = random() % 8;
    if (operation == 0) {
      vector.Clear();
      reference.clear();
    } else if (operation == 1) {
      const int size = static_cast<int>(random() % 8);
      vector.Resize(size);
      reference.resize(static_cast<size_t>(size));
    } else {
      const uint32_t value = random();
      const Status status = vector.PushBack(value);
      EXPECT_EQ(status, reference.size() < 7 ? Status::kOk : Status::kCapacityExceeded);
      if (status == Status::kOk) reference.push_back(value);
    }
    ASSERT_EQ(std::vector<uint32_t>(vector.begin(), vector.end()), reference)
        << "seed " << kSeed << ", operation " << i;
  }
}

constexpr int SumAtCompileTime() {
  FixedVector<int, 4> vector;
  vector.Resize(2);
  if (vector.PushBack(40) != Status::kOk) return -1;
  vector[0] = 2;
  return vector[0] + vector[1] + vector.back();
}
static_assert(SumAtCompileTime() == 42);

}  // namespace
}  // namespace hardpack
