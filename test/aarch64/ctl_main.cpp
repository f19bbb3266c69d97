// SPDX-License-Identifier: Apache-2.0
// `hardpack ctl` alone: the cross build has none of the libraries that the other commands need.
#include <exception>
#include <iostream>

#include "CLI/CLI.hpp"
#include "tools/hardpack/command.h"
#include "tools/hardpack/ctl_command.h"

int main(int argc, char** argv) {
  CLI::App app("Talks to hardpackd, the onboard program.", "hardpack");
  app.require_subcommand(1);
  hardpack::command::AddCtlCommand(app);
  try {
    app.parse(argc, argv);
    return hardpack::command::kDone;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? hardpack::command::kDone : hardpack::command::kBadInput;
  } catch (const hardpack::command::CommandFailure& failure) {
    std::cerr << failure.what() << "\n";
    return failure.exit_code();
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return hardpack::command::kWorkFailed;
  }
}
