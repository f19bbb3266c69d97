// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include "test/bare_metal/instruction_clock.h"
#include "test/bare_metal/print.h"
#include "test/timing/kernels/kernels.h"

// Runs each kernel once and prints how many instructions it took.

namespace hardpack::timing::kernels {

int32_t in[kMostNumbers];
int32_t out[kMostNumbers];
float real_in[kMostNumbers];
float real_out[kMostNumbers];

void FillRandom() {
  uint32_t state = 1;
  for (int k = 0; k < kMostNumbers; ++k) {
    state = state * 1664525u + 1013904223u;  // Knuth's and Lewis's
    in[k] = static_cast<int32_t>(state >> 17);
    real_in[k] = static_cast<float>(in[k]) / 16384.0f - 1.0f;
  }
}

void FillDescending() {
  for (int k = 0; k < kMostNumbers; ++k) in[k] = kMostNumbers - k;
}

void FillAscending() {
  for (int k = 0; k < kMostNumbers; ++k) in[k] = k;
}

namespace {

[[gnu::noinline]] void Nothing() {
  asm volatile("");
}

[[gnu::noipa]] uint32_t Count(void (*run)()) {
  using bare_metal::InstructionClock;
  const uint32_t from = InstructionClock::Now();
  run();
  return InstructionClock::InstructionsBetween(from, InstructionClock::Now());
}

}  // namespace

void CountAll() {
  bare_metal::InstructionClock::Start();
  const uint32_t around = Count(Nothing) - 1;  // but for its return
  for (const Kernel* kernels : {kNumberKernels, kSequenceKernels, kGraphKernels}) {
    for (const Kernel* kernel = kernels; kernel->name != nullptr; ++kernel) {
      kernel->fill();
      bare_metal::PrintNumber(kernel->name, Count(kernel->run) - around);
    }
  }
}

}  // namespace hardpack::timing::kernels

int main() {
  hardpack::timing::kernels::CountAll();
  return 0;
}
