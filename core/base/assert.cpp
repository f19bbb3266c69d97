// SPDX-License-Identifier: Apache-2.0
#include "core/base/assert.h"

namespace hardpack {
namespace {

// Of the program, as an assertion is.
AssertionHook g_hook = nullptr;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace

void SetAssertionHook(AssertionHook hook) {
  g_hook = hook;
}

void AssertionFailed(const char* file, int line, const char* expression) {
  if (g_hook != nullptr) g_hook(file, line, expression);
  __builtin_trap();  // no hook, or one that returned
}

}  // namespace hardpack
