// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/world_command.h"

#include <cmath>
#include <iostream>
#include <memory>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/sim/command/scenario_argument.h"
#include "tools/sim/command/world_picture.h"
#include "tools/sim/world/slopes.h"

namespace hardpack::command {
namespace {

struct WorldOptions {
  std::string name;
  ScenarioOptions scenario;
  std::string out;
  uint32_t seed = 1;
};

void Run(const WorldOptions& options) {
  const world::Scenario scenario = ScenarioOf(options.name, options.seed, options.scenario);
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
  std::string slopes;
  for (const std::string& name : world::SlopeNames()) slopes += " " + name;
  CLI::App* command = app.add_subcommand(
      "world",
      "Draw a world of the simulation, with one revolution of its lidar, as world.png.\n"
      "Worlds:" +
          names + "; or a ROS map_server map (FILE.yaml).\nWith slope:" + slopes +
          "; with their steepness, side_slope:20. Any other on a tilted plane, gap:10 (degrees).");
  const auto options = std::make_shared<WorldOptions>();
  command->add_option("name", options->name, "World or FILE.yaml")->required();
  command->add_option("--out", options->out, "Folder to write to; created if missing")->required();
  command->add_option("--seed", options->seed, "Seed of its variations (default 1)");
  command->add_option("--start", options->scenario.start, "X,Y[,THETA] on a map (default 0,0)");
  command->add_option("--goal", options->scenario.goal, "X,Y on a map");
  command->callback([options] { Run(*options); });
}

}  // namespace hardpack::command
