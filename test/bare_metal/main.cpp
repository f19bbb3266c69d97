// SPDX-License-Identifier: Apache-2.0
#include "core/base/assert.h"
#include "test/bare_metal/semihosting.h"
#include "test/bare_metal/stack.h"
#include "test/decision/report.h"

// The decision program on a bare Cortex-M7.

namespace hardpack::decision {

void PrintLine(const char* line) {
  bare_metal::Write(line);
  bare_metal::Write("\n");
}

const uint8_t kFreshMemory = 0;

}  // namespace hardpack::decision

namespace {

[[noreturn]] void OnAssertion(const char* file, int line, const char* expression) {
  hardpack::bare_metal::Write(file);
  hardpack::decision::PrintNumber(": assertion failed in line", static_cast<uint32_t>(line));
  hardpack::decision::PrintLine(expression);
  hardpack::bare_metal::Exit(4);
}

}  // namespace

int main() {
  hardpack::SetAssertionHook(OnAssertion);
  hardpack::decision::RunAll();
  hardpack::decision::PrintNumber("stack_size_bytes", hardpack::bare_metal::stack_size_bytes());
  hardpack::decision::PrintNumber("stack_peak_bytes", hardpack::bare_metal::stack_peak_bytes());
  return 0;
}
