// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/wire/line_reader.h"

#include <fcntl.h>
#include <unistd.h>

namespace hardpack::wire {

void LineReader::Open(int descriptor) {
  descriptor_ = descriptor;
  fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) | O_NONBLOCK);
}

bool LineReader::Next(std::string& line) {
  if (descriptor_ < 0) return false;
  char bytes[512];
  ssize_t count = 0;
  while ((count = read(descriptor_, bytes, sizeof(bytes))) > 0) {
    read_.append(bytes, static_cast<size_t>(count));
  }
  const size_t end = read_.find('\n');
  if (end == std::string::npos) return false;
  line = read_.substr(0, end);
  read_.erase(0, end + 1);
  return true;
}

}  // namespace hardpack::wire
