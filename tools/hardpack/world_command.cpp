// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/world_command.h"

#include <cmath>
#include <iostream>
#include <memory>

#include "tools/hardpack/arguments.h"
#include "tools/hardpack/command.h"
#include "tools/hardpack/world_picture.h"
#include "tools/world/map_world.h"

namespace hardpack::command {
namespace {

struct WorldOptions {
  std::string name;
  std::string start = "0,0";
  std::string goal;
  std::string out;
  uint32_t seed = 1;
};

// The middle of the map, unless it is told where.
world::Scenario MapScenario(const WorldOptions& options) {
  map_server::OccupancyMap map;
  Require(map_server::ReadOccupancyMap(options.name, map));
  world::Scenario scenario;
  scenario.name = options.name;
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

void Run(const WorldOptions& options) {
  world::Scenario scenario;
  if (options.name.ends_with(".yaml")) {
    scenario = MapScenario(options);
  } else {
    Require(world::MakeScenario(options.name, options.seed, scenario));
  }
  const WorldScan scan = ScanFromStart(scenario, options.seed);
  MakeOutputFolder(options.out);
  const std::string path = options.out + "/world.png";
  Require(DrawWorld(scenario, options.seed, scan.returns).WritePng(path));
  std::cout << "ok: " << scenario.world.bodies().size() << " bodies, " << scan.returns.size()
            << " returns from the start, cast in " << std::round(scan.cast_ms * 10.0) / 10.0
            << " ms -> " << path << "\n";
}

}  // namespace

void AddWorldCommand(CLI::App& app) {
  std::string names;
  for (const std::string& name : world::WorldNames()) names += " " + name;
  CLI::App* command = app.add_subcommand(
      "world",
      "Draw a world that the simulation drives in, with one revolution of its lidar: world.png.\n"
      "Worlds:" +
          names + "; or a map of ROS map_server (FILE.yaml).");
  const auto options = std::make_shared<WorldOptions>();
  command->add_option("name", options->name, "World, or FILE.yaml")->required();
  command->add_option("--out", options->out, "Folder to write to; made when missing")->required();
  command->add_option("--seed", options->seed, "Of its variations (default 1)");
  command->add_option("--start", options->start, "X,Y[,THETA] on a map (default 0,0)");
  command->add_option("--goal", options->goal, "X,Y on a map");
  command->callback([options] { Run(*options); });
}

}  // namespace hardpack::command
