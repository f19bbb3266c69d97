// SPDX-License-Identifier: Apache-2.0
#include "core/base/assert.h"
#include "test/cortex_m7/semihosting.h"
#include "test/cortex_m7/stack.h"
#include "test/decision/report.h"

// The decision program on a bare Cortex-M7.

namespace hardpack::decision {

void PrintLine(const char* line) {
  cortex_m7::Write(line);
  cortex_m7::Write("\n");
}

const uint8_t kFreshMemory = 0;

}  // namespace hardpack::decision

namespace {

[[noreturn]] void OnAssertion(const char* file, int line, const char* expression) {
  hardpack::cortex_m7::Write(file);
  hardpack::decision::PrintNumber(": assertion failed in line", static_cast<uint32_t>(line));
  hardpack::decision::PrintLine(expression);
  hardpack::cortex_m7::Exit(4);
}

}  // namespace

int main() {
  hardpack::SetAssertionHook(OnAssertion);
  hardpack::decision::RunAll();
  hardpack::decision::PrintNumber("stack_size_bytes", hardpack::cortex_m7::stack_size_bytes());
  hardpack::decision::PrintNumber("stack_peak_bytes", hardpack::cortex_m7::stack_peak_bytes());
  return 0;
}
