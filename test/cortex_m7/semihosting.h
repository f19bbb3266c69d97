// SPDX-License-Identifier: Apache-2.0
#pragma once

// Arm semihosting, as far as a test program needs it (Arm, "Semihosting for AArch32 and AArch64").

namespace hardpack::cortex_m7 {

// Writes zero-terminated text to the debugger's console.
void Write(const char* text);

// Ends the program, and the emulator, with this exit code.
[[noreturn]] void Exit(int code);

}  // namespace hardpack::cortex_m7
