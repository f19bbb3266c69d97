// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "test/cortex_m7/semihosting.h"
#include "test/cortex_m7/stack.h"

// Start-up code of a bare-metal Cortex-M7: vectors, memory, FPU, and where faults go.

int main();

extern "C" {
extern uint32_t stack_bottom[], stack_top[];
extern uint32_t data_begin[], data_end[], data_load[];
extern uint32_t bss_begin[], bss_end[];
extern uint32_t psram_begin[], psram_end[];
[[noreturn]] void ResetHandler();
[[noreturn]] void Start();
[[noreturn]] void FaultHandler();
}

namespace hardpack::cortex_m7 {
namespace {

constexpr uint32_t kStackPaint = 0x57ac57acu;

enum SemihostingCall : int {
  kOpen = 0x01,
  kWrite0 = 0x04,
  kRead = 0x06,
  kGetCommandLine = 0x15,
  kExitExtended = 0x20
};

uint32_t AddressOf(const void* place) {
  return reinterpret_cast<uint32_t>(place);
}

int Semihosting(SemihostingCall call, const void* argument) {
  register int r0 asm("r0") = call;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

}  // namespace

void Write(const char* text) {
  Semihosting(kWrite0, text);
}

void Exit(int code) {
  constexpr uint32_t kApplicationExit = 0x20026u;
  const uint32_t block[2] = {kApplicationExit, static_cast<uint32_t>(code)};
  Semihosting(kExitExtended, block);
  for (;;) {
  }
}

bool GetCommandLine(std::span<char> line) {
  uint32_t block[2] = {AddressOf(line.data()), static_cast<uint32_t>(line.size())};
  return Semihosting(kGetCommandLine, block) == 0;
}

int32_t OpenToRead(const char* path) {
  constexpr uint32_t kReadBinary = 1;
  const uint32_t block[3] = {AddressOf(path), kReadBinary, __builtin_strlen(path)};
  return Semihosting(kOpen, block);
}

bool Read(int32_t file, std::span<uint8_t> bytes) {
  if (bytes.empty()) return true;
  const uint32_t block[3] = {static_cast<uint32_t>(file), AddressOf(bytes.data()), bytes.size()};
  return Semihosting(kRead, block) == 0;  // else what is missing
}

uint32_t stack_size_bytes() {
  return static_cast<uint32_t>(stack_top - stack_bottom) * sizeof(uint32_t);
}

uint32_t stack_peak_bytes() {
  const uint32_t* word = stack_bottom;
  while (word < stack_top && *word == kStackPaint) ++word;
  return static_cast<uint32_t>(stack_top - word) * sizeof(uint32_t);
}

}  // namespace hardpack::cortex_m7

using hardpack::cortex_m7::Exit;
using hardpack::cortex_m7::kStackPaint;
using hardpack::cortex_m7::Write;

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
  for (volatile uint32_t* word = stack_bottom; word < used; ++word) *word = kStackPaint;
  for (volatile uint32_t* word = bss_begin; word < bss_end; ++word) *word = 0;
  for (volatile uint32_t* word = psram_begin; word < psram_end; ++word) *word = 0;
  const uint32_t* source = data_load;
  for (volatile uint32_t* word = data_begin; word < data_end; ++word) *word = *source++;
  Exit(main());
}

void FaultHandler() {
  Write("fault: the processor took an exception\n");
  Exit(3);
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
