// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "port_linux/files/read_outcome.h"

// How a subcommand of `hardpack` ends. Each has a function Add<Name>Command(app) that declares its
// options; its action may throw a CommandFailure, which main prints on one line.

namespace hardpack::command {

enum ExitCode : int {
  kDone = 0,
  kWorkFailed = 1,  // no path, a collision, a mismatch
  kBadInput = 2,    // bad usage, or a file that cannot be read or written
};

class CommandFailure : public std::runtime_error {
 public:
  CommandFailure(ExitCode exit_code, const std::string& reason)
      : std::runtime_error(reason), exit_code_(exit_code) {}
  ExitCode exit_code() const { return exit_code_; }

 private:
  ExitCode exit_code_;
};

// kBadInput with the outcome's own line if a file could not be read or written.
inline void Require(const ReadOutcome& outcome) {
  if (!outcome.ok()) throw CommandFailure(kBadInput, outcome.message);
}

}  // namespace hardpack::command
