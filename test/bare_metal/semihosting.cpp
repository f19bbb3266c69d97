// SPDX-License-Identifier: Apache-2.0
#include "test/bare_metal/semihosting.h"

#include "test/bare_metal/startup.h"

namespace hardpack::bare_metal {
namespace {

enum SemihostingCall : int {
  kOpen = 0x01,
  kWrite0 = 0x04,
  kRead = 0x06,
  kGetCommandLine = 0x15,
  kExitExtended = 0x20
};

uintptr_t AddressOf(const void* place) {
  return reinterpret_cast<uintptr_t>(place);
}

// Fields of an argument have the size of a pointer.
int Semihosting(SemihostingCall call, const void* argument) {
#if defined(__aarch64__)
  register uintptr_t result asm("x0") = static_cast<uintptr_t>(call);
  register const void* block asm("x1") = argument;
  asm volatile("hlt 0xf000" : "+r"(result) : "r"(block) : "memory");
  return static_cast<int>(result);
#else
  register int result asm("r0") = call;
  register const void* block asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(result) : "r"(block) : "memory");
  return result;
#endif
}

}  // namespace

void Write(const char* text) {
  Semihosting(kWrite0, text);
}

void Exit(int code) {
  constexpr uintptr_t kApplicationExit = 0x20026u;
  const uintptr_t block[2] = {kApplicationExit, static_cast<uintptr_t>(code)};
  Semihosting(kExitExtended, block);
  for (;;) {
  }
}

bool GetCommandLine(std::span<char> line) {
  uintptr_t block[2] = {AddressOf(line.data()), line.size()};
  return Semihosting(kGetCommandLine, block) == 0;
}

int32_t OpenToRead(const char* path) {
  constexpr uintptr_t kReadBinary = 1;
  uintptr_t length = 0;
  while (path[length] != '\0') ++length;
  const uintptr_t block[3] = {AddressOf(path), kReadBinary, length};
  return Semihosting(kOpen, block);
}

bool Read(int32_t file, std::span<uint8_t> bytes) {
  if (bytes.empty()) return true;
  const uintptr_t block[3] = {static_cast<uintptr_t>(file), AddressOf(bytes.data()), bytes.size()};
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

}  // namespace hardpack::bare_metal

void FaultHandler() {
  hardpack::bare_metal::Write("fault: the processor took an exception\n");
  hardpack::bare_metal::Exit(3);
}
