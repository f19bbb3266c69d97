// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "CLI/CLI.hpp"
#include "port_linux/nearest_name.h"
#include "tools/hardpack/bench_command.h"
#include "tools/hardpack/command.h"
#include "tools/hardpack/ctl_command.h"
#include "tools/hardpack/experiment_command.h"
#include "tools/hardpack/figures_command.h"
#include "tools/hardpack/fit_command.h"
#include "tools/hardpack/plan_command.h"
#include "tools/hardpack/replay_command.h"
#include "tools/hardpack/scene_command.h"
#include "tools/hardpack/sim_command.h"
#include "tools/hardpack/world_command.h"
#include "tools/picture/canvas.h"

namespace {

using hardpack::command::ExitCode;

// "hardpack plan", so that a reason says which command gives it.
std::string ChosenCommand(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* subcommand : app.get_subcommands()) name += " " + ChosenCommand(*subcommand);
  return name;
}

// One line, whatever the reason is made of.
int Fail(const CLI::App& app, ExitCode exit_code, std::string reason) {
  for (char& c : reason) c = c == '\n' || c == '\r' ? ' ' : c;
  std::cerr << ChosenCommand(app) << ": " << reason << "\n";
  return exit_code;
}

// CLI11 says that a command is required where there is one, but an unknown one.
std::string UsageReason(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining();
  if (!app.get_subcommands().empty() || unknown.empty()) return error.what();
  if (unknown.front().starts_with('-')) return "there is no option '" + unknown.front() + "'";
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  const std::string nearest = hardpack::NearestName(unknown.front(), names);
  return "there is no command '" + unknown.front() + "'" +
         (nearest.empty() ? "" : ", did you mean '" + nearest + "'?");
}

int Run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return hardpack::command::kDone;
  } catch (const CLI::ParseError& error) {
    // Help and version are "errors" with exit code 0; all others are bad usage, whatever CLI11's
    // own number is.
    if (error.get_exit_code() == 0) return app.exit(error);
    return Fail(app, hardpack::command::kBadInput, UsageReason(app, error) + " (see --help)");
  } catch (const hardpack::command::CommandFailure& failure) {
    return Fail(app, failure.exit_code(), failure.what());
  } catch (const std::exception& error) {
    return Fail(app, hardpack::command::kWorkFailed, error.what());
  }
}

}  // namespace

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
  hardpack::command::AddCtlCommand(app);
  hardpack::command::AddReplayCommand(app);
  hardpack::command::AddSimCommand(app);
  hardpack::command::AddExperimentCommand(app);
  hardpack::command::AddWorldCommand(app);
  hardpack::command::AddFitCommand(app);
  const int exit_code = Run(app, argc, argv);
  hardpack::picture::ReleaseFonts();
  return exit_code;
}
