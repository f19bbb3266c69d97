// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

// What a long command shows on a terminal: a bar that is drawn over itself. Nothing where standard
// error is no terminal.

namespace hardpack::experiment {

// "gap  [=====>    ]  12/100  2 failed  1:05 left"; of the columns that there are.
std::string ProgressLine(const std::string& name, int64_t done, int64_t all, int64_t failed,
                         double elapsed_s, int columns);

class Progress {
 public:
  Progress(std::string name, int64_t all);
  ~Progress();  // the line is taken away
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
