// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "port_linux/command_line/command.h"
#include "port_linux/command_line/program.h"
#include "port_linux/hardpackctl/ctl_command.h"

int main(int argc, char** argv) {
  try {
    CLI::App app("Talks to hardpackd, the onboard program.", "hardpackctl");
    app.set_version_flag("--version", HARDPACK_VERSION);
    hardpack::command::AddCtlCommands(app);
    return hardpack::command::RunProgram(app, argc, argv);
  } catch (const std::exception& error) {
    static_cast<void>(std::fprintf(stderr, "hardpackctl: %s\n", error.what()));
    return hardpack::command::kWorkFailed;
  }
}
