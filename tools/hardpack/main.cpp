// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <iostream>
#include <string>

#include "CLI/CLI.hpp"
#include "tools/hardpack/bench_command.h"
#include "tools/hardpack/command.h"
#include "tools/hardpack/figures_command.h"
#include "tools/hardpack/plan_command.h"
#include "tools/hardpack/scene_command.h"

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

int Run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return hardpack::command::kDone;
  } catch (const CLI::ParseError& error) {
    // Help and version are "errors" with exit code 0; all others are bad usage, whatever CLI11's
    // own number is.
    if (error.get_exit_code() == 0) return app.exit(error);
    return Fail(app, hardpack::command::kBadInput, std::string(error.what()) + " (see --help)");
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
  return Run(app, argc, argv);
}
