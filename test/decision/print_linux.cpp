// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "test/decision/report.h"

namespace hardpack::decision {

void PrintLine(const char* line) {
  std::puts(line);
}

#if defined(NDEBUG)
const uint8_t kFreshMemory = 0x5a;
#else
const uint8_t kFreshMemory = 0xa5;
#endif

}  // namespace hardpack::decision
