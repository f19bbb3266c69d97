// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace hardpack::command {

// Parses the arguments and runs the command that they choose. Returns the program's exit code
// (ExitCode); says in one line on stderr why it is not kDone, after the name of the command.
int RunProgram(CLI::App& app, int argc, char** argv);

}  // namespace hardpack::command
