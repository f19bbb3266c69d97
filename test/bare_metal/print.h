// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "test/bare_metal/semihosting.h"

// Lines of output, each a text and a number.

namespace hardpack::bare_metal {

inline void PrintLine(const char* line) {
  Write(line);
  Write("\n");
}

inline void PrintNumber(const char* text, uint32_t value) {
  char digits[11];
  char* first = digits + sizeof(digits) - 1;
  *first = '\0';
  do {
    *--first = static_cast<char>('0' + value % 10u);
    value /= 10u;
  } while (value > 0);
  Write(text);
  Write(" ");
  PrintLine(first);
}

inline void PrintHex(const char* text, uint64_t value) {
  char digits[17] = {};
  for (uint32_t i = 0; i < 16; ++i) {
    digits[i] = "0123456789abcdef"[value >> (60u - 4u * i) & 0xfu];
  }
  Write(text);
  Write(" ");
  PrintLine(digits);
}

}  // namespace hardpack::bare_metal
