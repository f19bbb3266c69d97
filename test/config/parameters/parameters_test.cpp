// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "config/validate.h"
#include "gtest/gtest.h"

namespace hardpack {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// visit(params, group, entry) for each parameter of new default parameters.
template <typename Params, typename Visit>
void ForEachParameter(Visit visit) {
  Params outer;
  VisitParameters(outer, [&](auto&, const auto& table) {
    for (const auto& entry : table) {
      Params params;
      VisitParameters(params, [&]<typename Group>(Group& group, const auto& other_table) {
        if constexpr (std::is_same_v<decltype(table), decltype(other_table)>) {
          visit(params, group, entry);
        }
      });
    }
  });
}
template <typename Visit>
void ForEachParameter(Visit visit) {
  ForEachParameter<PlannerParams>(visit);
  ForEachParameter<PerceptionParams>(visit);
  ForEachParameter<OnboardParams>(visit);
}

TEST(Parameters, HaveNamesOfTheirOwnThatFit) {
  std::set<std::string> names;
  ForEachParameter([&](auto&, auto&, const auto& entry) {
    EXPECT_TRUE(names.insert(entry.full_name).second) << entry.full_name;
    EXPECT_LE(std::strlen(entry.full_name), static_cast<size_t>(kMaxParameterName));
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
  InsParams ins;
  EXPECT_EQ(SetParameter("ins.yaw_rad", 1.0, ins), Status::kOk);
  EXPECT_EQ(ins.yaw_rad, 1.0f);
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

TEST(SetParameter, ReachesEachParameterAndNoOther) {
  ForEachParameter([](auto& params, auto& group, const auto& entry) {
    const auto before = params;
    const double low = static_cast<double>(entry.low);
    ASSERT_EQ(SetParameter(entry.full_name, low, params), Status::kOk) << entry.full_name;
    EXPECT_EQ(entry.Get(group), entry.low) << entry.full_name;
    // Put back by its member, everything is as before: nothing else was written.
    const float other = entry.Get(group) == entry.high ? entry.low : entry.high;
    ASSERT_EQ(SetParameter(entry.full_name, static_cast<double>(other), params), Status::kOk);
    EXPECT_EQ(entry.Get(group), other) << entry.full_name;
    if (entry.number != nullptr) group.*entry.number = 0.0f;
    if (entry.whole != nullptr) group.*entry.whole = 0;
    if (entry.rule != nullptr) group.*entry.rule = ObstacleRule::kInCell;
    auto expected = before;
    VisitParameters(expected, [&]<typename Group>(Group& expected_group, const auto&) {
      if constexpr (std::is_same_v<Group, std::remove_reference_t<decltype(group)>>) {
        if (entry.number != nullptr) expected_group.*entry.number = 0.0f;
        if (entry.whole != nullptr) expected_group.*entry.whole = 0;
        if (entry.rule != nullptr) expected_group.*entry.rule = ObstacleRule::kInCell;
      }
    });
    EXPECT_EQ(std::memcmp(&params, &expected, sizeof(params)), 0) << entry.full_name;
  });
}

TEST(SetParameter, TakesTheEndsOfARangeAsTheyAreTyped) {
  PlannerParams params;
  EXPECT_EQ(SetParameter("speed.max_speed_mps", 0.1, params), Status::kOk);
  EXPECT_EQ(params.speed.max_speed_mps, 0.1f);
}

TEST(SetParameter, RefusesAndLeavesAsItWas) {
  PlannerParams params;
  EXPECT_EQ(SetParameter("costmap.halo_m", 3.01, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetParameter("costmap.halo_m", -0.01, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetParameter("costmap.halo_m", 1e300, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetParameter("costmap.halo_m", -1e300, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetParameter("costmap.halo_m", kNan, params), Status::kNotFinite);
  EXPECT_EQ(SetParameter("costmap.halo_m", kInfinity, params), Status::kNotFinite);
  EXPECT_EQ(SetParameter("costmap.halo_m", -kInfinity, params), Status::kNotFinite);
  EXPECT_EQ(params.costmap.halo_m, CostmapParams{}.halo_m);
}

TEST(SetParameter, RefusesFractionsOfCounts) {
  PlannerParams params;
  EXPECT_EQ(SetParameter("optimizer.window_steps", 20.5, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetParameter("optimizer.window_steps", 20.0000001, params),
            Status::kParameterOutOfRange);
  EXPECT_EQ(params.optimizer.window_steps, OptimizerParams{}.window_steps);
  EXPECT_EQ(SetParameter("optimizer.window_steps", 20, params), Status::kOk);
  EXPECT_EQ(params.optimizer.window_steps, 20);
}

// float has 24 bits: 16777217 and 2147483519 are not among its values.
TEST(SetParameter, SetsWholeNumbersBeyondTwoTo24Exactly) {
  OnboardParams params;
  for (const int32_t code : {16777215, 16777216, 16777217, 123456789, 2147483519, 2147483520}) {
    ASSERT_EQ(SetParameter("drive.product_code", code, params), Status::kOk) << code;
    EXPECT_EQ(params.drive.product_code, code);
    EXPECT_EQ(FirstInvalidParameter(params), nullptr) << code;
  }
}

// Rounded to a float, 2147483521 would be the upper end of the range.
TEST(SetParameter, HoldsWholeNumbersBeyondTwoTo24ToTheirRange) {
  OnboardParams params;
  params.drive.product_code = 5;
  for (const double code :
       {2147483521.0, 2147483647.0, 2147483648.0, 1e18, -1.0, 0.5, 16777216.5}) {
    EXPECT_EQ(SetParameter("drive.product_code", code, params), Status::kParameterOutOfRange);
    EXPECT_EQ(params.drive.product_code, 5) << code;
  }
  params.drive.product_code = 2147483521;
  EXPECT_STREQ(FirstInvalidParameter(params), "drive.product_code");
}

TEST(SetParameter, DoesNotKnowOtherNames) {
  PlannerParams params;
  for (const char* name : {"", "halo_m", "costmap", "costmap.", "costmap.halo", "costmap.halo_mm",
                           "Costmap.halo_m", "mount.x_m", ".halo_m"}) {
    EXPECT_EQ(SetParameter(name, 1.0, params), Status::kInvalidArgument) << name;
  }
  const std::string endless(100000, 'c');
  EXPECT_EQ(SetParameter(endless.c_str(), 1.0, params), Status::kInvalidArgument);
  LidarMountParams mount;
  EXPECT_EQ(SetParameter("mount.x_m", 1.0, mount), Status::kOk);
  EXPECT_EQ(SetParameter("costmap.halo_m", 1.0, mount), Status::kInvalidArgument);
}

constexpr float HaloSetAtCompileTime() {
  PlannerParams params;
  return SetParameter("costmap.halo_m", 1.25, params) == Status::kOk ? params.costmap.halo_m : -1;
}
static_assert(HaloSetAtCompileTime() == 1.25f);

}  // namespace
}  // namespace hardpack
