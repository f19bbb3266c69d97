// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

// Arm semihosting, as far as a test program needs it (Arm, "Semihosting for AArch32 and AArch64").

namespace hardpack::bare_metal {

// Writes zero-terminated text to the debugger's console.
void Write(const char* text);

// Ends the program, and the emulator, with this exit code.
[[noreturn]] void Exit(int code);

// The command line that the program was given, zero-terminated: false where there is none, or it
// does not fit.
bool GetCommandLine(std::span<char> line);

// Opens a file of the host to read; -1: it cannot be.
int32_t OpenToRead(const char* path);

// The next bytes of the file. False: it holds fewer.
bool Read(int32_t file, std::span<uint8_t> bytes);

}  // namespace hardpack::bare_metal
