// SPDX-License-Identifier: Apache-2.0
#include "port_linux/command_line/program.h"

#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "port_linux/command_line/command.h"
#include "port_linux/files/nearest_name.h"

namespace hardpack::command {
namespace {

// "hardpack plan", so that an error names its command.
std::string ChosenCommand(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* subcommand : app.get_subcommands()) name += " " + ChosenCommand(*subcommand);
  return name;
}

// Always one line, whatever the reason contains.
int Fail(const CLI::App& app, ExitCode exit_code, std::string reason) {
  for (char& c : reason) c = c == '\n' || c == '\r' ? ' ' : c;
  std::cerr << ChosenCommand(app) << ": " << reason << "\n";
  return exit_code;
}

// For an unknown command, CLI11 says that a command is required.
std::string UsageReason(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<std::string> unknown = app.remaining();
  if (!app.get_subcommands().empty() || unknown.empty()) return error.what();
  if (unknown.front().starts_with('-')) return "there is no option '" + unknown.front() + "'";
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  const std::string nearest = NearestName(unknown.front(), names);
  return "there is no command '" + unknown.front() + "'" +
         (nearest.empty() ? "" : ", did you mean '" + nearest + "'?");
}

}  // namespace

int RunProgram(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return kDone;
  } catch (const CLI::ParseError& error) {
    // Help and version are "errors" with exit code 0; all others are bad usage, whatever CLI11's
    // own number is.
    if (error.get_exit_code() == 0) return app.exit(error);
    return Fail(app, kBadInput, UsageReason(app, error) + " (see --help)");
  } catch (const CommandFailure& failure) {
    return Fail(app, failure.exit_code(), failure.what());
  } catch (const std::exception& error) {
    return Fail(app, kWorkFailed, error.what());
  }
}

}  // namespace hardpack::command
