// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace hardpack {

// Called when a programmer's assumption does not hold. It must not return: the platform brings the
// vehicle to a stop and reports where. Bad input from outside never leads here.
using AssertionHook = void (*)(const char* file, int line, const char* expression);

// Replaces the hook (default: trap). Called once, at start-up, before the first tick.
void SetAssertionHook(AssertionHook hook);

[[noreturn]] void AssertionFailed(const char* file, int line, const char* expression);

}  // namespace hardpack

// Active in every build: on a moving machine, a failed assertion is not an optimisation hint.
#define HP_ASSERT(expression)                         \
  (__builtin_expect(static_cast<bool>(expression), 1) \
       ? static_cast<void>(0)                         \
       : ::hardpack::AssertionFailed(__FILE__, __LINE__, #expression))
