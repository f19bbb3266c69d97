// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/nearest_name.h"

#include "gtest/gtest.h"

namespace hardpack {
namespace {

TEST(NearestName, IsTheOneWithTheFewestChanges) {
  const std::vector<std::string> names = {"astar", "costmap", "path", "speed"};
  EXPECT_EQ(NearestName("costmpa", names), "costmap");
  EXPECT_EQ(NearestName("pathh", names), "path");
  EXPECT_EQ(NearestName("star", names), "astar");
  EXPECT_EQ(NearestName("speed", names), "speed");
}

TEST(NearestName, IsTheFirstOfSeveral) {
  EXPECT_EQ(NearestName("ab", {"ax", "ay"}), "ax");
}

TEST(NearestName, IsNoneWhenMoreThanHalfWouldChange) {
  EXPECT_EQ(NearestName("abcd", {"abxyz"}), "");
  EXPECT_EQ(NearestName("abcd", {"abxy"}), "abxy");
  EXPECT_EQ(NearestName("", {"path"}), "");
  EXPECT_EQ(NearestName("path", {}), "");
}

}  // namespace
}  // namespace hardpack
