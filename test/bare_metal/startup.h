// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "test/bare_metal/semihosting.h"
#include "test/bare_metal/stack.h"

// What the start-up code of every processor has: the linker scripts' places, and where it leads.

int main();

extern "C" {
extern uint32_t stack_bottom[], stack_top[];
[[noreturn]] void ResetHandler();
[[noreturn]] void Start();
[[noreturn]] void FaultHandler();
}

namespace hardpack::bare_metal {

// Up to `used`, which is below what the caller has. Stores through volatile, so that it does not
// become a call of memset.
inline void PaintStack(const uint32_t* used) {
  for (volatile uint32_t* word = stack_bottom; word < used; ++word) *word = kStackPaint;
}

}  // namespace hardpack::bare_metal
