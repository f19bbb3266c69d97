// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/set_parameter.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string_view>
#include <type_traits>

#include "test/config/parameters/for_each_parameter.h"

namespace hardpack {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// By the full name of its entry.
template <typename Params>
Status SetByName(std::string_view name, double value, Params& params) {
  Status status = Status::kInvalidArgument;
  VisitParameters(params, [&](auto& group, const auto& table) {
    for (const auto& entry : table) {
      if (entry.full_name == name) status = SetParameter(entry, value, group);
    }
  });
  return status;
}

TEST(SetParameter, ReachesEachParameterAndNoOther) {
  ForEachParameter([](auto& params, auto& group, const auto& entry) {
    const auto before = params;
    const double low = static_cast<double>(entry.low);
    ASSERT_EQ(SetByName(entry.full_name, low, params), Status::kOk) << entry.full_name;
    EXPECT_EQ(entry.Get(group), entry.low) << entry.full_name;
    // Put back by its member, everything is as before: nothing else was written.
    const float other = entry.Get(group) == entry.high ? entry.low : entry.high;
    ASSERT_EQ(SetByName(entry.full_name, static_cast<double>(other), params), Status::kOk);
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
  EXPECT_EQ(SetByName("speed.max_speed_mps", 0.1, params), Status::kOk);
  EXPECT_EQ(params.speed.max_speed_mps, 0.1f);
}

TEST(SetParameter, RefusesAndLeavesAsItWas) {
  PlannerParams params;
  EXPECT_EQ(SetByName("costmap.halo_m", 3.01, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetByName("costmap.halo_m", -0.01, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetByName("costmap.halo_m", 1e300, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetByName("costmap.halo_m", -1e300, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetByName("costmap.halo_m", kNan, params), Status::kNotFinite);
  EXPECT_EQ(SetByName("costmap.halo_m", kInfinity, params), Status::kNotFinite);
  EXPECT_EQ(SetByName("costmap.halo_m", -kInfinity, params), Status::kNotFinite);
  EXPECT_EQ(params.costmap.halo_m, CostmapParams{}.halo_m);
}

TEST(SetParameter, RefusesFractionsOfCounts) {
  PlannerParams params;
  EXPECT_EQ(SetByName("optimizer.window_steps", 20.5, params), Status::kParameterOutOfRange);
  EXPECT_EQ(SetByName("optimizer.window_steps", 20.0000001, params), Status::kParameterOutOfRange);
  EXPECT_EQ(params.optimizer.window_steps, OptimizerParams{}.window_steps);
  EXPECT_EQ(SetByName("optimizer.window_steps", 20, params), Status::kOk);
  EXPECT_EQ(params.optimizer.window_steps, 20);
}

// float has 24 bits: 16777217 and 2147483519 are not among its values.
TEST(SetParameter, SetsWholeNumbersBeyondTwoTo24Exactly) {
  OnboardParams params;
  for (const int32_t code : {16777215, 16777216, 16777217, 123456789, 2147483519, 2147483520}) {
    ASSERT_EQ(SetByName("drive.product_code", code, params), Status::kOk) << code;
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
    EXPECT_EQ(SetByName("drive.product_code", code, params), Status::kParameterOutOfRange);
    EXPECT_EQ(params.drive.product_code, 5) << code;
  }
  params.drive.product_code = 2147483521;
  EXPECT_STREQ(FirstInvalidParameter(params), "drive.product_code");
}

}  // namespace
}  // namespace hardpack
