// SPDX-License-Identifier: Apache-2.0
#include "core/base/result.h"

#include <type_traits>

#include "gtest/gtest.h"
#include "test/core/base/broken_assumption.h"

namespace hardpack {
namespace {

static_assert(std::is_trivially_copyable_v<Result<float>>);

Result<int> Half(int number) {
  if (number % 2 != 0) return Status::kInvalidArgument;
  return number / 2;
}

TEST(Result, HoldsAValue) {
  const Result<int> result = Half(8);
  EXPECT_TRUE(result.ok());
  EXPECT_EQ(result.status(), Status::kOk);
  EXPECT_EQ(result.value(), 4);
}

TEST(Result, HoldsTheReasonWhyThereIsNone) {
  const Result<int> result = Half(7);
  EXPECT_FALSE(result.ok());
  EXPECT_EQ(result.status(), Status::kInvalidArgument);
}

TEST(Result, IsAssertedToHaveTheValueThatIsAskedFor) {
  const Result<int> result = Half(7);
  int seen = -1;
  EXPECT_EQ(BrokenAssumption([&] { seen = result.value(); }).expression(), "ok()");
  EXPECT_EQ(seen, -1);
}

TEST(Result, CannotFailWithAUsableStatus) {
  EXPECT_NE(BrokenAssumption([] { (void)Result<int>(Status::kOk); }).expression(), "");
  EXPECT_NE(BrokenAssumption([] { (void)Result<int>(Status::kPathCut); }).expression(), "");
}

}  // namespace
}  // namespace hardpack
