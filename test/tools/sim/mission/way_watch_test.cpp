// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/way_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace hardpack::mission {
namespace {

using experiment::WayResult;
using world::Point2;

//            ___ left
//   start --/-(20, 1)-\-- goal at (40, 0)
//           \___/ right
world::Scenario WithLandmark() {
  world::Scenario scenario;
  scenario.goal = {40.0, 0.0};
  scenario.around = {{20.0, 1.0}, 3.0};
  return scenario;
}

std::vector<Point2> Around(double y_m) {
  return {{0.0, 0.0}, {15.0, y_m}, {25.0, y_m}, {40.0, 0.0}};
}

TEST(DistanceToPath, IsToTheNearestChord) {
  const std::vector<Point2> path = {{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}};
  EXPECT_DOUBLE_EQ(DistanceToPath_m({5.0, 2.0}, path), 2.0);
  EXPECT_DOUBLE_EQ(DistanceToPath_m({12.0, 5.0}, path), 2.0);
  EXPECT_DOUBLE_EQ(DistanceToPath_m({-3.0, 4.0}, path), 5.0);
  EXPECT_TRUE(std::isinf(DistanceToPath_m({0.0, 0.0}, {})));
}

TEST(OffBase, IsTheLargestDistanceOfThePlan) {
  Plan plan;
  for (const float x_m : {0.0f, 1.0f, 2.0f, 3.0f}) {
    plan.base.Resize(plan.base.size() + 1);
    plan.base.back() = {x_m, 0.0f, 0.0f};
    plan.path.Resize(plan.path.size() + 1);
    plan.path.back() = {x_m, x_m == 2.0f ? -0.75f : 0.25f, 0.0f};
  }
  EXPECT_DOUBLE_EQ(OffBase_m(plan), 0.75);
  plan.base.Clear();
  EXPECT_DOUBLE_EQ(OffBase_m(plan), 0.0);
}

TEST(WayWatch, CountsPlansThatChangeTheSide) {
  const world::Scenario scenario = WithLandmark();
  WayResult result;
  WayWatch watch(scenario, result);
  watch.Committed(Around(5.0), {0.0, 0.0}, false);
  watch.Committed(Around(4.0), {2.0, 0.0}, true);
  EXPECT_EQ(result.side_switches, 0);
  watch.Committed(Around(0.5), {4.0, 0.0}, true);  // right of the middle at y = 1
  EXPECT_EQ(result.side_switches, 1);
  // One that ends before it has no side.
  watch.Committed(std::vector<Point2>{{4.0, 0.0}, {10.0, 0.0}}, {5.0, 0.0}, true);
  EXPECT_EQ(result.side_switches, 1);
  watch.Committed(Around(5.0), {6.0, 0.0}, true);
  EXPECT_EQ(result.side_switches, 2);
  // Behind it there is nothing to switch any more.
  watch.Committed(Around(-5.0), {21.0, 5.0}, true);
  EXPECT_EQ(result.side_switches, 2);
}

TEST(WayWatch, CountsReplansBesideTheLandmarkOnly) {
  const world::Scenario scenario = WithLandmark();
  WayResult result;
  WayWatch watch(scenario, result);
  watch.Committed(Around(5.0), {16.0, 5.0}, true);
  watch.Committed(Around(5.0), {18.0, 5.0}, false);  // the first one replaces none
  EXPECT_EQ(result.replans_beside, 0);
  watch.Committed(Around(5.0), {18.0, 5.0}, true);
  watch.Committed(Around(5.0), {22.5, 5.0}, true);
  watch.Committed(Around(5.0), {24.0, 5.0}, true);
  EXPECT_EQ(result.replans_beside, 2);
}

TEST(WayWatch, CountsReplansWhereTheVehicleLooksPastTheLandmarkToo) {
  world::Scenario scenario = WithLandmark();
  scenario.around->seen_past_m = 2.5;  // from y = 1
  WayResult result;
  WayWatch watch(scenario, result);
  watch.Committed(Around(5.0), {10.0, 3.4}, true);
  EXPECT_EQ(result.replans_beside, 0);
  watch.Committed(Around(5.0), {10.0, 3.6}, true);
  watch.Committed(Around(-5.0), {10.0, -1.6}, true);
  EXPECT_EQ(result.replans_beside, 2);
  watch.Committed(Around(5.0), {24.0, 5.0}, true);  // past it
  EXPECT_EQ(result.replans_beside, 2);
}

TEST(WayWatch, AnOvershootIsOverWhenItIsSmall) {
  const world::Scenario scenario;
  WayResult result;
  WayWatch watch(scenario, result);
  watch.Followed(1.0, 0.15);
  EXPECT_EQ(result.overshoots, 0);
  watch.Followed(2.0, 0.35);
  EXPECT_FALSE(result.recovered);
  watch.Followed(2.5, 0.15);  // less, but not small
  watch.Followed(2.6, 0.25);
  EXPECT_EQ(result.overshoots, 1);
  EXPECT_FALSE(result.recovered);
  watch.Followed(3.0, 0.05);
  EXPECT_TRUE(result.recovered);
  EXPECT_DOUBLE_EQ(result.recovery_s, 1.0);
  EXPECT_DOUBLE_EQ(result.cross_track_m, 0.35);
  watch.Followed(4.0, 0.25);
  EXPECT_EQ(result.overshoots, 2);
}

// Walls at y = +-4; a pillar from -0.6 to 0.6 leaves passages whose middles are at +-2.3.
TEST(WayWatch, MeasuresFromTheMiddleOfWhatIsFree) {
  world::Scenario scenario;
  scenario.goal = {40.0, 0.0};
  scenario.around = {{20.0, 0.0}, 0.6};
  scenario.corridor_half_width_m = 4.0;
  WayResult result;
  WayWatch watch(scenario, result);
  watch.Moved({5.0, -0.25});
  EXPECT_DOUBLE_EQ(result.off_middle_m.value(), 0.25);
  watch.Moved({14.0, 2.0});  // on its way to one side
  EXPECT_DOUBLE_EQ(result.off_middle_m.value(), 0.25);
  watch.Moved({20.3, -2.7});
  EXPECT_NEAR(result.off_middle_m.value(), 0.4, 1e-12);
}

TEST(WayWatch, HasNoMiddleWithoutACorridor) {
  const world::Scenario scenario = WithLandmark();
  WayResult result;
  WayWatch watch(scenario, result);
  watch.Moved({5.0, 3.0});
  EXPECT_FALSE(result.off_middle_m.has_value());
}

}  // namespace
}  // namespace hardpack::mission
