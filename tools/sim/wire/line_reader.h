// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace hardpack::wire {

// Lines that come one after another from a descriptor which is not to be waited for.
class LineReader {
 public:
  // Makes reads of the descriptor return at once.
  void Open(int descriptor);

  // The next whole line, without its end. False: there is none yet, or there will be none.
  bool Next(std::string& line);

 private:
  int descriptor_ = -1;
  std::string read_;
};

}  // namespace hardpack::wire
