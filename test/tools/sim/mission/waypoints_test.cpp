// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "port_linux/hardpackctl/waypoints.h"
#include "tools/sim/mission/mission.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

// Lists of waypoints, driven in the simulator; the files of docs/simulation.md.

namespace hardpack::mission {
namespace {

using experiment::Outcome;
using experiment::RunResult;

MissionSettings MissionBy(const std::string& file) {
  MissionSettings settings;
  EXPECT_TRUE(world::MakeScenario("open", 1, settings.scenario).ok());
  EXPECT_TRUE(sim::ReadBody(HARDPACK_VEHICLES "/warthog_paper.toml", settings.vehicle).ok());
  settings.spread = false;
  control::OperatorCommand command;
  const ReadOutcome read =
      ctl::ReadWaypoints(HARDPACK_VEHICLES "/../../tools/sim/waypoints/" + file, command);
  EXPECT_TRUE(read.ok()) << read.message;
  settings.waypoints.assign(command.waypoint, command.waypoint + command.waypoints);
  const Vec2 last = settings.waypoints.back().position_m;
  settings.scenario.goal = {double{last.x_m}, double{last.y_m}};
  return settings;
}

struct Driven {
  RunResult result;
  double slowest_mps = 1.0e9;       // from 3 s on, before the last 4 m
  double fastest_turn_radps = 0.0;  // where it is slower than 0.3 m/s
  double farthest_m = 0.0;          // from the waypoint that it passed worst
};

Driven Drive(const MissionSettings& settings) {
  Driven driven;
  MissionTrace trace;
  EXPECT_TRUE(RunMission(settings, driven.result, &trace).ok());
  const world::Point2 goal = settings.scenario.goal;
  for (const MissionTrace::Sample& sample : trace.samples) {
    const bool ends = std::hypot(sample.x_m - goal.x_m, sample.y_m - goal.y_m) < 4.0;
    if (sample.t_s < 3.0 || ends) continue;
    driven.slowest_mps = std::min(driven.slowest_mps, sample.speed_mps);
    if (sample.speed_mps < 0.3) {
      driven.fastest_turn_radps =
          std::max(driven.fastest_turn_radps, std::abs(sample.yaw_rate_radps));
    }
  }
  for (const control::Waypoint& waypoint : settings.waypoints) {
    const auto [x_m, y_m] = waypoint.position_m;
    double nearest_m = 1.0e9;
    for (const MissionTrace::Sample& sample : trace.samples) {
      nearest_m =
          std::min(nearest_m, std::hypot(sample.x_m - double{x_m}, sample.y_m - double{y_m}));
    }
    driven.farthest_m = std::max(driven.farthest_m, nearest_m);
  }
  return driven;
}

TEST(Waypoints, OnALineTakeNoTime) {
  MissionSettings settings = MissionBy("line.txt");
  ASSERT_EQ(settings.waypoints.size(), 5u);
  const Driven by_all = Drive(settings);
  EXPECT_EQ(by_all.result.outcome, Outcome::kReached);
  EXPECT_GT(by_all.slowest_mps, 2.0);
  settings.waypoints.clear();
  const Driven alone = Drive(settings);
  EXPECT_NEAR(by_all.result.time_s, alone.result.time_s, 0.2);
}

// SR-MIS05
TEST(Waypoints, InAZigzagArePassedWithoutATurnOnTheSpot) {
  const Driven driven = Drive(MissionBy("zigzag.txt"));
  EXPECT_EQ(driven.result.outcome, Outcome::kReached);
  EXPECT_LT(driven.result.time_s, 32.0);
  EXPECT_GT(driven.slowest_mps, 1.0);
  EXPECT_EQ(driven.fastest_turn_radps, 0.0);
  EXPECT_LT(driven.farthest_m, 2.0) << "the radius and the tracking error";
}

TEST(Waypoints, AreOfTheDigestOfAMission) {
  MissionSettings settings = MissionBy("zigzag.txt");
  const uint64_t digest = DigestOf(settings);
  settings.waypoints[2].stops = true;
  EXPECT_NE(DigestOf(settings), digest);
  settings.waypoints.clear();
  EXPECT_NE(DigestOf(settings), digest);
}

TEST(Waypoints, ReplayToTheSameDecisions) {
  MissionSettings settings = MissionBy("line.txt");
  settings.waypoints.resize(2);
  settings.scenario.goal = {16.0, 0.0};
  settings.waypoints[0].stops = true;
  settings.waypoints[0].hold_s = 1;
  settings.lidar_columns = 512;
  settings.log = ::testing::TempDir() + "waypoints.pcap";
  const Driven driven = Drive(settings);
  EXPECT_EQ(driven.result.outcome, Outcome::kReached);
  std::string difference;
  EXPECT_TRUE(ReplaysTheSame(settings.log, driven.result.decision_hash, difference).ok());
  EXPECT_EQ(difference, "");
}

}  // namespace
}  // namespace hardpack::mission
