// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace hardpack::command {

// Parses the arguments and runs the selected command. Returns the program's exit code (ExitCode);
// if it is not kDone, prints one line on stderr, after the command's name, that says why.
int RunProgram(CLI::App& app, int argc, char** argv);

}  // namespace hardpack::command
