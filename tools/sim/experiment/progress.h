// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

// Progress of a long command on a terminal: a bar that is redrawn in place. Shows nothing if
// standard error is not a terminal.

namespace hardpack::experiment {

// "gap  [=====>    ]  12/100  2 failed  1:05 left", fitted to the columns available.
std::string ProgressLine(const std::string& name, int64_t done, int64_t all, int64_t failed,
                         double elapsed_s, int columns);

class Progress {
 public:
  Progress(std::string name, int64_t all);
  ~Progress();  // removes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(int64_t done, int64_t failed);

 private:
  std::string name_;
  int64_t all_;
  bool terminal_;
  uint64_t start_ns_;
};

}  // namespace hardpack::experiment
