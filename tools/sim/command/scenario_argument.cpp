// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/scenario_argument.h"

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/sim/world/map_world.h"

namespace hardpack::command {
namespace {

// Level ground: the vehicle stands at height 0.
world::Scenario MapScenario(const std::string& path, const ScenarioOptions& options) {
  map_server::OccupancyMap map;
  Require(map_server::ReadOccupancyMap(path, map));
  world::Scenario scenario;
  scenario.name = path;
  scenario.description = "A map of ROS map_server: walls of 2 m, bushes of 1 m.";
  scenario.world = world::WorldOfMap(map);
  const auto start = ParseNumbers("--start", options.start, 2, 3, "X,Y[,THETA]");
  scenario.start.position = {double{start[0]}, double{start[1]}, 0.0};
  if (start.size() == 3) scenario.start.yaw_rad = double{start[2]};
  const auto goal =
      ParseNumbers("--goal", options.goal.empty() ? options.start : options.goal, 2, 3, "X,Y");
  scenario.goal = {double{goal[0]}, double{goal[1]}};
  return scenario;
}

}  // namespace

world::Scenario ScenarioOf(const std::string& name, uint64_t seed, const ScenarioOptions& options) {
  if (name.ends_with(".yaml")) return MapScenario(name, options);
  world::Scenario scenario;
  Require(world::MakeScenario(name, seed, scenario));
  return scenario;
}

}  // namespace hardpack::command
