// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace hardpack::wire {

// Reads lines from a descriptor without blocking.
class LineReader {
 public:
  // Makes the descriptor non-blocking.
  void Open(int descriptor);

  // The next complete line, without its line end. False: there is none yet, or no more will come.
  bool Next(std::string& line);

 private:
  int descriptor_ = -1;
  std::string read_;
};

}  // namespace hardpack::wire
