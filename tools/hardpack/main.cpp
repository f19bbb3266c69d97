// SPDX-License-Identifier: Apache-2.0
#include "CLI/CLI.hpp"
#include "port_linux/command_line/program.h"
#include "port_linux/hardpackctl/ctl_command.h"
#include "tools/bench/bench_command.h"
#include "tools/fit/fit_command.h"
#include "tools/picture/canvas.h"
#include "tools/plan/figures_command.h"
#include "tools/plan/plan_command.h"
#include "tools/replay/replay_command.h"
#include "tools/sim/command/experiment_command.h"
#include "tools/sim/command/scene_command.h"
#include "tools/sim/command/sim_command.h"
#include "tools/sim/command/world_command.h"

int main(int argc, char** argv) {
  CLI::App app("Plans paths for off-road vehicles: costmap, A*, path optimizer, speeds, check.",
               "hardpack");
  app.set_version_flag("--version", HARDPACK_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 1 the work failed; 2 bad usage or unreadable input.\n"
      "hardpack COMMAND --help says more about each.");
  hardpack::command::AddPlanCommand(app);
  hardpack::command::AddFiguresCommand(app);
  hardpack::command::AddBenchCommand(app);
  hardpack::command::AddSceneCommand(app);
  hardpack::command::AddCtlCommands(
      *app.add_subcommand("ctl", "Talk to hardpackd, the onboard program."));
  hardpack::command::AddReplayCommand(app);
  hardpack::command::AddSimCommand(app);
  hardpack::command::AddExperimentCommand(app);
  hardpack::command::AddWorldCommand(app);
  hardpack::command::AddFitCommand(app);
  const int exit_code = hardpack::command::RunProgram(app, argc, argv);
  hardpack::picture::ReleaseFonts();
  return exit_code;
}
