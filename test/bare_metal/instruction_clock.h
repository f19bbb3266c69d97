// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Counts instructions exactly, on an emulator that lets every instruction take the same time: QEMU
// with -icount (run.sh).
//   Cortex-M7: 128 ns an instruction, and the board's first CMSDK APB timer (Arm AN500), which
//   counts down once in 40 ns: 3.2 counts an instruction, so that the floor of two readings does
//   not cost one. aarch64: 16 ns an instruction, and the generic timer, which QEMU's virt counts up
//   in 16 ns.

namespace hardpack::bare_metal {

#if defined(__aarch64__)
class InstructionClock {
 public:
  static void Start() {}
  // Counts, which wrap.
  static uint32_t Now() {
    uint64_t count;
    asm volatile("isb\n\tmrs %0, cntvct_el0" : "=r"(count) : : "memory");
    return static_cast<uint32_t>(count);
  }
  // Instructions from one reading to another: at most 4.2e9. What reads the clock counts itself, a
  // few of them.
  static uint32_t InstructionsBetween(uint32_t from, uint32_t to) { return to - from; }
};
#else
class InstructionClock {
 public:
  // Without -icount nothing of it is exact.
  static void Start() {
    Timer()[kReload] = 0xffffffffu;
    Timer()[kValue] = 0xffffffffu;
    Timer()[kControl] = 1u;
  }
  // Counts, which wrap.
  static uint32_t Now() { return ~Timer()[kValue]; }
  // Instructions from one reading to another: at most 1.3e9. What reads the clock counts itself, a
  // few of them.
  static uint32_t InstructionsBetween(uint32_t from, uint32_t to) {
    return static_cast<uint32_t>((uint64_t{to - from} * 10u + 16u) / 32u);
  }

 private:
  static constexpr int kControl = 0;
  static constexpr int kValue = 1;
  static constexpr int kReload = 2;
  static volatile uint32_t* Timer() { return reinterpret_cast<volatile uint32_t*>(0x40000000u); }
};
#endif

}  // namespace hardpack::bare_metal
