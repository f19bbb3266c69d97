// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "core/base/validate.h"
#include "gtest/gtest.h"
#include "test/config/parameters/for_each_parameter.h"

namespace hardpack {
namespace {

TEST(Parameters, HaveNamesOfTheirOwnThatFit) {
  std::set<std::string> names;
  ForEachParameter([&](auto&, auto&, const auto& entry) {
    EXPECT_TRUE(names.insert(entry.full_name).second) << entry.full_name;
    EXPECT_TRUE(std::string(entry.full_name).ends_with(std::string(".") + entry.name));
    EXPECT_GT(std::strlen(entry.description), 5u) << entry.full_name;
  });
  EXPECT_EQ(names.size(),
            (sizeof(PlannerParams) + sizeof(PerceptionParams) + sizeof(OnboardParams)) / 4);
}

TEST(Parameters, HaveRangesThatHoldTheirDefaults) {
  ForEachParameter([](auto&, auto& group, const auto& entry) {
    EXPECT_LT(entry.low, entry.high) << entry.full_name;
    EXPECT_GE(entry.Get(group), entry.low) << entry.full_name;
    EXPECT_LE(entry.Get(group), entry.high) << entry.full_name;
  });
  EXPECT_EQ(FirstInvalidParameter(PlannerParams{}), nullptr);
  EXPECT_EQ(FirstInvalidParameter(PerceptionParams{}), nullptr);
  EXPECT_EQ(FirstInvalidParameter(OnboardParams{}), nullptr);
}

TEST(Parameters, OfOneGroupAreVisitedAlone) {
  const PerceptionParams perception;
  VisitParameters(perception, [](const auto& group, const auto& table) {
    int visits = 0;
    VisitParameters(group, [&](const auto& same_group, const auto& same_table) {
      ++visits;
      EXPECT_EQ(static_cast<const void*>(&same_group), static_cast<const void*>(&group));
      EXPECT_EQ(static_cast<const void*>(&same_table), static_cast<const void*>(&table));
    });
    EXPECT_EQ(visits, 1);
  });
}

// Also those that must not exceed, or not be exceeded by, another: it is not the other that is
// named.
TEST(Parameters, AreNamedWhenOutOfRange) {
  ForEachParameter([](auto& params, auto& group, const auto& entry) {
    if (entry.number == nullptr) return;
    const float largest = std::numeric_limits<float>::infinity();
    for (const float bad :
         {std::nextafter(entry.low, -largest), std::nextafter(entry.high, largest), largest,
          -largest, std::numeric_limits<float>::quiet_NaN()}) {
      group.*entry.number = bad;
      ASSERT_STREQ(FirstInvalidParameter(params), entry.full_name) << bad;
    }
  });
}

TEST(Parameters, ThatAreCountsAreNamedWhenOutOfRange) {
  PlannerParams params;
  params.astar.max_expansions = 0;
  EXPECT_STREQ(FirstInvalidParameter(params), "astar.max_expansions");
  params.astar.max_expansions = 262145;
  EXPECT_STREQ(FirstInvalidParameter(params), "astar.max_expansions");
  params.astar.max_expansions = INT32_MAX;
  EXPECT_STREQ(FirstInvalidParameter(params), "astar.max_expansions");
  params = {};
  params.optimizer.window_steps = INT32_MIN;
  EXPECT_STREQ(FirstInvalidParameter(params), "optimizer.window_steps");
  params = {};
  params.costmap.obstacle_rule = static_cast<ObstacleRule>(2);
  EXPECT_STREQ(FirstInvalidParameter(params), "costmap.obstacle_rule");
}

TEST(Parameters, AreNamedInOrderWhenSeveralAreWrong) {
  PlannerParams params;
  params.speed.gamma_per_m = -1.0f;
  params.costmap.halo_m = 9.0f;
  EXPECT_STREQ(FirstInvalidParameter(params), "costmap.halo_m");
}

TEST(Parameters, MayNotExceedTheirCounterparts) {
  PlannerParams params;
  params.speed.min_speed_mps = 3.0f;
  params.speed.max_speed_mps = 2.5f;
  EXPECT_STREQ(FirstInvalidParameter(params), "speed.min_speed_mps");
  params.speed.max_speed_mps = 3.0f;
  EXPECT_EQ(FirstInvalidParameter(params), nullptr);

  LidarMountParams mount;
  mount.self_min_x_m = 2.0f;
  EXPECT_STREQ(FirstInvalidParameter(mount), "mount.self_min_x_m");
  mount = {};
  mount.max_range_m = 1.0f;
  mount.min_range_m = 2.0f;
  EXPECT_STREQ(FirstInvalidParameter(mount), "mount.min_range_m");
}

}  // namespace
}  // namespace hardpack
