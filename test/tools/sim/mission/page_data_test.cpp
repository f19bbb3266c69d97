// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tools/sim/mission/page.h"
#include "tools/sim/mission/reaction_window.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::mission {
namespace {

std::vector<uint32_t> Bins(uint32_t in_tenth, uint32_t beyond = 0) {
  std::vector<uint32_t> bins(ReactionMeter::kRadiusBins + 1, 0);
  bins[9] = in_tenth;  // up to 0.20 m
  bins.back() = beyond;
  return bins;
}

TEST(ReactionWindow, TellsWhatWasCountedOfLate) {
  ReactionWindow window;
  EXPECT_EQ(window.Radius_m(0.5), 0.0);
  window.Add(Bins(1000));
  EXPECT_EQ(window.Radius_m(0.5), 0.0);  // when they were counted is not known
  window.Add(Bins(1098, 2));
  EXPECT_NEAR(window.Radius_m(0.5), 0.20, 1.0e-6);
  EXPECT_NEAR(window.Radius_m(0.98), 0.20, 1.0e-6);
  EXPECT_NEAR(window.Radius_m(0.99), 5.0, 1.0e-6);
  for (size_t i = 0; i <= ReactionWindow::kSamples; ++i) window.Add(Bins(1098, 2));
  EXPECT_EQ(window.Radius_m(0.99), 0.0);  // a second later
}

TEST(PageOf, LetsNoTextEndItsElement) {
  const std::string page = PageOf({{"text", "</script><!-- \xff \xe2\x80\xa8"}});
  EXPECT_NE(page.find(R"("\u003c/script>\u003c!-- \ufffd \u2028")"), std::string::npos);
  EXPECT_EQ(page.find("{\"mission\": null}"), std::string::npos);
  EXPECT_EQ(page.find("/* STYLE */"), std::string::npos);
  EXPECT_EQ(page.find("/* SCRIPT */"), std::string::npos);
}

//        wall at 5 m; the goal is beyond it, and the mission ends before it is there
//   o ->  |      x
TEST(PageData, HasMapsThatLieWhereTheWorldIs) {
  MissionSettings settings;
  ASSERT_TRUE(world::MakeScenario("open", 1, settings.scenario).ok());
  settings.scenario.goal = {9.0, 0.0};
  settings.scenario.world.AddBox({5.0, 0.0}, 0.0, 0.6, 2.0, -0.5, 1.5,
                                 {world::Label::kBarrier, world::Matter::kSolid, 1.0});
  ASSERT_TRUE(sim::ReadBody(HARDPACK_VEHICLES "/warthog_paper.toml", settings.vehicle).ok());
  settings.lidar_columns = 512;
  settings.limit_s = 2.0;
  experiment::RunResult result;
  MissionTrace trace;
  ASSERT_TRUE(RunMission(settings, result, &trace).ok());
  ASSERT_GE(trace.maps.size(), 2u);
  ASSERT_LE(trace.maps.size(), MapRecorder::kMost);
  const MapRecord& map = trace.maps.back();
  ASSERT_EQ(map.cells.size(), static_cast<size_t>(map.columns) * static_cast<size_t>(map.rows));
  int hard = 0;
  for (size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i] != MapCell::kHard) continue;
    ++hard;
    const double along_m = 0.2 * (static_cast<double>(i % static_cast<size_t>(map.columns)) + 0.5);
    const double left_m = 0.2 * (static_cast<double>(i / static_cast<size_t>(map.columns)) + 0.5);
    const double x_m = map.x_m + std::cos(map.yaw_rad) * along_m - std::sin(map.yaw_rad) * left_m;
    const double y_m = map.y_m + std::sin(map.yaw_rad) * along_m + std::cos(map.yaw_rad) * left_m;
    EXPECT_NEAR(x_m, 5.0, 0.8);
    EXPECT_NEAR(y_m, 0.0, 1.5);
  }
  EXPECT_GT(hard, 3);

  const nlohmann::ordered_json data = PageData(settings, result, trace);
  EXPECT_EQ(data["run"], experiment::ToJson(result));
  ASSERT_EQ(data["samples"]["t_s"].size(), trace.samples.size());
  EXPECT_NEAR(data["samples"]["x_m"].back(), trace.samples.back().x_m, 0.005);
  EXPECT_EQ(data["plans"].size(), trace.plans.size());
  EXPECT_EQ(data["scene"]["bodies"][0]["corners"].size(), 4u);
  EXPECT_EQ(data["has_log"], false);
}

}  // namespace
}  // namespace hardpack::mission
