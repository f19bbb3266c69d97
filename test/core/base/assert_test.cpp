// SPDX-License-Identifier: Apache-2.0
#include "core/base/assert.h"

#include "gtest/gtest.h"
#include "test/core/base/broken_assumption.h"

namespace hardpack {
namespace {

TEST(Assert, TellsTheHookWhereAndWhat) {
  const int number = 3;
  const int line = __LINE__ + 1;
  const BrokenAssumption broken([&] { HP_ASSERT(number == 4); });
  EXPECT_EQ(broken.expression(), "number == 4");
  EXPECT_EQ(broken.line(), line);
  EXPECT_NE(broken.file().find("assert_test.cpp"), std::string::npos);
}

TEST(Assert, IsSilentWhenTheAssumptionHolds) {
  const BrokenAssumption broken([] { HP_ASSERT(2 + 2 == 4); });
  EXPECT_EQ(broken.expression(), "");
}

// In every build, optimised ones too.
TEST(Assert, EvaluatesItsExpressionOnce) {
  int evaluations = 0;
  HP_ASSERT(++evaluations == 1);
  EXPECT_EQ(evaluations, 1);
}

TEST(Assert, IsAnExpression) {
  const int doubled = (HP_ASSERT(true), 2);
  EXPECT_EQ(doubled, 2);
}

TEST(AssertDeathTest, StopsWithoutAHook) {
  SetAssertionHook(nullptr);
  EXPECT_DEATH(HP_ASSERT(false), "");
}

TEST(AssertDeathTest, StopsWhenTheHookReturns) {
  EXPECT_DEATH(
      {
        SetAssertionHook([](const char*, int, const char*) {});
        HP_ASSERT(false);
      },
      "");
}

}  // namespace
}  // namespace hardpack
