// SPDX-License-Identifier: Apache-2.0
#include "test/bare_metal/startup.h"

#include <cstdint>

// Start-up code of a bare 64-bit Arm on QEMU's virt board (EL1): memory, FPU, and where faults go.

extern "C" {
extern uint64_t bss_begin[], bss_end[];
}

namespace {

// One gigabyte each, mapped to itself (Arm ARM, VMSAv8-64 with 4 KiB granules): devices, then
// memory. Without a map all memory is a device's, where compiled code must not read what is not
// aligned.
constexpr uint64_t kBlock = 1u | 1u << 10u;        // valid, its access flag set
constexpr uint64_t kNormal = 1u << 2u | 3u << 8u;  // attribute 1, inner shareable

}  // namespace

extern "C" {
extern const uint64_t kMap[4];
alignas(4096) const uint64_t kMap[4] = {kBlock, 0x40000000u | kBlock | kNormal, 0, 0};
}

// Compiled code may use the FPU's registers at any point: it is switched on first (CPACR_EL1.FPEN).
// Attribute 0 of MAIR_EL1 is a device's, attribute 1 write-back memory's; TCR_EL1 has 32 bits of
// address by TTBR0_EL1, none by TTBR1_EL1, and 36 bits behind the map.
asm(R"(
    .pushsection .text.reset, "ax"
    .global ResetHandler
ResetHandler:
    mov x0, #(3 << 20)
    msr cpacr_el1, x0
    ldr x0, =vectors
    msr vbar_el1, x0
    mov x0, #0xff00
    msr mair_el1, x0
    ldr x0, =0x100803520
    msr tcr_el1, x0
    ldr x0, =kMap
    msr ttbr0_el1, x0
    isb
    mrs x0, sctlr_el1
    orr x0, x0, #1
    orr x0, x0, #4
    orr x0, x0, #4096
    msr sctlr_el1, x0
    isb
    ldr x0, =stack_top
    mov sp, x0
    b Start
    .balign 2048
vectors:
    .rept 16
    b FaultHandler
    .balign 128
    .endr
    .popsection
)");

// Loops store through volatile, so that they do not become calls of memset.
void Start() {
  uint32_t* const used = static_cast<uint32_t*>(__builtin_frame_address(0)) - 32;
  hardpack::bare_metal::PaintStack(used);
  for (volatile uint64_t* word = bss_begin; word < bss_end; ++word) *word = 0;
  hardpack::bare_metal::Exit(main());
}
