// SPDX-License-Identifier: Apache-2.0
#include "test/bare_metal/startup.h"

#include <cstdint>

// Start-up code of a bare-metal Cortex-M7: vectors, memory, FPU, and where faults go.

extern "C" {
extern uint32_t data_begin[], data_end[], data_load[];
extern uint32_t bss_begin[], bss_end[];
extern uint32_t psram_begin[], psram_end[];
}

// The FPU is off after reset and compiled code may use its registers at any point, so it is
// switched on (CPACR, coprocessors 10 and 11) before the first compiled function.
__attribute__((naked)) void ResetHandler() {
  asm volatile(
      "ldr r0, =0xe000ed88\n"
      "ldr r1, [r0]\n"
      "orr r1, r1, #0x00f00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b Start\n");
}

// Loops store through volatile, so that they do not become calls of memset and memcpy, whose own
// code may need what is being set up here.
void Start() {
  uint32_t* const used = static_cast<uint32_t*>(__builtin_frame_address(0)) - 16;
  hardpack::bare_metal::PaintStack(used);
  for (volatile uint32_t* word = bss_begin; word < bss_end; ++word) *word = 0;
  for (volatile uint32_t* word = psram_begin; word < psram_end; ++word) *word = 0;
  const uint32_t* source = data_load;
  for (volatile uint32_t* word = data_begin; word < data_end; ++word) *word = *source++;
  hardpack::bare_metal::Exit(main());
}

namespace {

using Vector = void (*)();

struct VectorTable {
  uint32_t* initial_stack;
  Vector exceptions[15];  // reset, NMI, hard fault, ...; no interrupt is ever enabled
};

__attribute__((section(".vectors"), used)) const VectorTable kVectors = {
    stack_top,
    {ResetHandler, FaultHandler, FaultHandler, FaultHandler, FaultHandler, FaultHandler,
     FaultHandler, FaultHandler, FaultHandler, FaultHandler, FaultHandler, FaultHandler,
     FaultHandler, FaultHandler, FaultHandler}};

}  // namespace
