// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.h"

#include <cctype>
#include <set>
#include <string>

#include "gtest/gtest.h"

namespace hardpack {
namespace {

// All 256 values of the type: those of the list have names, in two runs without a gap.
TEST(Status, HasOneNameForEachCode) {
  std::set<std::string> names;
  int named_failures = 0;
  int named_usable = 0;
  for (int value = 0; value < 256; ++value) {
    const Status status = static_cast<Status>(value);
    const std::string name = StatusName(status);
    if (name == "unknown") continue;
    EXPECT_TRUE(names.insert(name).second) << name << " is the name of two codes";
    if (IsUsable(status)) {
      EXPECT_EQ(value, named_usable++) << name;
    } else {
      EXPECT_EQ(value, static_cast<int>(Status::kFirstFailure) + named_failures++) << name;
    }
    for (const char letter : name) EXPECT_TRUE(std::islower(letter) || letter == '_') << name;
  }
  EXPECT_EQ(named_usable - 1, static_cast<int>(Status::kOffPath));
  EXPECT_EQ(named_failures - 1,
            static_cast<int>(Status::kGoalForbidden) - static_cast<int>(Status::kFirstFailure));
}

TEST(Status, DividesOutcomesWithAndWithoutAResult) {
  EXPECT_TRUE(IsUsable(Status::kOk));
  EXPECT_TRUE(IsUsable(Status::kLimitExceeded));
  EXPECT_FALSE(IsUsable(Status::kFirstFailure));
  EXPECT_FALSE(IsUsable(Status::kNotStarted));
  EXPECT_FALSE(IsUsable(Status::kDuplicate));
}

}  // namespace
}  // namespace hardpack
